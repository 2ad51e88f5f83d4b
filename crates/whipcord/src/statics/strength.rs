//! How strong a load is for a rod: how finely it has to be integrated, by how much the load may be raised
//! at first, and how long an answer is looked for.
//!
//! A force F bends a rod within `δ = √(EI/F)` from where it is held or pushed; beyond that the rod lies in the
//! direction of the force. Steps that are much longer than δ do not see that layer.

use super::continuation::FIRST_LOAD_STEP;
use super::grid::Grid;
use super::loads::AppliedLoads;
use super::scales::Scales;

/// A load on a rod, without dimension; by default none.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Strength {
    /// The greatest force in units of EI/L².
    force: f64,
    /// The applied moments in units of EI/L.
    moment: f64,
    /// The longest step of the coarsest grid over the length.
    step: f64,
}

/// A step may be so many times as long as the layer in which a force bends the rod.
const STEP_IN_LAYER: f64 = 1.0;
/// What bends the rod by about a radian, in units of EI/L² or EI/L.
const RADIAN: f64 = 4.0;
/// In the same units.
const OUT_OF_PROPORTION: f64 = 100.0;
/// Steps are halved so often at most before anything has been tried.
const MOST_HALVINGS: usize = 6;
/// Integration steps over all iterations that are spent before a first answer, and between an answer and
/// that on the next finer grid: many thousand shots on the coarsest grids.
const STEPS: usize = 300_000;
/// The same as a number of shots: no fewer, and where even the finest of the first grids does not see where
/// the force bends the rod, no more.
const SHOTS: usize = 200;
/// What to do where that was not enough.
pub(crate) const GAVE_UP: &str = "the search was given up, as it is where a load is out of all proportion to the stiffness: check the units of load, modulus and diameter, or apply less load";

impl Strength {
    /// Of loads that are gathered on a grid.
    pub fn of(loads: &AppliedLoads, grid: &Grid, length: f64) -> Self {
        let scales = Scales::of(grid, length);
        let [force, moment] = loads.greatest(grid);
        let longest = grid.steps.iter().map(|step| step.length).fold(0.0, f64::max);
        let (force, moment) = (force / scales.force, moment / scales.moment);
        Self { force, moment, step: longest / length }
    }

    /// How often the steps of the grid have to be halved to see where the force bends the rod; `None` where
    /// that is too often.
    fn halvings(&self) -> Option<usize> {
        let layers = self.step * self.force.sqrt();
        (0..=MOST_HALVINGS).find(|&n| layers <= STEP_IN_LAYER * f64::from(1_u32 << n))
    }

    /// How many equal steps from base to tip see where the force bends the rod.
    pub fn steps(&self) -> usize {
        // A finite ratio: a valid robot has stiffness, and forces are finite.
        (self.force.sqrt() / STEP_IN_LAYER).ceil() as usize
    }

    /// How often the steps of the grid are halved before anything is tried.
    pub fn first_level(&self) -> usize {
        self.halvings().unwrap_or(MOST_HALVINGS)
    }

    /// Whether it bends the rod far more than by a radian.
    pub fn is_out_of_proportion(&self) -> bool {
        self.force.max(self.moment) > OUT_OF_PROPORTION
    }

    /// The fraction of the load that it is raised by at first.
    pub fn first_load_step(&self) -> f64 {
        (RADIAN / self.force.max(self.moment)).min(FIRST_LOAD_STEP)
    }

    /// What a solve may spend on a grid, and on those before it, in integration steps.
    pub fn allowance(&self, grid: &Grid) -> usize {
        let shots = SHOTS * grid.len();
        if self.halvings().is_some() { STEPS.max(shots) } else { shots }
    }
}
