//! How a target is to be reached, and what became of it.

use crate::target::Tolerance;

/// How a target is to be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReachOptions {
    /// How far the answer may be from the target; `None` is [`Tolerance::of_length`].
    pub tolerance: Option<Tolerance>,
    /// Which of the commands that reach the target are preferred where there are several.
    pub prefer: Preference,
    /// From how many shapes of the atlas the iteration may start, after the commands of the case; from six at most for a robot that remembers the steps before.
    pub starts: usize,
    /// Solves of the model that may be spent.
    pub solves: usize,
    /// Least distance of the robot from obstacles in m; `None` lets it touch them.
    pub clearance: Option<f64>,
    /// Boxes of tensions that may be looked at to prove that a target that was not reached cannot be; `None` proves nothing.
    pub proof: Option<usize>,
    /// Whether an unstable equilibrium is an answer.
    pub allows_unstable: bool,
    /// Whether answers have [`crate::Reached::null_space`].
    pub null_space: bool,
}

/// Which of several commands are preferred.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preference {
    /// Those with the least sum of the squares of the tensions; of a model that knows no tensions, of the shortenings.
    #[default]
    LeastTension,
    /// Those nearest to the commands of the case, or of the point before on a path.
    LeastChange,
    /// Those with the greatest distance from obstacles.
    MostClearance,
    /// Those that were found first.
    First,
}

impl Default for ReachOptions {
    fn default() -> Self {
        Self {
            tolerance: None,
            prefer: Preference::default(),
            starts: 32,
            solves: 4000,
            clearance: Some(0.0),
            proof: None,
            allows_unstable: false,
            null_space: true,
        }
    }
}

/// What became of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReachStatus {
    /// The robot is there, within the tolerance and all limits, in a stable equilibrium that a solve from rest finds.
    Reached,
    /// It is not reached from any start. The answer is the nearest that was found, a minimum of the distance; that there is none
    /// nearer is not proven.
    Nearest,
    /// A bound of the distance proves that no command within the limits reaches it.
    UnreachableProven,
    /// Neither reached nor a minimum of the distance found within the solves that may be spent, or a proof that was asked for was not found.
    Undecided,
}

impl ReachStatus {
    /// As in JSON.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::Nearest => "nearest",
            Self::UnreachableProven => "unreachable_proven",
            Self::Undecided => "undecided",
        }
    }
}
