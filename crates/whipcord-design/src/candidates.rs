//! Robots with other lists of holes, and the shapes that they take.

use whipcord::batch::{BatchOptions, solve_robots};
use whipcord::{Case, Model, Robot, Routing, Solution, SolveError};

use crate::budget::Budget;
use crate::choices::Choices;
use crate::criteria::Criteria;
use crate::error::DesignError;
use crate::goal::ShapeGoal;

/// The robot whose varied cables go through these combinations of holes, one for each disk.
pub(crate) fn with_holes(
    robot: &Robot,
    choices: &Choices,
    list: &[usize],
) -> Result<Robot, DesignError> {
    let mut cables = robot.cables().to_vec();
    for (place, &cable) in choices.cables.iter().enumerate() {
        let holes: Vec<usize> =
            list.iter().map(|&choice| choices.hole(choice, place) + 1).collect();
        let interpolation = match &cables[cable].routing {
            Routing::Holes { interpolation, .. } => *interpolation,
            _ => whipcord::Interpolation::default(),
        };
        cables[cable].routing = Routing::Holes { holes, interpolation };
        cables[cable].ends_at = None;
    }
    let changed = Robot::new(robot.backbone().clone(), robot.disks().clone(), cables)?;
    Ok(changed.with_motors(robot.motors().to_vec())?)
}

/// How many robots are solved at first. Each time it is twice as many, so that what is begun when a search is ended takes no longer than all before it.
const FIRST_PIECE: usize = 8;
/// How many robots are solved at a time at most.
const PIECE: usize = 256;

/// Solves each list under a case, the first ones in any case and the others until the budget is spent; `take` gets the number of the list and its answer. How many were solved.
pub(crate) fn solve_lists(
    model: &Model,
    robot: &Robot,
    choices: &Choices,
    (case, budget): (&Case, &Budget),
    lists: &[Vec<usize>],
    mut take: impl FnMut(usize, Result<&Solution, &SolveError>),
) -> Result<usize, DesignError> {
    let (mut solved, mut size) = (0, FIRST_PIECE);
    while solved < lists.len() {
        if solved > 0 && budget.is_over() {
            return Ok(solved);
        }
        let piece = &lists[solved..lists.len().min(solved + size)];
        let robots = piece
            .iter()
            .map(|list| Ok((with_holes(robot, choices, list)?, case.clone())))
            .collect::<Result<Vec<_>, DesignError>>()?;
        let answers = solve_robots(model, &robots, &BatchOptions::default())?;
        for (number, answer) in answers.iter().enumerate() {
            take(solved + number, answer.as_ref());
        }
        solved += piece.len();
        size = (2 * size).min(PIECE);
    }
    Ok(lists.len())
}

/// The cost of each list, with what criteria add to it; infinite where the model has no answer, or the budget is spent. Of a list that costs no less than `known`, or than the
/// best of these lists, it may be a lower bound only. The first reason why there is none, if none has one.
pub(crate) fn costs(
    model: &Model,
    robot: &Robot,
    choices: &Choices,
    (goals, criteria): (&[ShapeGoal], Option<&Criteria>),
    lists: &[Vec<usize>],
    (known, budget): (f64, &Budget),
) -> Result<(Vec<f64>, Option<SolveError>), DesignError> {
    let mut costs = vec![0.0; lists.len()];
    let mut refusal = None;
    let mut kept: Vec<Vec<Solution>> = vec![Vec::new(); lists.len()];
    let mut solved = lists.len();
    for goal in goals {
        let by = (&goal.case, budget);
        let lists = &lists[..solved];
        solved = solve_lists(model, robot, choices, by, lists, |number, answer| match answer {
            Ok(solution) => {
                costs[number] += goal.cost(&solution.disks.poses);
                if criteria.is_some() {
                    kept[number].push(solution.clone());
                }
            }
            Err(error) => {
                costs[number] = f64::INFINITY;
                refusal.get_or_insert_with(|| error.clone());
            }
        })?;
        budget.spend(solved);
    }
    costs[solved..].fill(f64::INFINITY);
    let Some(criteria) = criteria else { return Ok((costs, refusal)) };
    let cases: Vec<Case> = goals.iter().map(|goal| goal.case.clone()).collect();
    // The nearest lists first, so that most of the others are too far off for criteria to matter.
    let mut order: Vec<usize> = (0..lists.len()).collect();
    order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
    let mut least = known;
    for (place, number) in order.into_iter().enumerate() {
        if costs[number] >= least {
            break;
        }
        if place > 0 && budget.is_over() {
            costs[number] = f64::INFINITY;
            continue;
        }
        budget.spend(criteria.effort());
        let changed = with_holes(robot, choices, &lists[number])?;
        match criteria.cost(&changed, &cases, &kept[number], least - costs[number]) {
            Ok(more) => costs[number] += more,
            Err(DesignError::Solve(error)) => {
                costs[number] = f64::INFINITY;
                refusal.get_or_insert(error);
            }
            Err(error) => return Err(error),
        }
        least = least.min(costs[number]);
    }
    Ok((costs, refusal))
}
