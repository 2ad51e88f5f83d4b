//! What a rod is shot at.

use whipcord_numerics::Vec3;

use crate::statics::grid::SHOOTING_NODES;

/// What is aimed at the tip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target<'a> {
    /// Tensions in N, in the order of the grid: of all cables, or of all cables at each shooting node in turn.
    pub tensions: &'a [f64],
    /// How many of them belong to a node: none where they are the same at all nodes.
    pub per_node: usize,
    /// Moment at the base in N·m.
    pub base_moment: Vec3,
    /// Force at the base that follower forces exert, in N.
    pub follower_force: Vec3,
    /// Factor on all loads.
    pub load: f64,
    /// Whether the sections at start, middle and end of each step are sampled.
    pub sample: bool,
    /// The last Newton step of each section, as a strain.
    pub step_tolerance: f64,
}

impl Target<'_> {
    /// Tensions of the first `active` cables at shooting node `j` of step `k`.
    #[inline(always)]
    pub(super) fn tensions_at(&self, k: usize, j: usize, active: usize) -> &[f64] {
        &self.tensions[self.per_node * (k * SHOOTING_NODES.len() + j)..][..active]
    }
}
