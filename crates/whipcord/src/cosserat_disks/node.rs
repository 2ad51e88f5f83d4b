//! The disks of the chain, and changes of them.

use whipcord_numerics::{UnitQuaternion, Vec3};

use crate::derivatives::NodeChange;
use crate::section::BodyWrench;
use crate::statics::elimination::Change;
use crate::statics::path;
use crate::statics::path::state::{Part, PartChange};
use crate::statics::scales::Scales;

/// A disk of the chain.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub rotation: UnitQuaternion,
    /// Total moment beyond the disk, in its frame.
    pub moment: Vec3,
    /// Force of the followers beyond it, base frame.
    pub force: Vec3,
    /// Wrench in the rod beyond it, in its frame.
    pub wrench: BodyWrench,
}

/// Change of a disk.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NodeStep {
    pub change: Change,
    /// Of the wrench in the rod beyond it, in its frame.
    pub wrench: BodyWrench,
}

/// The disks, the tensions of the groups and the load.
pub(super) type State = path::state::State<Node>;

/// Change of the chain.
pub(super) type Direction = path::state::Direction<NodeStep>;

impl PartChange for NodeStep {
    fn plus(self, f: f64, other: Self) -> Self {
        let wrench = self.wrench + other.wrench * f;
        Self { change: self.change.plus(f, other.change), wrench }
    }

    /// The wrench in the rod follows from the rest.
    fn product(&self, other: &Self, scales: &Scales) -> f64 {
        self.change.product(&other.change, scales)
    }
}

impl Part for Node {
    type Change = NodeStep;

    fn stepped(&self, fraction: f64, step: &NodeStep) -> Self {
        let Change { turn, moment, force } = step.change;
        Self {
            rotation: (self.rotation * UnitQuaternion::exp(fraction * turn)).renormalized(),
            moment: self.moment + fraction * moment,
            force: self.force + fraction * force,
            wrench: self.wrench + step.wrench * fraction,
        }
    }
}

impl Node {
    /// The disk a part of the way along a change of it, and of what acts in the rod behind it, both in the base frame.
    /// Dead forces are known beforehand: without followers there is no other.
    pub fn moved(
        &self,
        part: f64,
        disk: &NodeChange,
        rod: &NodeChange,
        has_followers: bool,
    ) -> Self {
        let to_body = |x: Vec3| self.rotation.conjugate().rotate(x);
        // Of a vector that is given in the frame of the disk.
        let turned = |own: Vec3, change: Vec3| {
            to_body(change - disk.turn.cross(self.rotation.rotate(own))) * part
        };
        let BodyWrench { linear, angular } = self.wrench;
        Self {
            rotation: (UnitQuaternion::exp(disk.turn * part) * self.rotation).renormalized(),
            moment: self.moment + turned(self.moment, disk.moment),
            force: if has_followers { self.force + disk.force * part } else { self.force },
            wrench: BodyWrench {
                linear: linear + turned(linear, rod.force),
                angular: angular + turned(angular, rod.moment),
            },
        }
    }
}
