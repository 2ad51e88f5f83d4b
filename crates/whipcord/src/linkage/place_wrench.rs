//! A dead wrench on a cross-section, as the coordinates of its section see it.

use super::motion::{Coordinates, Motion};
use crate::shape::Wrench;

/// A dead wrench on a cross-section of a section, in the frame of the disk at the section's start.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaceWrench {
    pub section: usize,
    /// Its work by the coordinates of the section.
    pub work: Coordinates,
    /// The wrench about the disk at the section's start.
    pub about_start: Wrench,
}

impl PlaceWrench {
    /// A wrench on the cross-section that moves like this.
    pub fn new(section: usize, motion: &Motion, Wrench { force, moment }: Wrench) -> Self {
        let work = |a: usize| moment.dot(motion.turn[a]) + force.dot(motion.shift[a]);
        let about_start = Wrench { force, moment: moment + motion.end.cross(force) };
        Self { section, work: core::array::from_fn(work), about_start }
    }
}
