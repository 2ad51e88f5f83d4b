//! The cases of the law of friction at a hole, and what has to hold in each.

use crate::solution::SlipState;

/// Which of the cases of eq. (2) holds at a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// The cable is slack at the base, which would have to push.
    Slack,
    /// `D₀` is given.
    Held,
    /// The cable slides, or rests, without friction.
    Free,
    Sticks,
    Pulled,
    Released,
}

impl Mode {
    pub const fn slip_state(self, slip: f64) -> SlipState {
        match self {
            Self::Sticks => SlipState::Sticks,
            Self::Pulled => SlipState::Pulled,
            Self::Released => SlipState::Released,
            Self::Slack | Self::Held | Self::Free => SlipState::after(slip, 0.0),
        }
    }
}

/// What has to hold in the mode of a hole: `value ≥ 0`, in m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Condition {
    pub value: f64,
    /// What rounding makes of it.
    pub rounding: f64,
    /// The mode where it does not hold.
    pub next: Mode,
}
