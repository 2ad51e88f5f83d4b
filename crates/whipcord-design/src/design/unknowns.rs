//! Continuous quantities as unknowns of least squares, with their bounds and starts.

use core::f64::consts::TAU;

use whipcord::section::section_stiffness;
use whipcord::{Along, Backbone, Case, Parameter, Robot, Section};

use super::work::Work;
use crate::chebyshev;
use crate::criteria::by_tension;
use crate::error::DesignError;
use crate::problem::{DesignGoal, DesignOptions, Known, TargetShape, Unconverged};
use crate::refine::{Refined, refine, rest_curvature_at};
use crate::residuals::{Bounded, Ending, RefineOptions};
use crate::route::largest_radius;
use crate::unknown::{Unknown, least_distance};
use crate::vary::Vary;

impl Work<'_> {
    fn diameter(&self) -> f64 {
        let backbone = self.robot.backbone();
        2.0 * backbone.outer_radius_at(self.robot.disks(), 0.5 * backbone.length)
    }

    pub(super) fn diameter_range(&self) -> [f64; 2] {
        let now = self.diameter();
        self.options.diameters.unwrap_or([0.25 * now, 4.0 * now])
    }

    /// The limits of a tension; where none are given, those that are assumed.
    pub(super) fn tension_range(&mut self, cable: usize) -> Result<[f64; 2], DesignError> {
        let mut range = match self.options.tensions.get(cable) {
            Some(Some(limits)) => *limits,
            _ => {
                let range = assumed_tensions(&self.robot, &self.cases)?;
                self.assumed = Some(range);
                range
            }
        };
        if let Some(greatest) = self.criteria.greatest_tension() {
            if greatest < range[0] {
                let what = format!(
                    "the criterion tension allows {greatest} N at most, but [limits] at least {} N",
                    range[0]
                );
                return Err(DesignError::Criterion { what });
            }
            range[1] = range[1].min(greatest);
        }
        Ok(range)
    }

    pub(super) fn least_squares(&mut self, vary: &[Vary]) -> Result<(), DesignError> {
        let tensions: Vec<Vary> =
            vary.iter().copied().filter(|of| matches!(of, Vary::Tension { .. })).collect();
        // Several targets have tensions of their own: what is shared is looked for from the best of these.
        if self.cases.len() > 1
            && !tensions.is_empty()
            && tensions.len() < vary.len()
            && let Ok(first) = self.refined(&tensions, 1)
        {
            self.cases = first.cases;
        }
        let given = (self.robot.clone(), self.cases.clone(), self.cost());
        let refined = self.refined(vary, self.options.starts)?;
        let known = known_of(&refined, self.options.iterations);
        self.robot = refined.robot;
        self.cases = refined.cases;
        // A start near which the model has no other answer is left behind, and may be the best all the same.
        if self.criteria.is_empty()
            && let (Some(before), Some(now)) = (given.2, self.cost())
            && before < now
        {
            (self.robot, self.cases) = (given.0, given.1);
        }
        for of in vary {
            self.find(*of, known);
        }
        Ok(())
    }

    /// What least squares makes of these.
    pub(super) fn refined(&mut self, vary: &[Vary], starts: usize) -> Result<Refined, DesignError> {
        let mut unknowns = Vec::new();
        for of in vary {
            self.unknowns(*of, &mut unknowns)?;
        }
        let goals = self.shape_goals()?;
        let is_curve = |of: &DesignGoal| matches!(of.target, TargetShape::Curve(_));
        let has_moving = vary.contains(&Vary::DiskPositions) && self.goals.iter().any(is_curve);
        let options = RefineOptions {
            starts,
            iterations: self.options.iterations,
            seed: self.options.seed,
            rim: rim(&self.robot),
            criteria: Some(&self.criteria),
            on_curves: has_moving.then_some(self.goals),
            budget: self.budget,
        };
        refine(&self.model, &self.robot, &goals, &unknowns, &options)
    }

    /// The numbers of a part, with the robot prepared so that it has them.
    fn unknowns(&mut self, of: Vary, into: &mut Vec<Bounded>) -> Result<(), DesignError> {
        let length = self.robot.backbone().length;
        match of {
            Vary::Holes { .. } | Vary::Cables => {}
            Vary::Tension { cable } => {
                let range = self.tension_range(cable)?;
                for goal in 0..self.cases.len() {
                    let start = self.cases[goal].commands[cable].tension.unwrap_or(0.0);
                    let unknown = Unknown::Tension { goal, cable };
                    // Of no tension the derivatives say nothing where the cable is slack.
                    let start = start.clamp(range[0], range[1]).max(0.01 * range[1]);
                    into.push(Bounded { unknown, start, range, starts: range });
                }
            }
            Vary::Routing { cable } => {
                let known = match &self.robot.cables()[cable].routing {
                    whipcord::Routing::Polynomial { x, y } => x.len().max(y.len()),
                    _ => 0,
                };
                let nodes = known.max(self.options.degree + 1);
                let rim = rim(&self.robot);
                let route = &self.robot.routes()[cable];
                for (node, part) in chebyshev::places(nodes).enumerate() {
                    let offset = route.at((part * length).min(route.end())).offset;
                    for axis in 0..2 {
                        let unknown = Unknown::Course { cable, axis, node, nodes };
                        let range = [-1.5 * rim, 1.5 * rim];
                        into.push(Bounded { unknown, start: offset[axis], range, starts: range });
                    }
                }
                let mut cables = self.robot.cables().to_vec();
                cables[cable].ends_at = None;
                self.rebuild(self.robot.backbone().clone(), cables)?;
            }
            Vary::RestCurvature => {
                let (backbone, unknowns) = rest_curvature_at(&self.robot, self.places(length)?);
                into.extend(unknowns);
                self.rebuild(backbone, self.robot.cables().to_vec())?;
            }
            Vary::Diameters => {
                let Some(Section::Round { inner, .. }) = &self.robot.backbone().section else {
                    let what =
                        "diameters are those of a round backbone: give a diameter and a material";
                    return Err(DesignError::Backbone { what: what.to_owned() });
                };
                if self.robot.backbone().stiffness.is_some() {
                    let what = "the stiffness is given, so that no diameter changes it: take out stiffness";
                    return Err(DesignError::Backbone { what: what.to_owned() });
                }
                let at = self.places(length)?;
                let range = self.diameter_range();
                let (backbone, disks) = (self.robot.backbone(), self.robot.disks());
                let diameter = |s: &f64| 2.0 * backbone.outer_radius_at(disks, *s);
                let values: Vec<f64> =
                    at.iter().map(|s| diameter(s).clamp(range[0], range[1])).collect();
                let outer = Along::At { arc_lengths: at, values: values.clone() };
                let section = Some(Section::Round { outer, inner: inner.clone() });
                let backbone = Backbone { section, ..self.robot.backbone().clone() };
                self.rebuild(backbone, self.robot.cables().to_vec())?;
                for (entry, start) in values.into_iter().enumerate() {
                    let unknown = Unknown::Parameter(Parameter::DiameterAt { entry });
                    let starts = [0.7 * start, 1.4 * start];
                    into.push(Bounded { unknown, start, range, starts });
                }
            }
            Vary::DiskPositions => {
                let disks = self.robot.disks();
                let least = least_distance(disks, length);
                #[allow(clippy::cast_precision_loss, reason = "few disks")]
                let pitch = length / (disks.count() - 1) as f64;
                for disk in 1..disks.count() - 1 {
                    #[allow(clippy::cast_precision_loss, reason = "few disks")]
                    let middle = pitch * disk as f64;
                    // Disks that stay within half a pitch keep their order and their least distance.
                    let half = 0.5 * (pitch - least);
                    let range = [middle - half, middle + half];
                    let start = disks.arc_lengths[disk].clamp(range[0], range[1]);
                    let unknown = Unknown::DiskPosition { disk };
                    into.push(Bounded { unknown, start, range, starts: range });
                }
            }
            Vary::Parameter(parameter) => {
                let start = parameter.value(&self.robot, &self.cases[0])?;
                let scale = if start == 0.0 { 1.0 / length } else { start.abs() };
                let (range, starts) = match start > 0.0 {
                    true => ([0.1 * start, 10.0 * start], [0.5 * start, 2.0 * start]),
                    false => {
                        let far = [start - 10.0 * scale, start + 10.0 * scale];
                        (far, [start - scale, start + scale])
                    }
                };
                into.push(Bounded { unknown: Unknown::Parameter(parameter), start, range, starts });
            }
        }
        Ok(())
    }

    /// Arc lengths at which a rest curvature or a diameter is given: where few points are to be met, more places would be free.
    fn places(&self, length: f64) -> Result<Vec<f64>, DesignError> {
        let points = self.goals[0].points(&self.robot)?.len();
        // Without points criteria decide, for which the disks are as fine as needed.
        let points = if points == 0 { self.robot.disks().count() } else { points };
        let count = self.options.places.min(points + 1).max(3);
        Ok(whipcord::equally_spaced(0.0, length, count).collect())
    }

    fn rebuild(
        &mut self,
        backbone: Backbone,
        cables: Vec<whipcord::Cable>,
    ) -> Result<(), DesignError> {
        self.robot = Robot::new(backbone, self.robot.disks().clone(), cables)?
            .with_motors(self.robot.motors().to_vec())?;
        Ok(())
    }
}

/// What is known of what least squares found.
pub(super) fn known_of(refined: &Refined, iterations: usize) -> Known {
    let starts = refined.starts;
    if refined.is_met && refined.ending != Ending::Constraints {
        return Known::Met;
    }
    let reason = match refined.ending {
        Ending::Converged => return Known::LeastSquares { starts, agree: refined.agree },
        Ending::Steps => Unconverged::Steps(iterations),
        Ending::Stalled => Unconverged::Stalled,
        Ending::Refused => Unconverged::Refused,
        Ending::Constraints => Unconverged::Constraints,
        Ending::Budget => Unconverged::Budget,
    };
    Known::Unconverged { starts, reason }
}

/// How far from the axis a cable may be in m: the rims of the disks; of a body without disks its surface.
pub(super) fn rim(robot: &Robot) -> f64 {
    if robot.has_disks() {
        return largest_radius(robot);
    }
    let length = robot.backbone().length;
    let radius = robot.backbone().outer_radius_at(robot.disks(), 0.5 * length);
    if radius > 0.0 { radius } else { 0.05 * length }
}

/// Tensions from none to twice what is given, or to what bends the backbone by a turn.
fn assumed_tensions(robot: &Robot, cases: &[Case]) -> Result<[f64; 2], DesignError> {
    let length = robot.backbone().length;
    let stiffness = section_stiffness(robot, 0.5 * length, 0.5 * length)?;
    let turn = TAU * stiffness[3][3] / (length * rim(robot));
    let given = cases.iter().flat_map(|case| &case.commands);
    let given = given.filter_map(|command| command.tension).fold(0.0, f64::max);
    Ok([0.0, turn.max(2.0 * given)])
}

/// Between which commands a workspace is: tensions in N, or shortenings in m of cables without tensions.
pub(super) fn command_ranges(
    robot: &Robot,
    cases: &[Case],
    options: &DesignOptions,
) -> Result<Vec<[f64; 2]>, DesignError> {
    let cables = 0..robot.cables().len();
    if cases.iter().all(by_tension) {
        let assumed = assumed_tensions(robot, cases)?;
        let range = |cable| options.tensions.get(cable).copied().flatten().unwrap_or(assumed);
        return Ok(cables.map(range).collect());
    }
    let range = |cable: usize| {
        let given = cases.iter().filter_map(|case| case.commands.get(cable)?.shortening);
        let given = given.map(|of| of.in_metres(robot.cable_length(cable)).abs());
        let greatest = given.fold(0.0, f64::max);
        // About what bends the robot by a quarter of a turn.
        let usual = if greatest > 0.0 { 2.0 * greatest } else { 1.5 * rim(robot) };
        options.shortenings.get(cable).copied().flatten().unwrap_or([-usual, usual])
    };
    Ok(cables.map(range).collect())
}
