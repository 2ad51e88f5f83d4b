//! Where a model has the markers that were seen of a robot.

use whipcord_numerics::Vec3;

use super::{Observation, Place};
use crate::case::{Case, Drive};
use crate::error::SolveError;
use crate::model::{Model, ModelKind, Stations};
use crate::robot::Robot;
use crate::shape::Solution;

/// The places in m, in the world, at which an answer of the model, at the disks, has the markers. For those
/// between disks it is solved for once more, from the answer. The markers are on the robot.
///
/// # Errors
/// [`SolveError`] where it is not found between the disks.
pub fn places<'a>(
    kind: ModelKind,
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
        let model = Model::new(kind, Stations::At(stations), Drive::Natural);
        there = model.prepare(robot, &case.loads)?.solve(case, Some(solution))?.shape.poses;
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
