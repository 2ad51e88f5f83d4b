//! What the chain is closed for.

use super::layout::{Frame, Mesh};
use super::node::NodeStep;
use crate::budget::Meter;
use crate::statics::command::Command;
use crate::statics::loads::AppliedLoads;
use crate::statics::path;

/// What the chain is closed for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub frame: &'a Frame,
    pub mesh: &'a Mesh,
    pub loads: &'a AppliedLoads,
    /// Factor on all loads; where Newton's method starts, if it is free.
    pub load: f64,
    /// What the linear steps are for.
    pub step: path::Step<'a, NodeStep>,
    /// Which of the tensions each passage has.
    pub groups: &'a [usize],
    /// What drives each of them, where any is driven by its length; else empty.
    pub commands: &'a [Command],
    /// Whether the derivatives of the lengths by the tensions are wanted.
    pub derivatives: bool,
    /// Greatest gap that counts as closed.
    pub tolerance: f64,
    pub meter: &'a Meter,
}
