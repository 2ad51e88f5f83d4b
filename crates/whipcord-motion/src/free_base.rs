//! The pose of a base that nothing holds.

use whipcord_numerics::{Pose, Twist};

/// The pose of a free base at a stage: `start exp(θ)` with `θ = history + g dexp⁻¹(V)`, eq. (29).
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeBase {
    /// Pose at the start of the step.
    pub start: Pose,
    pub history: Twist,
    pub g: f64,
}

impl FreeBase {
    /// `θ`.
    pub fn exponent(&self, velocity: Twist) -> Twist {
        /// The exponent of a step is far below 1: each time it is known to a tenth of the difference before.
        const TIMES: usize = 12;
        let mut exponent = self.history + velocity * self.g;
        for _ in 0..TIMES {
            exponent = self.history + exponent_rate(exponent, velocity) * self.g;
        }
        exponent
    }

    /// The pose.
    pub fn pose(&self, velocity: Twist) -> Pose {
        self.start * Pose::exp(self.exponent(velocity))
    }
}

/// The rate of θ for which `exp(θ)` has the velocity V in its own frame: `dexp⁻¹(−θ) V`, by its series up to the fourth order.
pub(crate) fn exponent_rate(exponent: Twist, velocity: Twist) -> Twist {
    let first = exponent.bracket(velocity);
    let second = exponent.bracket(first);
    let fourth = exponent.bracket(exponent.bracket(second));
    velocity + first * 0.5 + second * (1.0 / 12.0) - fourth * (1.0 / 720.0)
}
