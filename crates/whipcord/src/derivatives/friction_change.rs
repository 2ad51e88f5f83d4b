//! How friction against bending of a section changes with a parameter, and with the history.
//!
//! With `e = u − u* − κ` (see `docs/theory/bending-friction.md`), where friction sticks and where it slides in the direction `σ`:
//!
//! ```text
//! δh = k_y (δu − δu* − δκ) + δk_y e         δκ⁺ = δκ                                       sticks
//! δh = σ δM_y                               δκ⁺ = δu − δu* − σ (δM_y − M_y δk_y/k_y)/k_y     slides     (5)
//! ```

use whipcord_numerics::Vec3;

use crate::parameter::Parameter;
use crate::robot::{BendingFriction, Robot};
use crate::section::{BENDING_AXES, Section};

/// Changes of the numbers of a section's friction against bending.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FrictionChange {
    /// Of `M_y` and `k_y`.
    limit: [f64; BENDING_AXES],
    stiffness: [f64; BENDING_AXES],
    /// Of `κ`.
    plastic: [f64; BENDING_AXES],
    /// Of `u*`.
    rest: Vec3,
}

impl FrictionChange {
    /// By a parameter that changes the elastic bending stiffness and the rest curvature of the section like this, and the plastic
    /// curvature that the steps before left.
    pub fn new(
        robot: &Robot,
        parameter: &Parameter,
        bending: Vec3,
        rest: Vec3,
        plastic: [f64; BENDING_AXES],
    ) -> Self {
        let mut change = Self { plastic, rest, ..Self::default() };
        let given = robot.backbone().bending_friction.and_then(|given| given.yield_stiffness);
        for axis in 0..BENDING_AXES {
            let chosen = |of: Option<usize>| of.is_none_or(|of| of == axis);
            match *parameter {
                Parameter::YieldMoment { axis: of } if chosen(of) => change.limit[axis] = 1.0,
                Parameter::YieldStiffness { axis: of } if chosen(of) => {
                    change.stiffness[axis] = 1.0;
                }
                _ => {}
            }
            if given.is_none() {
                change.stiffness[axis] += BendingFriction::STIFFNESS_RATIO * bending[axis];
            }
        }
        change
    }

    /// The explicit change of the moment of friction at a curvature: `δh` of eq. (5) without `δu`.
    pub fn moment(&self, section: &Section, curvature: Vec3) -> Vec3 {
        let mut moment = Vec3::ZERO;
        let Some(friction) = section.friction() else { return moment };
        let bend = curvature - section.rest_curvature;
        for axis in 0..BENDING_AXES {
            moment[axis] = match friction.sliding(axis, bend) {
                Some(sign) => sign * self.limit[axis],
                None => {
                    self.stiffness[axis] * (bend[axis] - friction.plastic[axis])
                        - friction.stiffness[axis] * (self.plastic[axis] + self.rest[axis])
                }
            };
        }
        moment
    }

    /// `δκ⁺` of eq. (5) for a change of the curvature.
    pub fn left(&self, section: &Section, curvature: Vec3, change: Vec3) -> [f64; BENDING_AXES] {
        let Some(friction) = section.friction() else { return [0.0; BENDING_AXES] };
        let bend = curvature - section.rest_curvature;
        core::array::from_fn(|axis| match friction.sliding(axis, bend) {
            None => self.plastic[axis],
            Some(sign) => {
                let (limit, stiffness) = (friction.limit[axis], friction.stiffness[axis]);
                let of_limit = self.limit[axis] - limit * self.stiffness[axis] / stiffness;
                change[axis] - self.rest[axis] - sign * of_limit / stiffness
            }
        })
    }
}
