//! What a continuous cable exerts on a section.

use whipcord_numerics::{Mat3, Twist, Vec3};

use crate::block::{Block, skew_times, times_skew};
use crate::rod::Crossing;
use crate::scheme::Scheme;

/// How a cable pulls at a section.
pub(crate) struct Pull {
    /// `t`.
    direction: Vec3,
    /// `∂t/∂p′`.
    change: Mat3,
    /// `∂t/∂a` with the tangent `a` at the start of the step, where the scheme conserves.
    by_start: Option<Mat3>,
}

impl Pull {
    #[inline]
    pub fn new(crossing: &Crossing, strain: &Twist, start: &Twist, scheme: &Scheme) -> Self {
        if !scheme.conserves {
            let tangent = crossing.tangent(strain);
            let inverse = 1.0 / tangent.norm();
            let direction = tangent * inverse;
            let change = (Mat3::IDENTITY - Mat3::outer(direction, direction)) * inverse;
            return Self { direction, change, by_start: None };
        }
        // (a + b)/(|a| + |b|) of the tangents at start and end, eq. (16).
        let before = crossing.tangent(start);
        let end = scheme.end(*start, *strain);
        let after = crossing.tangent(&end);
        let (from, to) = (before.norm(), after.norm());
        let inverse = 1.0 / (from + to);
        let direction = (before + after) * inverse;
        let change = (Mat3::IDENTITY - Mat3::outer(direction, after * (1.0 / to)))
            * (inverse / scheme.place);
        let of = |tangent: Vec3, norm: f64| {
            (Mat3::IDENTITY - Mat3::outer(direction, tangent * (1.0 / norm))) * inverse
        };
        // The end lies beyond the stage, away from the start.
        let by_start = of(before, from) + of(after, to) * (1.0 - 1.0 / scheme.place);
        Self { direction, change, by_start: Some(by_start) }
    }

    /// `(t, r × t)`.
    #[inline]
    pub fn wrench(&self, crossing: &Crossing) -> Twist {
        Twist { linear: self.direction, angular: crossing.offset.cross(self.direction) }
    }

    /// What a change of the strain at the start of the step changes the pull by.
    pub fn start_change(&self, crossing: &Crossing, start: &Twist) -> Twist {
        let Some(by_start) = &self.by_start else { return Twist::default() };
        let tangent = start.linear + start.angular.cross(crossing.offset);
        let direction = *by_start * tangent;
        Twist { linear: direction, angular: crossing.offset.cross(direction) }
    }

    /// Transpose of [`Self::start_change`].
    pub fn transposed_start_change(&self, crossing: &Crossing, on: &Twist) -> Twist {
        let Some(by_start) = &self.by_start else { return Twist::default() };
        // (t, r × t) · (a, b) = t · (a + b × r).
        let tangent = by_start.transpose_mul(on.linear + on.angular.cross(crossing.offset));
        Twist { linear: tangent, angular: crossing.offset.cross(tangent) }
    }

    /// Adds `τ JᵀPJ` with `J = [I, −r̂]`.
    #[inline]
    pub fn add_stiffness(&self, crossing: &Crossing, tension: f64, stiffness: &mut Block) {
        let p = self.change * tension;
        let r = crossing.offset;
        let right = times_skew(&p, r);
        stiffness.a += p;
        stiffness.b += -right;
        stiffness.c += skew_times(r, &p);
        stiffness.d += -skew_times(r, &right);
    }
}
