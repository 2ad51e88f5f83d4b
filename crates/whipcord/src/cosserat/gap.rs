//! How the steps of multiple shooting end short of the next node.

use whipcord_numerics::{Pose, Vec3};

use super::state::Node;
use crate::shape::Wrench;
use crate::statics::elimination::Change;
use crate::statics::loads::AppliedLoads;
use crate::statics::scales::Scales;

/// How a step ends short of the next node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gap {
    /// From the node to the end, across the loads there.
    pub change: Change,
    /// Frame at the end, with the position relative to the start.
    pub end: Pose,
}

impl Gap {
    /// Of step `k`, which ends with this frame and this cut in the base frame before the next node. The loads act with this factor.
    pub fn of(
        (loads, load): (&AppliedLoads, f64),
        k: usize,
        end: Pose,
        cut: Wrench,
        next: &Node,
    ) -> Self {
        let turn = (next.rotation.conjugate() * end.rotation).log();
        let moment = cut.moment - load * loads.moment(k + 1);
        let moment = end.rotation.conjugate().rotate(moment);
        let moment = moment - load * loads.follower(k + 1).moment - next.moment;
        let force = Self::force((loads, load), k, &end, cut.force, next);
        Self { change: Change { turn, moment, force }, end }
    }

    /// Of the followers' force alone, which is this one before the end.
    #[inline(always)]
    pub fn force(
        (loads, load): (&AppliedLoads, f64),
        k: usize,
        end: &Pose,
        before: Vec3,
        next: &Node,
    ) -> Vec3 {
        let follower = loads.follower(k + 1).force;
        match follower == Vec3::ZERO {
            true => before - next.force,
            false => before - load * end.rotation.rotate(follower) - next.force,
        }
    }

    /// Its size, without dimension; infinite where it is not a number, which must not pass for a closed gap.
    pub fn size(&self, next: &Node, scales: &Scales) -> f64 {
        let Change { turn, moment, .. } = self.change;
        if !(turn.is_finite() && moment.is_finite()) {
            return f64::INFINITY;
        }
        let moment = moment.norm() / (scales.moment + next.moment.norm());
        turn.norm().max(moment).max(self.size_of_force(next, scales))
    }

    /// The size of what is missing of the followers' force, likewise.
    #[inline(always)]
    pub fn size_of_force(&self, next: &Node, scales: &Scales) -> f64 {
        let force = self.change.force;
        if force == Vec3::ZERO {
            return 0.0;
        }
        let size = force.norm() / (scales.force + next.force.norm());
        if size.is_finite() { size } else { f64::INFINITY }
    }
}
