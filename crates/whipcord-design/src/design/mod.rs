//! The design of a robot for its goals: each part that is varied by the method that proves most, one after the other.

mod holes;
mod on_curve;
mod unknowns;
mod work;

use whipcord::{Case, Model, ModelKind, Robot, Solution, Statics as _, Stations};

use crate::budget::Budget;
use crate::cable_count;
use crate::criteria::Criteria;
use crate::error::DesignError;
use crate::goal::{self, ShapeGoal, root_mean_square};
use crate::problem::{Design, DesignGoal, DesignOptions, GoalResult, Known, spread};
use crate::vary::Vary;
use unknowns::{command_ranges, rim};
use work::{Work, with_case};

/// Changes what is to be varied of a robot, so that it comes nearest to its goals in the weighted mean square of the distances of its disks, with the objectives and
/// within the constraints of [`DesignOptions::criteria`].
///
/// Holes come first (`design_holes`), in turn with the tensions where these are varied too; then a continuous routing, which has a closed form for
/// one cable and a curve; then rest curvature or diameters for a curve; all other continuous quantities by
/// least squares with the exact derivatives of the model, from several starts. What each part is worth is in [`Design::findings`].
///
/// # Errors
/// [`DesignError`].
pub fn design(
    model: &Model,
    robot: &Robot,
    goals: &[DesignGoal],
    vary: &[Vary],
    options: &DesignOptions,
) -> Result<Design, DesignError> {
    if vary.is_empty() {
        return Err(DesignError::NothingVaried);
    }
    if goals.is_empty() {
        return Err(DesignError::NoPoints);
    }
    let shape_goals: Vec<ShapeGoal> =
        goals.iter().map(|of| of.shape_goal(robot)).collect::<Result<_, _>>()?;
    if options.criteria.is_empty() {
        goal::check_points(&shape_goals)?;
    }
    goal::check(robot, &shape_goals)?;
    for of in goals {
        of.case.check(robot)?;
    }
    let cases: Vec<Case> = goals.iter().map(|goal| goal.case.clone()).collect();
    let criteria = match options.criteria.is_empty() {
        true => Criteria::default(),
        false => {
            let ranges = command_ranges(robot, &cases, options)?;
            Criteria::new(&options.criteria, model, robot, &cases, ranges)?
        }
    };
    let before = measured(&model.at(Stations::Disks), robot, &shape_goals);
    let budget = Budget::new(options.solves, options.stop.clone());
    let mut work = Work {
        model: model.at(Stations::Disks),
        goals,
        vary: vary.to_vec(),
        options,
        budget: &budget,
        robot: robot.clone(),
        cases,
        criteria,
        findings: Vec::new(),
        assumed: None,
        lower_bound: None,
    };
    work.run()?;
    let Work { model, robot, cases, criteria, findings, assumed, lower_bound, .. } = work;
    let goals: Vec<DesignGoal> =
        goals.iter().zip(&cases).map(|(of, case)| with_case(of, case)).collect();
    let shape_goals: Vec<ShapeGoal> =
        goals.iter().map(|of| of.shape_goal(&robot)).collect::<Result<_, _>>()?;
    let mut results = Vec::with_capacity(goals.len());
    for goal in &shape_goals {
        results.push(result(&model, &robot, goal)?);
    }
    let solutions: Vec<Solution> = results.iter().map(|of| of.solution.clone()).collect();
    let criteria = criteria.results(&robot, &cases, &solutions)?;
    if criteria.iter().any(|result| !result.is_met()) {
        return Err(DesignError::NotMet(criteria));
    }
    let cost = shape_goals.iter().zip(&results);
    let cost = cost.map(|(goal, of)| goal.cost(&of.solution.disks.poses)).sum();
    let all: Vec<f64> = results.iter().flat_map(|of| of.distances.clone()).collect();
    Ok(Design {
        error: root_mean_square(&shape_goals, cost),
        largest: spread(&all)[1],
        model: model.kind(),
        robot,
        goals: results,
        findings,
        ended: budget.ended(),
        solves: budget.spent(),
        criteria,
        assumed_tension: assumed,
        lower_bound: lower_bound.filter(|bound| *bound > 0.0),
        before: before.filter(|_| !all.is_empty()).map(|solutions| {
            let goals = shape_goals.iter().zip(&solutions);
            let all: Vec<f64> = goals.flat_map(|(goal, of)| distances(goal, of)).collect();
            spread(&all)
        }),
    })
}

fn measured(model: &Model, robot: &Robot, goals: &[ShapeGoal]) -> Option<Vec<Solution>> {
    goals.iter().map(|goal| model.solve(robot, &goal.case).ok()).collect()
}

fn distances(goal: &ShapeGoal, solution: &Solution) -> Vec<f64> {
    goal.misses(solution).into_iter().map(|(_, distance)| distance).collect()
}

/// How near a robot comes to a goal, by the model and by `cosserat-disks` at a fine resolution.
fn result(model: &Model, robot: &Robot, goal: &ShapeGoal) -> Result<GoalResult, DesignError> {
    let solution = model.solve(robot, &goal.case)?;
    let fine = Model::new(ModelKind::CosseratDisks, Stations::Disks, whipcord::Actuation::Natural)
        .cancelled_by(model.cancel())
        .with_tolerance(FINE);
    let check = robot
        .has_disks()
        .then(|| fine.solve(robot, &goal.case).map(|solution| distances(goal, &solution)));
    Ok(GoalResult {
        case: goal.case.clone(),
        points: goal.points.clone(),
        distances: distances(goal, &solution),
        solution,
        check,
    })
}

/// A robot that is nearer to a curve than this part of the length is on it.
const ON_CURVE: f64 = 1e-3;
/// Estimated error of the fine solve, as a part of the length.
const FINE: f64 = 1e-9;

impl Work<'_> {
    fn run(&mut self) -> Result<(), DesignError> {
        if self.vary.contains(&Vary::Cables) {
            self.number_of_cables()?;
        }
        let holes = self.cables(|of| match of {
            Vary::Holes { cable } => Some(cable),
            _ => None,
        });
        let tensions = self.tensions();
        self.check_tensions(&tensions)?;
        if !holes.is_empty() {
            self.holes(&holes, &tensions)?;
        }
        let mut rest: Vec<Vary> =
            self.vary.iter().copied().filter(|of| !matches!(of, Vary::Holes { .. })).collect();
        if !holes.is_empty() {
            rest.retain(|of| !matches!(of, Vary::Tension { .. }));
        }
        let routings: Vec<usize> = self.cables(|of| match of {
            Vary::Routing { cable } => Some(cable),
            _ => None,
        });
        if let [cable] = routings[..]
            && self.closed_form(cable)?
            && self.keeps_criteria()?
        {
            self.lower_bound = None;
            self.find(Vary::Routing { cable }, Known::ClosedForm);
            rest.retain(|of| !matches!(of, Vary::Routing { .. } | Vary::Tension { .. }));
        }
        if let Some((of, error)) = self.on_the_curve(&rest)?
            && self.keeps_criteria()?
        {
            self.lower_bound = None;
            let iterated = (error > ON_CURVE * self.robot.backbone().length)
                .then(|| self.robot.clone())
                .and_then(|robot| Some((self.cost()?, robot)));
            let Some((cost, iterated)) = iterated else {
                self.find(of, Known::Iterated);
                return Ok(());
            };
            // What cannot be met bend by bend may be met better as a whole.
            let is_better = match self.least_squares(&rest) {
                Ok(()) => self.cost().is_some_and(|found| found < cost),
                Err(error) if error.is_cancelled() => return Err(error),
                Err(_) => false,
            };
            if !is_better {
                self.robot = iterated;
                self.findings.retain(|finding| finding.what != of.to_string());
                self.find(of, Known::Iterated);
            }
            return Ok(());
        }
        if !rest.is_empty() {
            // The bound is that of the robot before.
            self.lower_bound = None;
            self.least_squares(&rest)?;
        }
        Ok(())
    }

    /// Cables as few as the bending moments of the goals allow, with routings and tensions to start from.
    fn number_of_cables(&mut self) -> Result<(), DesignError> {
        let goals = self.shape_goals()?;
        let rim = rim(&self.robot);
        let found = cable_count::found(
            &self.robot,
            &self.model,
            (&goals, rim),
            (self.options, self.budget),
        )?;
        self.find(Vary::Cables, Known::AtLeast { cables: found.rank });
        let count = found.robot.cables().len();
        self.robot = found.robot;
        self.cases = found.cases;
        if !self.criteria.is_empty() {
            self.criteria.ranges = command_ranges(&self.robot, &self.cases, self.options)?;
        }
        self.vary.retain(|of| {
            !matches!(
                of,
                Vary::Cables | Vary::Tension { .. } | Vary::Routing { .. } | Vary::Holes { .. }
            )
        });
        for cable in 0..count {
            self.vary.extend([Vary::Routing { cable }, Vary::Tension { cable }]);
        }
        Ok(())
    }
}
