//! What no single arc can be, by name.

use super::arc::{Arc, Elasticity};
use crate::case::Case;
use crate::error::SolveError;
use crate::kind::ModelKind;
use crate::robot::{Robot, Routing};
use crate::section::Section;
use crate::section::of_robot::section_at;
use crate::statics::command::Command;

/// Offsets and slopes below this fraction of the backbone's length are none.
const PARALLEL: f64 = 1e-12;

fn unsupported(path: impl Into<String>, what: &'static str, advice: &'static str) -> SolveError {
    SolveError::Unsupported { model: ModelKind::ConstantCurvature, path: path.into(), what, advice }
}

/// The offsets of cables that run parallel to the backbone up to its tip.
pub(super) fn offsets(robot: &Robot) -> Result<Vec<[f64; 2]>, SolveError> {
    let length = robot.backbone().length;
    let mut offsets = Vec::with_capacity(robot.cables().len());
    for (i, (cable, route)) in robot.cables().iter().zip(robot.routes()).enumerate() {
        if route.end() < length * (1.0 - PARALLEL) {
            let key = if cable.ends_at.is_some() { "ends_at" } else { "holes" };
            return Err(unsupported(
                format!("cables[{i}].{key}"),
                "a cable that ends before the tip",
                "one arc bends alike all along: let it end at the tip, or use piecewise-constant-curvature or cosserat",
            ));
        }
        if let Some(path) = leaves_parallel(robot, i) {
            return Err(unsupported(
                path,
                "a cable that does not run parallel to the backbone",
                "one arc takes straight cables only: use four-bar, piecewise-constant-curvature or cosserat",
            ));
        }
        let offset = route.at(0.0).offset;
        offsets.push([offset.x, offset.y]);
    }
    Ok(offsets)
}

/// Refuses a case with obstacles.
pub(super) fn obstacles(case: &Case) -> Result<(), SolveError> {
    if case.obstacles.is_empty() {
        return Ok(());
    }
    Err(unsupported(
        "obstacles",
        "contact forces would bend the arc unevenly",
        "use piecewise-constant-curvature, pseudo-rigid-body, cosserat or cosserat-disks, or four-bar with the strain-energy objective",
    ))
}

/// Where the course of a cable leaves the parallel to the backbone, in the terms of the robot file.
fn leaves_parallel(robot: &Robot, cable: usize) -> Option<String> {
    let tiny = PARALLEL * robot.backbone().length;
    match &robot.cables()[cable].routing {
        Routing::Holes { holes, .. } => {
            let radii = &robot.disks().hole_circle_radii;
            let other = (1..holes.len())
                .find(|&k| holes[k] != holes[0] || (radii[k] - radii[0]).abs() > tiny)?;
            Some(if holes[other] == holes[0] {
                format!("disks.hole_circle_radius[{other}]")
            } else {
                format!("cables[{cable}].holes[{other}]")
            })
        }
        Routing::Straight { .. } => None,
        Routing::Helix { turns, radius, .. } => {
            (*turns != 0.0 && *radius > tiny).then(|| format!("cables[{cable}].routing.turns"))
        }
        Routing::Linear { start, end } => {
            let apart = (0..2).any(|k| (end[k] - start[k]).abs() > tiny);
            apart.then(|| format!("cables[{cable}].routing.end"))
        }
        Routing::Polynomial { x, y } => [("x", x), ("y", y)].iter().find_map(|(name, list)| {
            let power = list.iter().skip(1).position(|c| *c != 0.0)? + 1;
            Some(format!("cables[{cable}].routing.{name}[{power}]"))
        }),
    }
}

/// The arc that the backbone is at rest.
pub(super) fn rest(robot: &Robot) -> Result<Arc, SolveError> {
    let values = robot.backbone().rest_curvature.values();
    let first = values[0];
    if values.iter().any(|u| *u != first) || first.z != 0.0 {
        return Err(unsupported(
            "backbone.rest_curvature",
            "a backbone that is no arc of a circle at rest",
            "one arc has one curvature and no twist: use piecewise-constant-curvature or cosserat",
        ));
    }
    Ok(Arc { length: robot.backbone().length, curvature: [first.x, first.y], stretch: 1.0 })
}

/// The compliance of a backbone that bends alike all along, or why it has none.
pub(super) fn elasticity(robot: &Robot) -> Result<Elasticity, SolveError> {
    let at = |s: f64, inside: f64| {
        section_at(robot, s, inside).map_err(|error| error.of(ModelKind::ConstantCurvature))
    };
    let backbone = robot.backbone();
    let mut places = backbone.places();
    places.extend_from_slice(&robot.disks().arc_lengths);
    places.sort_by(f64::total_cmp);
    let first: Section = at(0.0, 0.0)?;
    for piece in places.windows(2) {
        let middle = 0.5 * (piece[0] + piece[1]);
        for &s in piece {
            let here = at(s, middle)?;
            if here.compliance != first.compliance || here.coupling() != first.coupling() {
                let path = match (&backbone.stiffness, &backbone.section) {
                    _ if !backbone.segments.is_empty() => "backbone.segments",
                    (None, Some(crate::robot::Section::Round { .. })) => "backbone.diameters",
                    (None, _) => "backbone.section",
                    (Some(_), _) => "backbone.stiffness",
                };
                return Err(unsupported(
                    path,
                    "a backbone that is not equally stiff all along",
                    "tensions do not bend it to one arc: give the cables' shortenings, or use piecewise-constant-curvature or cosserat",
                ));
            }
        }
    }
    if first.coupling().is_some() {
        return Err(unsupported(
            "backbone.stiffness.matrix",
            "strains that are coupled",
            "tensions do not bend it to one arc: give the cables' shortenings, or use cosserat",
        ));
    }
    let compliance = first.compliance;
    Ok(Elasticity {
        bending: [compliance.bending.x, compliance.bending.y],
        axial: compliance.shear.z,
    })
}

/// Refuses loads.
pub(super) fn loads(case: &Case) -> Result<(), SolveError> {
    match case.loads.first() {
        None => Ok(()),
        Some((path, what)) => Err(unsupported(
            path,
            what,
            "a loaded backbone is no arc: leave it out, or use piecewise-constant-curvature or cosserat",
        )),
    }
}

/// Refuses what a cable's command makes of friction and of its stretch.
pub(super) fn command(
    robot: &Robot,
    cable: usize,
    command: Command,
    elasticity: &Result<Elasticity, SolveError>,
) -> Result<(), SolveError> {
    let this = &robot.cables()[cable];
    match command {
        Command::Tension(_) => {
            if let Err(error) = elasticity {
                return Err(error.clone());
            }
            if this.has_friction() {
                return Err(unsupported(
                    format!("cables[{cable}].friction"),
                    "friction on a cable that is given its tension",
                    "the tension then falls along the robot: give its shortening, or use cosserat-disks",
                ));
            }
        }
        Command::Length { compliance, .. } => {
            if compliance > 0.0 && elasticity.is_err() {
                return Err(unsupported(
                    robot.path_of_stretch(cable).unwrap_or_default(),
                    "a cable or drive that stretches on a backbone of which no stiffness is of use",
                    "how far it stretches is not known: leave it out, or give the backbone one stiffness all along",
                ));
            }
        }
    }
    Ok(())
}
