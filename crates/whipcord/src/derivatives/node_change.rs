//! How a node moves, and what something is worth to it.

use whipcord_numerics::{Twist, Vec3};

/// How a node moves, base frame: with something that changes, or the other way round the
/// sensitivity of something to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct NodeChange {
    pub turn: Vec3,
    pub position: Vec3,
    /// Of moment and force just behind the node.
    pub moment: Vec3,
    pub force: Vec3,
}

impl NodeChange {
    /// `self += f · other`.
    pub fn add(&mut self, f: f64, other: &Self) {
        self.turn += f * other.turn;
        self.position += f * other.position;
        self.moment += f * other.moment;
        self.force += f * other.force;
    }

    /// The motion of the node.
    pub fn twist(&self) -> Twist {
        Twist { linear: self.position, angular: self.turn }
    }

    /// What a change is worth where the other is a sensitivity.
    pub fn dot(&self, other: &Self) -> f64 {
        self.turn.dot(other.turn)
            + self.position.dot(other.position)
            + self.moment.dot(other.moment)
            + self.force.dot(other.force)
    }
}
