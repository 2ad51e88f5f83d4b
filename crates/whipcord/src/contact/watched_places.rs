//! Where a rod is watched for obstacles.

use std::sync::OnceLock;

use whipcord_numerics::{Vec3, equally_spaced};

use crate::error::SolveError;
use crate::robot::Robot;

/// The backbone is watched at this many places from base to tip, and at the disks.
const WATCHED: usize = 80;

/// Where a rod is watched.
#[derive(Debug)]
pub(crate) struct WatchedPlaces {
    /// Arc lengths in m.
    pub places: Vec<f64>,
    /// The centres of its cross-sections at rest, kept when they are first asked for.
    at_rest: OnceLock<Vec<Vec3>>,
}

impl WatchedPlaces {
    /// Of a robot.
    pub fn of(robot: &Robot) -> Self {
        Self { places: watched(robot), at_rest: OnceLock::new() }
    }

    /// The centres at rest; `look` finds them the first time.
    pub fn at_rest(
        &self,
        centres: &mut Vec<Vec3>,
        look: impl FnOnce(&mut Vec<Vec3>) -> Result<(), SolveError>,
    ) -> Result<(), SolveError> {
        if let Some(known) = self.at_rest.get() {
            centres.clone_from(known);
            return Ok(());
        }
        look(centres)?;
        self.at_rest.get_or_init(|| centres.clone());
        Ok(())
    }
}

/// The arc lengths at which the backbone is watched: those of the disks and some between.
fn watched(robot: &Robot) -> Vec<f64> {
    let length = robot.backbone().length;
    let mut places = robot.disks().arc_lengths.clone();
    places.extend(equally_spaced(0.0, length, WATCHED + 1));
    places.sort_by(f64::total_cmp);
    // The first and the last stay.
    let last = places.last().copied();
    let apart = 1e-3 * length / WATCHED as f64;
    places.dedup_by(|next, before| *next - *before <= apart);
    if let (Some(end), Some(last)) = (places.last_mut(), last) {
        *end = last;
    }
    places
}
