//! Where the steps of the rod end under contact forces.

use super::layout::Mesh;
use super::model::CosseratDisks;
use super::task::Task;
use super::workspace::Workspace;
use crate::case::Case;
use crate::error::SolveError;
use crate::robot::Robot;
use crate::statics::command::Command;
use crate::statics::options::{Accuracy, Options, StabilityAnalysis};
use crate::statics::passages::Passage;
use crate::statics::path::Step;
use crate::statics::plastic_curvature::PlasticCurvature;
use crate::statics::plastic_steps::PlasticRod as _;
use crate::stations::Stations;

/// Where its steps end.
#[derive(Clone, Debug)]
pub(super) struct ContactMesh {
    pub(super) model: CosseratDisks,
    pub(super) mesh: Mesh,
    /// How many steps there are at least, and how often each is halved.
    pub(super) steps: usize,
    pub(super) halvings: usize,
    pub(super) stations: Vec<f64>,
    pub(super) pushes: Vec<f64>,
    /// Cable of each passage.
    pub(super) groups: Vec<usize>,
}

impl ContactMesh {
    pub(super) fn new(
        robot: &Robot,
        options: &Options,
        case: &Case,
        (least, halvings): (usize, usize),
        (stations, pushes): (&[f64], &[f64]),
        plastic: Option<&PlasticCurvature>,
    ) -> Result<Self, SolveError> {
        let mut places = stations.to_vec();
        places.extend_from_slice(pushes);
        places.sort_by(f64::total_cmp);
        places.dedup();
        let steps = match options.accuracy {
            Accuracy::Steps(steps) => steps,
            Accuracy::Tolerance(_) => least,
        };
        let options = Options {
            stations: Stations::At(places),
            accuracy: Accuracy::Steps(steps),
            stability: StabilityAnalysis::Off,
            ..options.clone()
        };
        let model = CosseratDisks::new(robot, &case.loads, &options)?;
        let mesh = model.frame().mesh(steps, halvings)?;
        let passages = model.frame().spans.iter().flat_map(|span| &span.passages);
        let rubs = model.has_friction();
        // Where cables rub, every passage has a tension of its own.
        let group = |(p, passage): (usize, &Passage)| if rubs { p } else { passage.cable };
        let groups = passages.enumerate().map(group).collect();
        let (stations, pushes) = (stations.to_vec(), pushes.to_vec());
        let mut made = Self { model, mesh, steps, halvings, stations, pushes, groups };
        if let Some(plastic) = plastic {
            made.set_plastic(plastic);
        }
        Ok(made)
    }

    /// Sets the plastic curvature that the steps of actuation before left.
    pub(super) fn set_plastic(&mut self, left: &PlasticCurvature) {
        self.model.frame().set_plastic(&mut self.mesh, left);
        self.model.set_plastic(left.clone());
    }

    /// The nodes at which an answer is asked for: all where friction against bending keeps its history there.
    pub(super) fn asked_nodes(&self) -> Vec<usize> {
        let grid = &self.mesh.grid;
        match self.model.robot().has_bending_friction() {
            true => (0..=grid.len()).collect(),
            false => grid.stations.clone(),
        }
    }

    /// The node of a station or a push.
    pub(super) fn node(&self, arc_length: f64) -> usize {
        let stations = self.model.stations();
        let place = stations.partition_point(|&s| s < arc_length).min(stations.len() - 1);
        self.mesh.grid.stations[place]
    }

    /// The equations of the chain.
    pub(super) fn task<'a>(&'a self, workspace: &'a Workspace) -> Task<'a> {
        let commands = workspace.commands();
        let by_length = commands.iter().any(Command::is_length);
        let options = self.model.options();
        Task {
            frame: self.model.frame(),
            mesh: &self.mesh,
            loads: workspace.loads(),
            load: 1.0,
            step: Step::Close,
            groups: &self.groups,
            commands: if by_length && !self.model.has_friction() { commands } else { &[] },
            derivatives: false,
            tolerance: options.greatest_residual(),
            meter: workspace.meter(),
        }
    }
}
