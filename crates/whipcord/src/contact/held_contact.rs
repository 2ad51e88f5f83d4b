//! What a contact of an answer keeps at zero, and whether it is about to change.

use super::friction::Grip;
use super::pair::OVERLAP;

/// A contact that is so near to another state, as a part of what its force, gap, grip or slip can be, is about to change it.
pub(super) const ABOUT_TO_CHANGE: f64 = 1e-6;
/// On the way it is between two states where it is as near as this.
pub(super) const BETWEEN: f64 = 1e-8;

/// A force along a line that holds, or a way along the backbone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unknown {
    pub contact: usize,
    /// What it adds to the push.
    pub push: [f64; 6],
    /// How what it keeps at zero changes with the motion of the cross-section.
    pub rate: [f64; 6],
    /// How that changes with the unknown itself.
    pub own: f64,
    /// How that changes with another unknown, by its number.
    pub by_other: Option<(usize, f64)>,
    /// How what it keeps at zero changes with the motion of the cross-section at the last equilibrium.
    pub rate_before: [f64; 6],
}

impl Unknown {
    /// One of which nothing else is known.
    pub const fn new(contact: usize, push: [f64; 6], rate: [f64; 6]) -> Self {
        Self { contact, push, rate, own: 0.0, by_other: None, rate_before: [0.0; 6] }
    }
}

/// Whether a contact with this gap, force and grip is so near to touching or to opening, to sticking or to sliding.
pub(super) fn is_near_change(
    (gap, force, grip): (f64, f64, Option<Grip>),
    near: f64,
    force_scale: f64,
    length: f64,
) -> bool {
    if force <= 0.0 {
        return gap <= near * length;
    }
    let of_grip = grip.is_some_and(|grip| {
        if grip.sticks {
            grip.is_at_bound(force, near)
        } else {
            grip.slip.norm() <= OVERLAP.min(near) * length
        }
    });
    of_grip || force <= near * force_scale
}
