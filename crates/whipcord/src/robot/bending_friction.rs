use super::error::RobotError;
use super::limits::{BENDING_STIFFNESS, YIELD_MOMENT};

/// Friction against bending inside the backbone, about x and y of its sections: between strands, sheaths, or the parts of a
/// jointed backbone. A spring in series with a friction limit acts beside the elastic bending stiffness.
///
/// ```
/// use whipcord::robot::BendingFriction;
/// use whipcord::{Backbone, Section};
///
/// let friction = BendingFriction { yield_moment: [0.01, 0.01], yield_stiffness: None };
/// let rod = Backbone {
///     section: Some(Section::circle(0.003)),
///     bending_friction: Some(friction),
///     ..Backbone::new(0.18)
/// };
/// # let _ = rod;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingFriction {
    /// Greatest moment of the friction in N·m; 0 on an axis without friction.
    pub yield_moment: [f64; 2],
    /// Bending stiffness in N·m² that the friction adds until it slides; where it is not given
    /// [`Self::STIFFNESS_RATIO`] times the elastic one.
    pub yield_stiffness: Option<[f64; 2]>,
}

impl BendingFriction {
    /// How many times the elastic bending stiffness [`Self::yield_stiffness`] is where it is not given.
    pub const STIFFNESS_RATIO: f64 = 10.0;

    pub(super) fn check(&self) -> Result<(), RobotError> {
        for axis in 0..2 {
            let of = |name: &str| format!("backbone.{name}[{axis}]");
            YIELD_MOMENT.check(&of("yield_moment"), self.yield_moment[axis])?;
            if let Some(stiffness) = self.yield_stiffness {
                BENDING_STIFFNESS.check(&of("yield_stiffness"), stiffness[axis])?;
            }
        }
        Ok(())
    }
}
