//! The discretisation error of an answer, by its change from one grid to the next.

use whipcord_numerics::Pose;

use super::grid::Grid;
use super::scales::Scales;

/// A step of order 5 that is halved loses all but 1/32 of its error, so that its change is 31 times what is left. Measured
/// on robots under loads it is 44 to 93 times; without load the order is 6.
pub(crate) const ERROR_RATIO: f64 = 31.0;

/// What answers on different grids are compared by.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coarse {
    poses: Vec<Pose>,
    lengths: Vec<f64>,
}

impl Coarse {
    /// Keeps an answer on a grid: frames at the ends of all its steps, and lengths of the cables in m.
    pub fn keep(&mut self, grid: &Grid, poses: &[Pose], lengths: &[f64]) {
        self.poses.clear();
        self.poses.extend(compared(grid).map(|k| poses[k]));
        self.lengths.clear();
        self.lengths.extend_from_slice(lengths);
    }

    /// Frames of the kept answer at the disks, and then at the stations.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    /// Its lengths of the cables in m.
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Largest change of a position or a cable's length since then, in m.
    pub fn change(&self, grid: &Grid, poses: &[Pose], lengths: &[f64]) -> f64 {
        let moved = compared(grid)
            .zip(&self.poses)
            .map(|(k, coarse)| (poses[k].position - coarse.position).norm());
        let lengths = lengths.iter().zip(&self.lengths).map(|(fine, coarse)| (fine - coarse).abs());
        moved.chain(lengths).fold(0.0, f64::max)
    }
}

/// A tension below this part of the greatest one of all cables, or of the force that bends the rod, needs no accuracy of its own:
/// that of a cable that is about to get slack is a small difference of great ones.
const SLIGHT: f64 = 1e-2;

/// Largest change of a tension from one grid to the next, relative to the tension.
pub(crate) fn change_of_tensions(fine: &[f64], coarse: &[f64], scales: &Scales) -> f64 {
    let greatest = fine.iter().chain(coarse).copied().fold(scales.force, f64::max);
    let least = SLIGHT * greatest;
    let pairs = fine.iter().zip(coarse);
    pairs.map(|(fine, coarse)| (fine - coarse).abs() / fine.max(least)).fold(0.0, f64::max)
}

/// Disks and stations.
fn compared(grid: &Grid) -> impl Iterator<Item = usize> + '_ {
    grid.disks.iter().chain(&grid.stations).copied()
}
