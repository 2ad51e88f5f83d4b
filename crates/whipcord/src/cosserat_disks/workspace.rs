//! Memory of a solve, and how far it came.

use whipcord_numerics::Pose;

use super::layout::Mesh;
use super::node::Node;
use super::problem::Neighbour;
use super::scratch::Scratch;
use super::unloaded::Unloaded;
use crate::budget::Meter;
use crate::derivatives::TipRatesMemory;
use crate::shape::Wrench;
use crate::solution::SlipState;
use crate::statics::command::Command;
use crate::statics::friction::{Course, History};
use crate::statics::loads::AppliedLoads;
use crate::statics::outcome::Found;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::refinement::{Coarse, change_of_tensions};
use crate::statics::scales::Scales;

/// Scratch memory of a solve. Nothing is carried over in it from one solve to the next but the
/// memory itself.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(super) scratch: Scratch,
    pub(super) commands: Vec<Command>,
    pub(super) coarse: Coarse,
    pub(super) coarse_tensions: Vec<f64>,
    pub(super) coarse_base_wrench: Wrench,
    pub(super) histories: Vec<StepHistory>,
    /// Whether these keep the ends of all substeps.
    pub(super) keeps_trail: bool,
    /// The substeps of each step of actuation, the same on all meshes.
    pub(super) courses: Vec<Course<Vec<Node>>>,
    pub(super) meter: Meter,
    pub(super) neighbour: Neighbour,
    pub(super) tip_rates: TipRatesMemory,
    /// How far the solve came: the best shape where its budget is spent.
    pub(super) progress: Progress,
}

/// What a solve has found so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Progress {
    /// How often the steps of the mesh are halved that it is on.
    pub level: usize,
    /// Whether there is an answer on coarser steps, which the workspace keeps.
    pub coarser: Option<Found>,
}

/// How far the steps of actuation have been walked on a mesh, and what the holes remember there.
#[derive(Clone, Debug, Default)]
pub(super) struct StepHistory {
    pub taken: usize,
    pub history: History<Vec<Node>>,
    /// What friction against bending held after each of these steps; none without it.
    pub plastic: Vec<PlasticCurvature>,
}

impl Workspace {
    /// What drives each cable, of the case that was accepted last.
    pub(super) fn commands(&self) -> &[Command] {
        &self.commands
    }

    /// What the solve has spent.
    pub(super) const fn meter(&self) -> &Meter {
        &self.meter
    }

    pub(super) const fn meter_mut(&mut self) -> &mut Meter {
        &mut self.meter
    }

    /// Loads of that case.
    pub(super) const fn loads(&self) -> &AppliedLoads {
        &self.scratch.applied
    }

    /// The robot without load.
    pub(super) const fn unloaded_mut(&mut self) -> &mut Unloaded {
        &mut self.scratch.unloaded
    }

    /// Frames at the ends of all steps, the base first.
    pub(super) fn poses(&self) -> &[Pose] {
        &self.scratch.poses
    }

    /// Takes a state for the answer.
    pub(super) fn adopt(
        &mut self,
        poses: &[Pose],
        tensions: &[f64],
        lengths: &[f64],
        base_wrench: Wrench,
    ) {
        let scratch = &mut self.scratch;
        scratch.poses.clear();
        scratch.poses.extend_from_slice(poses);
        scratch.tensions.clear();
        scratch.tensions.extend_from_slice(tensions);
        scratch.lengths.clear();
        scratch.lengths.extend_from_slice(lengths);
        scratch.base_wrench = base_wrench;
    }

    /// The same of the tensions and the slip states of the passages of cables that rub.
    pub(super) fn adopt_holes(&mut self, tensions: &[f64], slip_states: &[SlipState]) {
        let history = &mut self.scratch.history;
        history.tensions.clear();
        history.tensions.extend_from_slice(tensions);
        history.slip_states.clear();
        history.slip_states.extend_from_slice(slip_states);
    }

    /// Keeps what the answer on a coarse mesh is compared by.
    pub(super) fn keep(&mut self, mesh: &Mesh) {
        self.coarse.keep(&mesh.grid, &self.scratch.poses, &self.scratch.lengths);
        self.coarse_tensions.clone_from(&self.scratch.tensions);
        self.coarse_base_wrench = self.scratch.base_wrench;
    }

    /// Largest change of a position or a cable's length since then, in m. Where lengths are given
    /// it is the tensions that change, which counts as a fraction of the length.
    pub(super) fn change(&self, mesh: &Mesh, length: f64) -> f64 {
        let moved = self.coarse.change(&mesh.grid, &self.scratch.poses, &self.scratch.lengths);
        let scales = Scales::of(&mesh.grid, length);
        let pulled = change_of_tensions(&self.scratch.tensions, &self.coarse_tensions, &scales);
        moved.max(length * pulled)
    }
}
