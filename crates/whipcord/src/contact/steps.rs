//! The answer to a case: its steps of actuation, and the way to each.

use whipcord_numerics::Vec3;

use super::division::Commanded;
use super::holding::Holding;
use super::homotopy::Homotopy;
use super::noted::Noting;
use super::path::{Acting, PathTracker, Steps, Stop, has_friction};
use crate::case::{CableCommand, Case};
use crate::error::SolveError;
use crate::obstacle::Obstacle;
use crate::robot::Robot;
use crate::solution::{Diagnostics, NoStability, Solution};

/// The answer to a case with obstacles, from the answer to a neighbouring one or from the robot at rest, with the first step on the way there.
pub(crate) fn solve(
    model: &mut impl Noting,
    robot: &Robot,
    of: (&Case, f64),
    warm_start: Option<&Solution>,
) -> Result<Solution, SolveError> {
    solve_holding(model, robot, of, warm_start).map(|(solution, _)| solution)
}

/// [`solve`], with the contacts of the answer, linearised.
pub(crate) fn solve_holding(
    model: &mut impl Noting,
    robot: &Robot,
    (case, first_step): (&Case, f64),
    warm_start: Option<&Solution>,
) -> Result<(Solution, Holding), SolveError> {
    let remembers = has_friction(robot) || case.obstacles.iter().any(Obstacle::has_history);
    if warm_start.is_some() || case.before.is_empty() || case.independent || !remembers {
        return solve_step(model, robot, (0, case, first_step), (warm_start, None));
    }
    // Friction remembers the steps before the last.
    let mut last = Err(SolveError::NoDerivatives);
    let followed = follow_steps(model, robot, (case, 1.0), |_, answer| {
        last = Ok(answer);
        Ok(())
    });
    followed.map_err(|(_, error)| error)?;
    last
}

/// The answer to a step of actuation of a robot that friction makes remember the steps before.
pub(crate) struct RubbedAnswer {
    pub solution: Solution,
    /// Whether anything has touched on the way to it.
    pub has_touched: bool,
    /// Its contacts, linearised.
    pub holding: Holding,
}

/// The answers to all steps of actuation of a case whose cables or obstacles rub, from rest on, with the first step on the way to the first;
/// `each` gets the model too, at the equilibrium of a step.
///
/// # Errors
/// The number of the first step without an answer, from 0, and why it has none.
pub(crate) fn solve_rubbing<M: Noting>(
    model: &mut M,
    robot: &Robot,
    of: (&Case, f64),
    mut each: impl FnMut(&mut M, RubbedAnswer) -> Result<(), SolveError>,
) -> Result<(), (usize, SolveError)> {
    follow_steps(model, robot, of, |model, (solution, holding)| {
        let has_touched = model.has_touched();
        each(model, RubbedAnswer { solution, has_touched, holding })
    })
}

/// Solves the steps of actuation of a case, each from where the one before ends.
fn follow_steps<M: Noting>(
    model: &mut M,
    robot: &Robot,
    (case, mut first_step): (&Case, f64),
    mut each: impl FnMut(&mut M, (Solution, Holding)) -> Result<(), SolveError>,
) -> Result<(), (usize, SolveError)> {
    let rubs = has_friction(robot);
    let mut last: Option<(Solution, Case)> = None;
    let mut commanded = Commanded::default();
    for (n, step) in case.leading_steps().enumerate() {
        model.meter().grant_step(n);
        let longest_part = commanded.longest_part(&step.commands, model.initial_lengths());
        let from = match &last {
            Some((solution, before)) => {
                // How much other loads ask of a step is not known.
                let longest_part = (before.loads == step.loads).then_some(longest_part);
                (Some(solution), Some(StepBefore { commands: &before.commands, longest_part }))
            }
            None => (None, None),
        };
        if let (Some(before), false) = (&from.1, rubs)
            && !are_driven_alike(before.commands, &step.commands)
        {
            // The way begins at what the answer before has of what is commanded now.
            model.lose_notes();
        }
        let (solution, holding) =
            solve_step(model, robot, (n, &step, first_step), from).map_err(|error| (n, error))?;
        first_step = 1.0;
        last = Some((solution.clone(), step));
        each(model, (solution, holding)).map_err(|error| (n, error))?;
    }
    Ok(())
}

/// Whether each cable is driven by its tension in both, or by its length.
fn are_driven_alike(before: &[CableCommand], now: &[CableCommand]) -> bool {
    let by = |command: &CableCommand| (command.tension.is_some(), command.shortening.is_some());
    before.iter().map(by).eq(now.iter().map(by))
}

/// What is known of the step of actuation before another.
struct StepBefore<'a> {
    commands: &'a [CableCommand],
    /// The longest part of the way from there; `None` where it is divided as one from rest.
    longest_part: Option<f64>,
}

/// The answer to one step of actuation, from the robot at rest, or from an answer and the step that it is of where that is known.
fn solve_step(
    model: &mut impl Noting,
    robot: &Robot,
    (step, case, first_step): (usize, &Case, f64),
    (warm_start, before): (Option<&Solution>, Option<StepBefore<'_>>),
) -> Result<(Solution, Holding), SolveError> {
    let rubs = has_friction(robot);
    let to_base = case.base.inverse();
    let warm_start = warm_start.filter(|answer| answer.cables.len() == case.commands.len());
    let homotopy = match (warm_start, &before) {
        // What friction remembers was led to by these.
        (Some(_), Some(before)) if rubs || are_driven_alike(before.commands, &case.commands) => {
            Homotopy::from_commands(before.commands, case)
        }
        (Some(answer), _) => Homotopy::from_answer(answer, case),
        (None, _) if rubs => Homotopy::from_rest_loaded_first(case),
        (None, _) => Homotopy::from_rest(case),
    };
    let mut tracker = PathTracker::new(model, robot, (step, case), warm_start);
    if let Some(longest_part) = before.and_then(|before| before.longest_part).filter(|_| rubs) {
        tracker.longest_step = longest_part;
    }
    let initial: Vec<f64> = tracker.model.initial_lengths().to_vec();
    let at = |way: f64| homotopy.at(way, &initial);
    let of_case = |way: f64| [homotopy.command_factor(way), homotopy.load_factor(way)];
    let grow = |way: f64| {
        let loads = homotopy.load_factor(way);
        Acting { loads, of_case: of_case(way), ..Acting::ALL }
    };
    tracker.start((&at(0.0), of_case(0.0)), warm_start, &to_base)?;
    let longest = tracker.longest_step;
    let steps = Steps { first: first_step.min(longest), ..Steps::up_to(longest) };
    let mut gone = tracker.go_in_steps(case, at, grow, steps);
    if let Err(error) = &gone
        && warm_start.is_none()
        && !tracker.objects.list.is_empty()
        && error.is_obstruction()
    {
        gone = tracker.hold_and_release(case, &at, &to_base);
    }
    if let Err(error) = gone {
        tracker.approach(case, &at, grow, error)?;
    }
    // The way does not count any more: it has led to an answer.
    tracker.renew_budget();
    while tracker.model.refine()? {
        let here: Vec<Vec3> =
            (0..tracker.model.watched().len()).map(|k| tracker.model.centre(k)).collect();
        if let Err(stop) = tracker.touch(&at(1.0), &here) {
            return Err(tracker.obstructed(1.0, Some(stop)));
        }
        tracker.note();
    }
    // Whatever led here: where anything that is watched overlaps, this is no answer.
    if let Some((.., depth)) = tracker.pairs.deepest(tracker.model, &tracker.scene) {
        return Err(tracker.obstructed(1.0, Some(Stop::NotConverged(depth / tracker.length))));
    }
    if let Some((.., depth)) = tracker.objects.deepest(&tracker.scene, tracker.length) {
        return Err(tracker.obstructed(1.0, Some(Stop::NotConverged(depth / tracker.length))));
    }
    let holding = tracker.holding(false);
    let mut solution = tracker.model.solution(&at(1.0), &tracker.pushes)?;
    let forces = tracker.model.knows_forces();
    solution.contacts = tracker.pairs.contacts(tracker.model, &case.base, forces);
    solution.objects = tracker.objects.states(&tracker.pairs, &case.base);
    let Diagnostics { stable, stability_absent, .. } = &mut solution.diagnostics;
    if *stability_absent == Some(NoStability::Touching) {
        *stable = (tracker.unstable == Some(0)).then_some(true);
        *stability_absent = match stable {
            Some(_) => None,
            None if case.loads.has_follower() => Some(NoStability::Followers),
            None if case.loads.has_dead_moment() => Some(NoStability::DeadMoments),
            None if tracker.is_without_friction()
                && !tracker.rubs
                && !robot.has_bending_friction() =>
            {
                Some(NoStability::Undetermined)
            }
            None => Some(NoStability::Touching),
        };
    }
    solution.diagnostics.iterations = tracker.iterations;
    solution.diagnostics.stability_lost_at = tracker.slipped_at;
    solution.diagnostics.residual = solution.diagnostics.residual.max(tracker.residual);
    Ok((solution, holding))
}
