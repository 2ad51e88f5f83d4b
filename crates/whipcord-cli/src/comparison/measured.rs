//! A model against what was measured in space.

use whipcord::registration::{RegistrationError, register_by_least_turn};
use whipcord::{Case, ModelKind, Observation, Place, Pose, Robot, Seen, Solution, Vec3};
use whipcord_io::{Alignment, Measured};

use crate::markers::places;
use crate::quantity::{degrees, millimetres};
use crate::statistics::mean;

/// An answer beside what was measured after the last step.
#[derive(Clone, Debug)]
pub struct Against {
    /// The markers.
    pub markers: Vec<Compared>,
    /// How the measurement was moved onto the answer, where that was asked for.
    pub motion: Option<Pose>,
}

/// A marker that was measured.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// Number of the disk, from 1, whose centre it is.
    pub disk: Option<usize>,
    /// Where it was measured, in m, after the measurement was moved.
    pub measured: Vec3,
    /// Where the model has it.
    pub model: Vec3,
    /// Whether it does not move with the robot.
    pub at_base: bool,
}

impl Against {
    /// RMS distance in m over the markers that are not at the base; `None` where there are none.
    pub fn rms(&self) -> Option<f64> {
        let moving = self.markers.iter().filter(|marker| !marker.at_base);
        let squares: Vec<f64> =
            moving.map(|marker| (marker.model - marker.measured).norm_squared()).collect();
        (!squares.is_empty()).then(|| mean(&squares).sqrt())
    }

    /// Where a disk was, by its number from 1.
    pub fn disk(&self, number: usize) -> Option<Vec3> {
        Some(self.markers.iter().find(|marker| marker.disk == Some(number))?.measured)
    }

    /// How the measurement was moved, in words.
    pub fn moved(&self) -> Option<String> {
        let Pose { position, rotation } = self.motion?;
        let (shift, turn) = (millimetres(position.norm()), degrees(rotation.log().norm()));
        Some(format!("measurement moved by {shift} and turned by {turn} onto it"))
    }
}

/// Compares an answer at the disks with what was measured in space after the last step; `None` where nothing
/// was.
///
/// # Errors
/// Why it cannot be compared, in words.
pub fn against(
    kind: ModelKind,
    robot: &Robot,
    case: &Case,
    solution: &Solution,
    measured: &Measured,
) -> Option<Result<Against, String>> {
    let last = case.before.len();
    let positions: Vec<(&Observation, Vec3)> = measured
        .observations
        .iter()
        .filter(|observation| observation.step == last)
        .filter_map(|observation| match observation.seen {
            Seen::Position(position) => Some((observation, position)),
            Seen::Pixel { .. } => None,
        })
        .collect();
    if positions.is_empty() {
        return None;
    }
    let observations: Vec<&Observation> = positions.iter().map(|(seen, _)| *seen).collect();
    let model = match places(kind, robot, case, solution, &observations) {
        Ok(places) => places,
        Err(error) => return Some(Err(format!("between the disks: {error}"))),
    };
    let mut markers: Vec<Compared> = positions
        .into_iter()
        .zip(model)
        .map(|((seen, measured), model)| Compared {
            disk: match seen.place {
                Place::Disk(disk) if seen.offset == Vec3::ZERO => Some(disk + 1),
                _ => None,
            },
            measured,
            model,
            at_base: seen.place.arc_length(robot.disks()) == 0.0,
        })
        .collect();
    let motion = match motion(&markers, measured.alignment) {
        Ok(motion) => motion,
        Err(error) => return Some(Err(format!("the measurement cannot be moved: {error}"))),
    };
    for marker in &mut markers {
        marker.measured = motion.map_or(marker.measured, |pose| pose.transform(marker.measured));
    }
    Some(Ok(Against { markers, motion }))
}

/// How the measurement is brought to the model.
fn motion(markers: &[Compared], alignment: Alignment) -> Result<Option<Pose>, RegistrationError> {
    let pairs: Vec<[Vec3; 2]> = markers
        .iter()
        .filter(|marker| alignment == Alignment::Rigid || marker.at_base)
        .map(|marker| [marker.measured, marker.model])
        .collect();
    match (alignment, pairs.as_slice()) {
        (Alignment::None, _) => Ok(None),
        // One point on the base says where it is, and nothing of how it is turned.
        (Alignment::Base, [[measured, model]]) => {
            Ok(Some(Pose { position: *model - *measured, ..Pose::IDENTITY }))
        }
        (Alignment::Base | Alignment::Rigid, pairs) => {
            Ok(Some(register_by_least_turn(pairs)?.motion))
        }
    }
}
