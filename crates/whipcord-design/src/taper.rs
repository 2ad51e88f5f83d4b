//! The diameters with which a robot takes a curve under its tensions and loads.

use whipcord::{Along, Backbone, Case, Model, Robot, Section, Solution, Statics as _};

use crate::curve::Curve;
use crate::error::DesignError;
use crate::pre_bend::Target;

/// A backbone whose diameter changes along it.
#[derive(Clone, Debug)]
pub struct Taper {
    /// The robot with these diameters.
    pub robot: Robot,
    /// Outer diameter at the places in m.
    pub diameters: Vec<f64>,
    /// Arc lengths of the places in m.
    pub places: Vec<f64>,
    /// Greatest distance in m between the backbone and the curve at the places and between them.
    pub error: f64,
    /// The shape under the case.
    pub solution: Solution,
}

const ITERATIONS: usize = 80;
/// The part of the length by which the distance has to fall to go on.
const CONVERGED: f64 = 1e-9;
/// The bending stiffness of a place is changed at most by this factor in a step.
const LARGEST_FACTOR: f64 = 2.0;

/// The diameters of a solid round backbone at equally spaced places within a least and a greatest one in m, with linear interpolation between them, with which a robot takes a curve under a case:
/// `EI ← EI κ_actual/κ_wanted` until the distance no longer falls, eq. (9). `model` is a model of a rod. The loads must bend the robot the way of the
/// curve, which must be bent everywhere.
///
/// # Errors
/// [`DesignError::Backbone`] for a backbone that is not solid and round, [`DesignError::Curve`] for a curve that is straight somewhere, and
/// [`DesignError::Solve`] where the model has no answer.
pub fn taper_for_curve(
    model: &Model,
    robot: &Robot,
    case: &Case,
    curve: &Curve,
    places: usize,
    [least, greatest]: [f64; 2],
) -> Result<Taper, DesignError> {
    let target = Target::new(model, robot, curve, places)?;
    let Some(Section::Round { inner, .. }) = &robot.backbone().section else {
        let what = "a taper is that of a round backbone: give a diameter and a material".to_owned();
        return Err(DesignError::Backbone { what });
    };
    let is_solid = inner.values().iter().all(|diameter| *diameter == 0.0);
    if !is_solid || robot.backbone().stiffness.is_some() {
        let what = "a taper is that of a solid backbone of a material: take out inner_diameter and stiffness";
        return Err(DesignError::Backbone { what: what.to_owned() });
    }
    if !(least > 0.0 && least <= greatest && greatest.is_finite()) {
        let what =
            format!("diameters from {least} to {greatest} m cannot be: give least ≤ greatest");
        return Err(DesignError::Curve { what });
    }
    let length = robot.backbone().length;
    let wanted = target.wanted(&target.frames(None));
    let turns_back = wanted.windows(2).any(|pair| pair[0].dot(pair[1]) <= 0.0);
    if turns_back || wanted.iter().any(|bend| bend.norm() * length < 1e-3) {
        let what = "the curve is straight somewhere, which takes an infinite stiffness: bend it everywhere";
        return Err(DesignError::Curve { what: what.to_owned() });
    }
    let start = robot.backbone().outer_radius_at(robot.disks(), 0.5 * length) * 2.0;
    let mut diameters = vec![start.clamp(least, greatest); places];
    let mut best: Option<Taper> = None;
    let mut share = 1.0;
    for _ in 0..ITERATIONS {
        let outer = Along::At { arc_lengths: target.places.clone(), values: diameters.clone() };
        let section = Some(Section::Round { outer, inner: inner.clone() });
        let backbone = Backbone { section, ..robot.backbone().clone() };
        let tapered = target.with_backbone(robot, backbone)?;
        let solved = target.model.solve(&tapered, case);
        let error = solved.as_ref().map_or(f64::INFINITY, |solution| target.error(solution));
        let before = best.as_ref().map_or(f64::INFINITY, |best| best.error);
        match (solved, &best) {
            (Err(reason), None) => return Err(reason.into()),
            (Ok(solution), _) if error < before => {
                let is_done = before - error <= CONVERGED * length;
                let (diameters, places) = (diameters.clone(), target.places.clone());
                best = Some(Taper { robot: tapered, diameters, places, error, solution });
                if is_done {
                    break;
                }
            }
            _ => {
                share *= 0.5;
                if share < 1e-3 {
                    break;
                }
            }
        }
        let Some(best) = &best else { continue };
        let actual = target.at_places(&target.actual(&best.solution));
        let wanted = target.at_places(&target.wanted(&target.frames(Some(&best.solution))));
        diameters = best
            .diameters
            .iter()
            .zip(actual.iter().zip(&wanted))
            .map(|(diameter, (actual, wanted))| {
                // The part of the bend that goes the wanted way.
                let ratio = actual.dot(*wanted) / wanted.dot(*wanted);
                let factor = ratio.clamp(1.0 / LARGEST_FACTOR, LARGEST_FACTOR);
                // EI goes with the fourth power of the diameter.
                (diameter * factor.powf(0.25 * share)).clamp(least, greatest)
            })
            .collect();
    }
    best.ok_or(DesignError::NotConverged {
        what: "taper",
        iterations: ITERATIONS,
        change: f64::INFINITY,
        advice: "give tensions and loads that bend the robot the way of the curve",
    })
}
