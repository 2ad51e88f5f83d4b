//! What `whipcord design` is asked for, from what a file says.

use thiserror::Error;
use whipcord::{CableCommand, Case, Robot, Vec3};
use whipcord_design::{
    DesignGoal, DesignOptions, FixedHole, HoleRules, TargetShape, Tolerances, UnknownVary, Vary,
};
use whipcord_inverse::{PathPoint, Target};

use crate::read::{DesignShape, DesignTable, DesignTarget, Goal, Measured};

/// A design that is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignProblem {
    /// The shapes, each with its commands.
    pub goals: Vec<DesignGoal>,
    /// What may change.
    pub vary: Vec<Vary>,
    /// Rules, bounds and budgets.
    pub options: DesignOptions,
    /// Deviations of manufacture.
    pub tolerances: Tolerances,
}

/// Why what is asked for is no design.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoDesignProblem {
    /// There is no shape.
    #[error(
        "there is no target shape: add [[design.targets]] or [target] with `tip` or `shape` to the file, or give a target, such as \"arc, angle = 90 deg\" or a table of points"
    )]
    NoTarget,
    /// A target is a path, a pose or a direction.
    #[error(
        "the target of the file is {what}, which is no shape: give `tip` or `shape` in [target], or [[design.targets]]"
    )]
    NoShape {
        /// What it is.
        what: &'static str,
    },
    /// Nothing was measured.
    #[error("no disks were measured: add [measured] with positions of disks in the last step")]
    NotMeasured,
    /// Nothing may change.
    #[error(
        "nothing may change: give what to vary, such as cables[0].holes, or `vary` in [design]"
    )]
    NothingVaried,
    /// A path names nothing.
    #[error(transparent)]
    Vary(#[from] UnknownVary),
    /// A fixed hole is that of a cable that the robot does not have.
    #[error("there is no cable `{0}` whose hole could be fixed")]
    NoCable(String),
    /// A path without tensions that vary.
    #[error(
        "the points of a path need tensions of their own: vary them as well, as with cables[*].tension"
    )]
    PathTensions,
    /// Tensions of a target are not as many as cables.
    #[error("a target has {given} tensions, but the robot has {cables} cables")]
    Tensions {
        /// Given.
        given: usize,
        /// Cables.
        cables: usize,
    },
}

impl DesignTable {
    /// What is asked for of a robot and a case with this target and these limits.
    ///
    /// # Errors
    /// [`NoDesignProblem`].
    pub fn problem(
        &self,
        robot: &Robot,
        case: &Case,
        goal: &Goal,
        measured: Option<&Measured>,
    ) -> Result<DesignProblem, NoDesignProblem> {
        let goals = match self.goals(robot, case, goal, measured) {
            // Criteria need no target.
            Err(NoDesignProblem::NoTarget) if !self.criteria.is_empty() => {
                let target = TargetShape::Points(Vec::new());
                vec![DesignGoal { case: step(case, 0, 1), target, weight: 1.0 }]
            }
            goals => goals?,
        };
        let mut vary = Vec::new();
        for path in &self.vary {
            for of in Vary::parse(path, robot)? {
                if !vary.contains(&of) {
                    vary.push(of);
                }
            }
        }
        if vary.is_empty() {
            return Err(NoDesignProblem::NothingVaried);
        }
        let is_path = |of: &DesignTarget| matches!(of.shape, DesignShape::Path(..));
        let has_path = match self.targets.is_empty() {
            true => goal.target.is_none() && !goal.path.is_empty(),
            false => self.targets.iter().any(is_path),
        };
        let is_tension = |of: &Vary| matches!(of, Vary::Tension { .. } | Vary::Cables);
        if has_path && !vary.iter().any(is_tension) {
            return Err(NoDesignProblem::PathTensions);
        }
        let named = |name: &str| robot.cables().iter().position(|cable| cable.name == name);
        let fixed = self.fixed.iter().map(|entry| {
            let cable = named(&entry.cable);
            let cable = cable.ok_or_else(|| NoDesignProblem::NoCable(entry.cable.clone()))?;
            // Disks count from 1 in files.
            Ok(FixedHole { cable, disk: entry.disk.saturating_sub(1), hole: entry.hole })
        });
        let usual = DesignOptions::default();
        let limits =
            |cable: usize| goal.own.get(cable).and_then(|own| own.tension).or(goal.all.tension);
        let shortenings = |cable: usize| {
            let given = goal.own.get(cable).and_then(|own| own.shortening).or(goal.all.shortening);
            given.map(|pair| pair.map(|of| of.in_metres(robot.cable_length(cable))))
        };
        let options = DesignOptions {
            criteria: self.criteria.clone(),
            shortenings: (0..robot.cables().len()).map(shortenings).collect(),
            rules: HoleRules {
                largest_jump: self.max_jump,
                fixed: fixed.collect::<Result<_, NoDesignProblem>>()?,
                are_distinct: self.distinct,
                do_not_cross: self.crossing == Some(false),
            },
            diameters: self.diameter,
            tensions: (0..robot.cables().len()).map(limits).collect(),
            degree: self.degree.unwrap_or(usual.degree),
            places: self.places.unwrap_or(usual.places),
            starts: self.starts.unwrap_or(usual.starts),
            iterations: self.iterations.unwrap_or(usual.iterations),
            solves: self.solves.unwrap_or(usual.solves),
            ..usual
        };
        Ok(DesignProblem { goals, vary, options, tolerances: self.tolerances(robot) })
    }

    /// The standard deviations of manufacture, the usual ones where the file gives none.
    #[must_use]
    pub fn tolerances(&self, robot: &Robot) -> Tolerances {
        let usual = Tolerances::of_robot(robot);
        let given = &self.tolerances;
        Tolerances {
            hole_radius: given.hole_radius.unwrap_or(usual.hole_radius),
            hole_angle: given.hole_angle.unwrap_or(usual.hole_angle),
            disk_position: given.disk_position.unwrap_or(usual.disk_position),
            stiffness: given.stiffness.unwrap_or(usual.stiffness),
            tension: given.tension.unwrap_or(usual.tension),
            samples: given.samples.unwrap_or(usual.samples),
            seed: given.seed.map_or(usual.seed, |seed| seed as u64),
        }
    }

    fn goals(
        &self,
        robot: &Robot,
        case: &Case,
        goal: &Goal,
        measured: Option<&Measured>,
    ) -> Result<Vec<DesignGoal>, NoDesignProblem> {
        let last = robot.disks().count() - 1;
        if self.targets.is_empty() {
            let points = match &goal.target {
                Some(Target::Tip(point)) => vec![(last, *point)],
                Some(Target::Shape(points)) => points.clone(),
                Some(Target::Pose(_)) => return Err(NoDesignProblem::NoShape { what: "a pose" }),
                Some(Target::Axis { .. }) => {
                    return Err(NoDesignProblem::NoShape { what: "a direction" });
                }
                None if !goal.path.is_empty() => {
                    let place = |point: &PathPoint| match point.target {
                        Target::Tip(place) => Ok(place),
                        _ => Err(NoDesignProblem::NoShape { what: "a path with orientations" }),
                    };
                    let places =
                        goal.path.iter().map(place).collect::<Result<Vec<_>, NoDesignProblem>>()?;
                    return Ok(tips(&step(case, 0, 1), last, &places, 1.0));
                }
                None => return Err(NoDesignProblem::NoTarget),
            };
            let case = step(case, 0, 1);
            return Ok(vec![DesignGoal { case, target: TargetShape::Points(points), weight: 1.0 }]);
        }
        let count = self.targets.len();
        let of = |(number, target): (usize, &DesignTarget)| {
            let mut case = step(case, number, count);
            if let Some(tensions) = &target.tension {
                let cables = robot.cables().len();
                if tensions.len() != cables {
                    return Err(NoDesignProblem::Tensions { given: tensions.len(), cables });
                }
                case.commands = tensions
                    .iter()
                    .map(|&tension| CableCommand { tension: Some(tension), shortening: None })
                    .collect();
            }
            let weight = target.weight.unwrap_or(1.0);
            let shape = match &target.shape {
                DesignShape::Path(places, _) => return Ok(tips(&case, last, places, weight)),
                DesignShape::Curve(curve) => TargetShape::Curve(*curve),
                DesignShape::Points(points, _) => TargetShape::Points(points.clone()),
                DesignShape::Tip(point) => TargetShape::Points(vec![(last, *point)]),
                DesignShape::Measured => {
                    let disks = measured.map(|of| of.disks.as_slice()).unwrap_or_default();
                    // The base is where it is.
                    let points: Vec<(usize, Vec3)> = disks
                        .iter()
                        .filter(|of| of.disk > 1)
                        .map(|of| (of.disk - 1, of.position))
                        .collect();
                    if points.is_empty() {
                        return Err(NoDesignProblem::NotMeasured);
                    }
                    TargetShape::Points(points)
                }
            };
            Ok(vec![DesignGoal { case, target: shape, weight }])
        };
        let goals = self.targets.iter().enumerate().map(of);
        Ok(goals.collect::<Result<Vec<_>, NoDesignProblem>>()?.concat())
    }
}

/// A goal for each place of the tip.
fn tips(case: &Case, last: usize, places: &[Vec3], weight: f64) -> Vec<DesignGoal> {
    let goal = |place: &Vec3| DesignGoal {
        case: case.clone(),
        target: TargetShape::Points(vec![(last, *place)]),
        weight,
    };
    places.iter().map(goal).collect()
}

/// The case of a target: the step with its number where there are as many steps as targets, else the last.
fn step(case: &Case, number: usize, count: usize) -> Case {
    let steps = case.before.len() + 1;
    let number = if steps == count { number } else { steps - 1 };
    case.single_steps().nth(number).unwrap_or_else(|| case.clone())
}

/// The case of a designed robot: the commands of its goals, as steps where there are several.
#[must_use]
pub fn designed_case(robot: &Robot, before: &Case, goals: &[Case]) -> Case {
    let Some((last, earlier)) = goals.split_last() else { return before.clone() };
    let has_steps = before.before.len() == earlier.len();
    Case {
        before: earlier.iter().map(|case| case.commands.clone()).collect(),
        loads_before: if has_steps { before.loads_before.clone() } else { Vec::new() },
        motors: if has_steps { before.motors.clone() } else { last.motors.clone() },
        independent: !earlier.is_empty() && (before.independent || robot.has_history()),
        ..last.clone()
    }
}
