//! The cables of the robot whose answer is differentiated.

use super::rest_changes::RestChanges;
use super::spans::StraightSpan;
use crate::statics::grid::{Grid, Layout};

/// The cables of the robot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cables<'a> {
    /// In the order of the grid.
    pub order: &'a [usize],
    /// In m, in the same order.
    pub rest_lengths: &'a [f64],
    /// Where they run straight from hole to hole; their order is then that of the robot.
    pub straight: Option<StraightCables<'a>>,
    /// What the model keeps of their lengths before actuation.
    pub rest_changes: Option<&'a RestChanges>,
}

/// Cables that run straight from hole to hole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StraightCables<'a> {
    /// Between each two disks.
    pub spans: &'a [StraightSpan<'a>],
    /// The same on the grid on which their lengths before actuation are known; derivatives by parameters need it.
    pub rest: Option<(&'a Grid, &'a [StraightSpan<'a>])>,
}

impl<'a> Cables<'a> {
    /// Through every section of a grid.
    pub fn of(layout: &'a Layout) -> Self {
        let Layout { order, rest_lengths, .. } = layout;
        Self { order, rest_lengths, straight: None, rest_changes: None }
    }
}
