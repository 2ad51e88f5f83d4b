//! Where a model has the markers that were seen of a robot.

use whipcord_numerics::Vec3;

use super::seen::{Observation, Place};
use whipcord::case::{Actuation, Case};
use whipcord::error::SolveError;
use whipcord::kind::ModelKind;
use whipcord::model::Model;
use whipcord::robot::Robot;
use whipcord::shape::Shape;
use whipcord::solution::Solution;
use whipcord::stations::Stations;

/// The places in m, in the world, at which an answer of the model, at the disks, has the markers. For those
/// between disks it is solved for once more, from the answer. The markers are on the robot.
///
/// # Errors
/// [`SolveError`] where it is not found between the disks.
pub fn places<'a>(
    model: &Model,
    robot: &Robot,
    case: &Case,
    solution: &Solution,
    markers: impl IntoIterator<Item = &'a Observation>,
) -> Result<Vec<Vec3>, SolveError> {
    let markers: Vec<&Observation> = markers.into_iter().collect();
    let between = |marker: &&Observation| match marker.place {
        Place::ArcLength(s) => Some(s),
        Place::Disk(_) => None,
    };
    let stations: Vec<f64> = markers.iter().filter_map(between).collect();
    let mut there = Vec::new();
    if !stations.is_empty() {
        there = model
            .at(Stations::At(stations))
            .prepare(robot, &case.loads)?
            .solve(case, Some(solution))?
            .shape
            .poses;
    }
    let mut there = there.into_iter();
    let place = |marker: &&Observation| {
        let pose = match marker.place {
            Place::Disk(disk) => solution.disks.poses.get(disk).copied(),
            Place::ArcLength(_) => there.next(),
        };
        pose.map(|pose| pose.transform(marker.offset))
    };
    Ok(markers.iter().filter_map(place).collect())
}

/// As [`places`], of markers that were seen in any of the steps of a case, from the answers to all its steps.
///
/// # Errors
/// [`SolveError`] where an answer is not found between the disks.
pub(super) fn places_in_steps(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    answers: &[&Solution],
    markers: &[&Observation],
) -> Result<Vec<Vec3>, SolveError> {
    let between = |marker: &Observation| match marker.place {
        Place::ArcLength(s) => Some(s),
        Place::Disk(_) => None,
    };
    let mut stations: Vec<f64> = markers.iter().filter_map(|marker| between(marker)).collect();
    stations.sort_by(f64::total_cmp);
    stations.dedup();
    let mut needed = vec![false; answers.len()];
    for marker in markers.iter().filter(|marker| between(marker).is_some()) {
        if let Some(needed) = needed.get_mut(marker.step) {
            *needed = true;
        }
    }
    let shapes = if stations.is_empty() {
        vec![None; answers.len()]
    } else {
        shapes_at(kind, robot, case, answers, &stations, &needed)?
    };
    let place = |marker: &&Observation| {
        let pose = match marker.place {
            Place::Disk(disk) => answers.get(marker.step)?.disks.poses.get(disk),
            Place::ArcLength(s) => {
                let station = stations.partition_point(|station| *station < s);
                shapes.get(marker.step)?.as_ref()?.poses.get(station)
            }
        };
        pose.map(|pose| pose.transform(marker.offset))
    };
    Ok(markers.iter().filter_map(place).collect())
}

/// The shapes at these stations of the answers that are needed.
fn shapes_at(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    answers: &[&Solution],
    stations: &[f64],
    needed: &[bool],
) -> Result<Vec<Option<Shape>>, SolveError> {
    let model = Model::new(kind, Stations::At(stations.to_vec()), Actuation::Natural);
    let mut prepared = model.prepare(robot, &case.loads)?;
    let mut shapes = Vec::with_capacity(answers.len());
    if robot.has_history() && answers.len() > 1 {
        // With friction, an answer depends on all steps before it.
        prepared
            .solve_steps(case, |solution| shapes.push(Some(solution.shape)))
            .map_err(|(_, error)| error)?;
        return Ok(shapes);
    }
    for ((step, answer), needed) in case.single_steps().zip(answers).zip(needed) {
        let followed = needed.then(|| prepared.solve(&step, Some(answer))).transpose()?;
        shapes.push(followed.map(|solution| solution.shape));
    }
    Ok(shapes)
}
