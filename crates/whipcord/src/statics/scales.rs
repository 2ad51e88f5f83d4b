//! Scales that make residuals without dimension.

use super::grid::Grid;

/// Scales of moment, force and length of a rod.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scales {
    /// `K_bt/L` in N·m.
    pub moment: f64,
    /// `K_bt/L²` in N.
    pub force: f64,
    /// `L` in m.
    pub length: f64,
}

impl Scales {
    /// Of a rod of this length on this grid, by its least stiffness at the base.
    pub fn of(grid: &Grid, length: f64) -> Self {
        let (node, _) = grid.shooting.at(0, 0, 0);
        let bending = node.section.stiffness.bending;
        let moment = bending.x.min(bending.y).min(bending.z) / length;
        Self { moment, force: moment / length, length }
    }

    /// Units of a cable's tension and of its slackness, in N and m.
    pub fn of_cables(&self) -> [f64; 2] {
        [self.force, self.length]
    }
}
