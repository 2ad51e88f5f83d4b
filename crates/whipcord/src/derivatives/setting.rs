//! The robot and case of an answer, as the partial derivatives need them.

use whipcord_numerics::{Pose, UnitQuaternion};

use super::cables::Cables;
use super::linear::Linear;
use super::strands::{PLACES, Strands};
use crate::case::Case;
use crate::robot::Robot;
use crate::statics::command::Command;
use crate::statics::grid::Grid;

/// The robot and case of an answer, as the partial derivatives need them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting<'a> {
    pub robot: &'a Robot,
    pub case: &'a Case,
    pub cables: Cables<'a>,
    pub grid: &'a Grid,
    pub tensions: &'a [f64],
    /// Tensions at all shooting nodes in turn, by cables; empty where they do not vary.
    pub varying: &'a [f64],
    pub strands: &'a Strands,
    pub commands: &'a [Command],
    /// Frames at the ends of all steps.
    pub poses: &'a [Pose],
    /// The part of a change of the loads that acts.
    pub of_loads: f64,
    /// The rod at rest, where cables run straight between disks.
    pub at_rest: Option<&'a AtRest<'a>>,
}

/// The rod at rest, bearing nothing, on a grid of its own.
#[derive(Clone, Debug)]
pub(super) struct AtRest<'a> {
    pub grid: &'a Grid,
    pub linear: Linear,
}

impl Setting<'_> {
    /// The tensions of all cables at a place of the shooting grid in step `k`.
    pub fn tensions_at(&self, k: usize, place: usize) -> &[f64] {
        let cables = self.tensions.len();
        match self.varying.is_empty() {
            true => self.tensions,
            false => &self.varying[cables * (PLACES * k + place)..][..cables],
        }
    }

    /// From the frame of the dead loads to that of the base.
    pub fn turn(&self) -> UnitQuaternion {
        self.case.loads.to_base(self.case.base.rotation)
    }

    /// What the robot carries at and beyond the end of step `k`, in kg.
    pub fn carried_beyond(&self, k: usize) -> f64 {
        let loads = &self.case.loads;
        let places = &self.grid.loads[loads.points.len()..];
        let beyond = loads.masses.iter().zip(places).filter(|(_, place)| **place > k);
        beyond.map(|(mass, _)| mass.mass).sum()
    }
}
