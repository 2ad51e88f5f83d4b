//! Sections that give way to the wrenches of loads once.

use whipcord_numerics::Pose;

use crate::section::{BodyWrench, Strain, equilibrium};
use crate::statics::grid::Grid;

/// Memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Relaxation {
    /// Wrench in the middle of each step, in its frame.
    pub wrenches: Vec<BodyWrench>,
    pub strains: Vec<Strain>,
    pub poses: Vec<Pose>,
}

impl Relaxation {
    /// The strains of the rod whose sections yield to these wrenches, one for each step; `false` where
    /// one does not bear it.
    #[inline(always)]
    pub fn relax(&mut self, grid: &Grid, tensions: &[f64], unloaded: &[Strain]) -> bool {
        self.strains.clear();
        for (k, step) in grid.steps.iter().enumerate() {
            let (node, crossings) = grid.gauss.at(k, 1, step.active);
            let rest = unloaded[3 * k + 1];
            let mut strain = rest;
            let active = &tensions[..step.active];
            let wrench = self.wrenches[k];
            if equilibrium(&node.section, crossings, active, wrench, &mut strain).is_err() {
                return false;
            }
            let change = strain - rest;
            for unloaded in &unloaded[3 * k..3 * k + 3] {
                self.strains.push(*unloaded + change);
            }
        }
        true
    }
}
