//! Continuous quantities of a design by least squares: Levenberg's and Marquardt's method within bounds, with the exact derivatives of the
//! core, from several starts.

use core::f64::consts::TAU;

use whipcord::{Along, Backbone, Case, Model, Parameter, Robot, Vec3};
use whipcord_numerics::least_squares::{NoResiduals, Options};
use whipcord_numerics::random::SplitMix64;

use crate::chebyshev;
use crate::error::DesignError;
use crate::goal::ShapeGoal;
use crate::residuals::{Bounded, Ending, Problem, RefineOptions};
use crate::unknown::{Unknown, applied};

/// What least squares found.
#[derive(Clone, Debug)]
pub(crate) struct Refined {
    pub robot: Robot,
    pub cases: Vec<Case>,
    pub ending: Ending,
    /// Starts that had an answer, and how many of them ended as near as the best.
    pub starts: usize,
    pub agree: usize,
    /// Whether the targets are met and there are no objectives beside them.
    pub is_met: bool,
}

/// A mean distance by this part of the length is none.
const EXACT: f64 = 1e-7;
/// Costs that agree to this part are of one answer.
const AGREE: f64 = 0.01;
/// Distances that differ by less, as a part of the length, are the same.
const ROUNDING: f64 = 1e-9;

/// Starts but the first are each the best of so many, as these are compared by a solve each.
const DRAWN: usize = 8;

/// Steps by which tensions of several goals are fitted to what else was drawn before draws are compared.
const TENSION_STEPS: usize = 4;

/// A rest curvature bends the backbone by no more than this over its length, in rad.
const LARGEST_TURN: f64 = 30.0;

/// The backbone of a robot with its rest curvature given at these arc lengths, and the components of that as unknowns.
pub(crate) fn rest_curvature_at(robot: &Robot, at: Vec<f64>) -> (Backbone, Vec<Bounded>) {
    let (backbone, disks, length) = (robot.backbone(), robot.disks(), robot.backbone().length);
    let values: Vec<Vec3> = at.iter().map(|s| backbone.rest_curvature_at(disks, *s)).collect();
    let largest = LARGEST_TURN / length;
    let unknown = |entry: usize, axis: usize, start: f64| Bounded {
        unknown: Unknown::Parameter(Parameter::RestCurvatureAt { entry, axis }),
        start,
        range: [-largest, largest],
        starts: [start - 1.0 / length, start + 1.0 / length],
    };
    let entries = values.iter().enumerate();
    let unknowns =
        entries.flat_map(|(entry, value)| [0, 1].map(|axis| unknown(entry, axis, value[axis])));
    let unknowns = unknowns.collect();
    let rest_curvature = Along::At { arc_lengths: at, values };
    (Backbone { rest_curvature, ..backbone.clone() }, unknowns)
}

/// The best of several starts.
pub(crate) fn refine(
    model: &Model,
    robot: &Robot,
    goals: &[ShapeGoal],
    unknowns: &[Bounded],
    options: &RefineOptions<'_>,
) -> Result<Refined, DesignError> {
    let lower: Vec<f64> = unknowns.iter().map(|of| of.range[0]).collect();
    let upper: Vec<f64> = unknowns.iter().map(|of| of.range[1]).collect();
    let minimiser = Options {
        lower,
        upper,
        iterations: options.iterations,
        step: 1e-9,
        cost: 1e-7,
        ..Options::default()
    };
    let mut ends: Vec<(f64, Ending, Vec<f64>)> = Vec::new();
    let mut refusal = None;
    for start in 0..options.starts.max(1) {
        if !ends.is_empty() && options.budget.is_over() {
            break;
        }
        let mut problem = Problem::new(model, robot, goals, unknowns, options)?;
        let mut values = start_values(&mut problem, unknowns, start, options);
        match problem.constrained(&mut values, &minimiser) {
            Ok(ending) => {
                values = problem.within_rim(&values);
                let mut end = (problem.cost(&values), ending, values);
                if end.0.is_none() && start == 0 {
                    // What was given is better than no answer.
                    let given = problem.within_rim(&given_values(unknowns));
                    end = (problem.cost(&given), Ending::Refused, given);
                }
                let (cost, ending, values) = end;
                let cost = cost.unwrap_or(f64::INFINITY);
                ends.push((cost, ending, values));
                if is_met(robot, goals, options, cost) {
                    break;
                }
            }
            Err(NoResiduals::Refused(error)) if error.is_cancelled() => return Err(error),
            Err(NoResiduals::Refused(DesignError::Ended)) => {
                let given = problem.within_rim(&values);
                if let Some(cost) = problem.cost(&given) {
                    ends.push((cost, Ending::Budget, given));
                }
                refusal.get_or_insert(DesignError::Ended);
            }
            Err(NoResiduals::Refused(error)) => {
                refusal.get_or_insert(error);
            }
            Err(NoResiduals::NotFinite) => {}
        }
    }
    let least = ends.iter().map(|end| end.0).fold(f64::INFINITY, f64::min);
    let rounding = ROUNDING * robot.backbone().length;
    // Of ends that rounding tells apart alone, that of the first start: where all that keep to the criteria are as good, the robot is changed least.
    let is_best = |end: &&(f64, Ending, Vec<f64>)| end.0.sqrt() <= least.sqrt() + rounding;
    let best = ends.iter().find(is_best).filter(|best| best.0.is_finite());
    let Some((cost, ending, values)) = best else {
        return Err(refusal.unwrap_or(DesignError::NotConverged {
            what: "least squares",
            iterations: options.iterations,
            change: f64::INFINITY,
            advice: "give a start with an answer: other tensions, or a smaller load",
        }));
    };
    let near = |of: &&(f64, Ending, Vec<f64>)| {
        let length = robot.backbone().length;
        of.0.sqrt() <= (1.0 + AGREE) * cost.sqrt() + 1e-7 * length
    };
    let list: Vec<Unknown> = unknowns.iter().map(|of| of.unknown).collect();
    let cases: Vec<Case> = goals.iter().map(|goal| goal.case.clone()).collect();
    let (changed, cases) = applied(robot, &cases, &list, values)?;
    Ok(Refined {
        robot: changed,
        cases,
        ending: *ending,
        starts: ends.len(),
        agree: ends.iter().filter(near).count(),
        is_met: is_met(robot, goals, options, *cost),
    })
}

/// Whether nothing can come nearer to the goals.
fn is_met(robot: &Robot, goals: &[ShapeGoal], options: &RefineOptions<'_>, cost: f64) -> bool {
    if options.criteria.is_some_and(|criteria| criteria.has_objectives()) {
        return false;
    }
    let points = goals.iter().map(|goal| goal.points.len()).sum::<usize>();
    #[allow(clippy::cast_precision_loss, reason = "few points")]
    let most = EXACT * robot.backbone().length * (points as f64).sqrt();
    points > 0 && cost.sqrt() <= most
}

/// The given start, or the best of some others.
fn start_values(
    problem: &mut Problem<'_>,
    unknowns: &[Bounded],
    start: usize,
    options: &RefineOptions<'_>,
) -> Vec<f64> {
    let Some(other) = start.checked_sub(1) else { return given_values(unknowns) };
    let mut best: Option<(f64, Vec<f64>)> = None;
    for draw in 0..DRAWN {
        let mut values = drawn_values(unknowns, other * DRAWN + draw, options);
        if draw > 0 && options.budget.is_over() {
            break;
        }
        if problem.cases().len() > 1 {
            problem.fit_tensions(&mut values, unknowns, options, TENSION_STEPS);
        }
        let cost = problem.cost(&values).unwrap_or(f64::INFINITY);
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, values));
        }
    }
    best.map_or_else(|| given_values(unknowns), |(_, values)| values)
}

fn given_values(unknowns: &[Bounded]) -> Vec<f64> {
    unknowns.iter().map(|of| of.start.clamp(of.range[0], of.range[1])).collect()
}

/// Cables on helices that start at any angle, all else anywhere between its starts.
fn drawn_values(unknowns: &[Bounded], draw: usize, options: &RefineOptions<'_>) -> Vec<f64> {
    let mut random = SplitMix64::of(options.seed, draw as u64);
    let mut helices: Vec<(usize, [f64; 3])> = Vec::new();
    unknowns
        .iter()
        .map(|of| {
            let value = match of.unknown {
                Unknown::Course { cable, axis, node, nodes } => {
                    let known = helices.iter().find(|(of, _)| *of == cable).map(|(_, of)| *of);
                    let [radius, angle, turn] = known.unwrap_or_else(|| {
                        let radius = options.rim * (0.3 + 0.6 * random.next_part());
                        let helix =
                            [radius, TAU * random.next_part(), TAU * (random.next_part() - 0.5)];
                        helices.push((cable, helix));
                        helix
                    });
                    let part = chebyshev::places(nodes).nth(node).unwrap_or(0.0);
                    let (sin, cos) = (angle + turn * part).sin_cos();
                    radius * if axis == 0 { cos } else { sin }
                }
                _ => of.starts[0] + (of.starts[1] - of.starts[0]) * random.next_part(),
            };
            value.clamp(of.range[0], of.range[1])
        })
        .collect()
}
