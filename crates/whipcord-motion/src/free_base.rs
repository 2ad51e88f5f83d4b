//! The pose of a base that nothing holds.

use whipcord_numerics::{Pose, Twist};

use crate::block::Block;
use crate::pose;
use crate::state::State;

/// The pose of a free base at a stage: `start exp(θ)` with `θ = history + g dexp⁻¹(V)`, eq. (29).
#[derive(Clone, Copy, Debug)]
pub(crate) struct FreeBase {
    /// Pose at the start of the step.
    pub start: Pose,
    pub history: Twist,
    pub g: f64,
}

impl FreeBase {
    /// From a state, `h` further, by the velocity at the end with this weight and that at the start with the rest.
    pub fn weighted(from: &State, h: f64, weight: f64) -> Self {
        let g = weight * h;
        Self { start: from.base, history: from.velocities[0] * (h - g), g }
    }

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

/// How the exponent of a free base, and by it the pose, change: the pose by displacements along and about its own axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BaseTangent {
    /// `θ`.
    pub exponent: Twist,
    pub exponent_by_history: Block,
    pub exponent_by_velocity: Block,
    pub pose_by_exponent: Block,
    pub pose_by_start: Block,
}

impl BaseTangent {
    /// At a velocity; `None` where the step turns the base so far that the exponent is not defined.
    pub fn new(base: &FreeBase, velocity: Twist) -> Option<Self> {
        let exponent = base.exponent(velocity);
        let of = |by_exponent: Twist, by_velocity: Twist| {
            exponent_rate_change((exponent, by_exponent), (velocity, by_velocity)) * base.g
        };
        let left = Block::of(|change| change - of(change, Twist::default()));
        let exponent_by_history = left.inverse()?;
        let moved = Pose::exp(exponent);
        let back = moved.rotation.conjugate();
        let by_velocity = Block::of(|change| of(Twist::default(), change));
        Some(Self {
            exponent,
            exponent_by_history,
            exponent_by_velocity: exponent_by_history.times(&by_velocity),
            pose_by_exponent: Block::of(|change| pose::exponential_change(&exponent, &change)),
            pose_by_start: Block::of(|change| {
                let arm = change.linear + change.angular.cross(moved.position);
                Twist { linear: back.rotate(arm), angular: back.rotate(change.angular) }
            }),
        })
    }

    /// The pose by the velocity.
    pub fn pose_by_velocity(&self) -> Block {
        self.pose_by_exponent.times(&self.exponent_by_velocity)
    }

    /// The pose by the history.
    pub fn pose_by_history(&self) -> Block {
        self.pose_by_exponent.times(&self.exponent_by_history)
    }
}

/// The change of [`exponent_rate`] for changes of exponent and velocity.
fn exponent_rate_change((exponent, d): (Twist, Twist), (velocity, dv): (Twist, Twist)) -> Twist {
    let bracket =
        |(x, dx): (Twist, Twist)| (exponent.bracket(x), d.bracket(x) + exponent.bracket(dx));
    let first = bracket((velocity, dv));
    let second = bracket(first);
    let fourth = bracket(bracket(second));
    dv + first.1 * 0.5 + second.1 * (1.0 / 12.0) - fourth.1 * (1.0 / 720.0)
}

/// The rate of θ for which `exp(θ)` has the velocity V in its own frame: `dexp⁻¹(−θ) V`, by its series up to the fourth order.
pub(crate) fn exponent_rate(exponent: Twist, velocity: Twist) -> Twist {
    let first = exponent.bracket(velocity);
    let second = exponent.bracket(first);
    let fourth = exponent.bracket(exponent.bracket(second));
    velocity + first * 0.5 + second * (1.0 / 12.0) - fourth * (1.0 / 720.0)
}
