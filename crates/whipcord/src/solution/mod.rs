//! The answer: frames, what became of the cables, what the robot touches, and how all this was obtained.
//!
//! | module | content |
//! |---|---|
//! | `diagnostics` | how an answer was obtained, and whether it is stable |
//! | `contact` | where the robot and movable objects touch |
//! | `internal` | what acts inside the rod, where a later solve starts |

mod contact;
mod diagnostics;
mod internal;

pub use contact::{Contact, ObjectContact, ObjectState, Part};
pub(crate) use diagnostics::Verdict;
pub use diagnostics::{Diagnostics, NoStability};
pub use internal::InternalState;
pub(crate) use internal::NodeState;

use crate::kind::ModelKind;
use crate::obstacle::Obstacle;
use crate::shape::{Shape, Wrench};

/// What became of one cable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CableState {
    /// Name of the cable.
    pub name: String,
    /// Tension in N, below the base where it varies; `None` from a model that knows no forces.
    pub tension: Option<f64>,
    /// Length of the path inside the robot in m. A slack cable is longer than this.
    pub length: f64,
    /// Length of that path before actuation in m.
    pub initial_length: f64,
    /// Whether the cable hangs loose.
    pub slack: bool,
    /// Tension in N in each span between two disks, from the base to where the cable ends; empty
    /// where friction does not make it vary.
    pub span_tensions: Vec<f64>,
    /// How the cable stands in the hole of each disk, from the base on, without the last one, where
    /// it is fastened; empty as [`Self::span_tensions`] is.
    pub slip_states: Vec<SlipState>,
}

/// State of a cable at a hole with friction after a step of actuation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SlipState {
    /// It did not move.
    #[default]
    Sticks,
    /// It slid towards the base: the tension beyond the hole is the lesser one.
    Pulled,
    /// It slid towards the tip: the tension beyond the hole is the greater one.
    Released,
}

/// A converged answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The model it comes from.
    pub model: ModelKind,
    /// Frames at the stations that were asked for.
    pub shape: Shape,
    /// Frames at the disks.
    pub disks: Shape,
    /// One for each cable.
    pub cables: Vec<CableState>,
    /// What rod and cables together exert on the base, in the frame of the base wherever that is
    /// ([`crate::Case::base`]), without the loads applied to the base itself; `None` from a model that knows no forces.
    pub base_wrench: Option<Wrench>,
    /// Plastic curvature in 1/m about x and y of the sections at the stations of [`Self::shape`]: what friction against bending holds
    /// ([`crate::robot::BendingFriction`]), and where the next step of actuation starts. Empty without such friction.
    pub plastic_curvature: Vec<[f64; 2]>,
    /// Where it touches the obstacles of its case.
    pub contacts: Vec<Contact>,
    /// The movable objects among these obstacles, in their order.
    pub objects: Vec<ObjectState>,
    /// What acts inside the rod: where a later solve starts from that is given this answer.
    pub internal: InternalState,
    /// How it was obtained.
    pub diagnostics: Diagnostics,
}

impl SlipState {
    /// The name in outputs: `sticks`, `pulled` or `released`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sticks => "sticks",
            Self::Pulled => "pulled",
            Self::Released => "released",
        }
    }
}

impl Solution {
    /// The obstacles of its case, the movable objects where they are in equilibrium.
    #[must_use]
    pub fn placed(&self, obstacles: &[Obstacle]) -> Vec<Obstacle> {
        let mut placed = obstacles.to_vec();
        for state in &self.objects {
            if let Some(obstacle) = placed.get_mut(state.obstacle) {
                obstacle.pose = state.pose;
            }
        }
        placed
    }

    /// An empty one, for [`crate::Prepared::solve_into`] to write to.
    #[must_use]
    pub fn empty(model: ModelKind) -> Self {
        Self {
            model,
            shape: Shape::default(),
            disks: Shape::default(),
            cables: Vec::new(),
            base_wrench: None,
            plastic_curvature: Vec::new(),
            contacts: Vec::new(),
            objects: Vec::new(),
            internal: InternalState::default(),
            diagnostics: Diagnostics::default(),
        }
    }
}

impl CableState {
    /// Writes the name of a cable, in the memory of the last one.
    pub(crate) fn rename(&mut self, name: &str) {
        if self.name != name {
            name.clone_into(&mut self.name);
        }
    }
}
