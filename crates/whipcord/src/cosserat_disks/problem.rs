//! What is to be solved on a mesh, and where the iteration starts.

use whipcord_numerics::Pose;

use super::layout::{Frame, Mesh};
use crate::budget::Meter;
use crate::case::Case;
use crate::shape::Wrench;
use crate::solution::Solution;
use crate::statics::command::Command;
use crate::statics::friction::Holes;
use crate::statics::options::StabilityAnalysis;

/// What is to be solved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    pub frame: &'a Frame,
    pub mesh: &'a Mesh,
    /// By cable.
    pub commands: &'a [Command],
    pub tolerance: f64,
    pub meter: &'a Meter,
    /// With hole friction.
    pub holes: Option<&'a Holes>,
    /// Whose loads they are.
    pub case: &'a Case,
    /// Where stability is computed.
    pub sampled: Sampled<'a>,
    /// What is asked of it.
    pub stability: StabilityAnalysis,
}

impl Problem<'_> {
    /// Whether a cable is driven by its length.
    pub fn by_length(&self) -> bool {
        self.commands.iter().any(|command| matches!(command, Command::Length { .. }))
    }

    /// The commands at a fraction of the way from the robot at rest.
    pub fn commands_at(&self, fraction: f64) -> Vec<Command> {
        let of_cable = |(&rest, command): (&f64, &Command)| match *command {
            Command::Tension(tension) => Command::Tension(fraction * tension),
            Command::Length { target, compliance } => {
                Command::Length { target: rest + fraction * (target - rest), compliance }
            }
        };
        self.frame.rest_lengths.iter().zip(self.commands).map(of_cable).collect()
    }

    /// How many disks there are, the base included.
    pub fn disks(&self) -> usize {
        self.frame.spans.len() + 1
    }
}

/// Where the iteration starts.
#[derive(Clone, Copy, Debug)]
pub(super) enum Start<'a> {
    /// From the robot without load.
    Cold,
    /// From the answer that the scratch holds, on a coarser mesh.
    Coarser,
    /// From a neighbouring answer.
    Near(&'a Neighbour),
}

/// A neighbouring answer.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbour {
    /// By cable, in N.
    pub tensions: Vec<f64>,
    /// As the base sees them.
    pub disks: Vec<Pose>,
    /// What the base exerts.
    pub base: Option<Wrench>,
    /// Whether it was stable, so that what is near is held to be.
    pub stable: bool,
}

impl Neighbour {
    /// Takes over an answer.
    pub fn set(&mut self, solution: &Solution) {
        let to_base = solution.disks.poses.first().map_or(Pose::IDENTITY, Pose::inverse);
        self.tensions.clear();
        self.tensions.extend(solution.cables.iter().map(|cable| cable.tension.unwrap_or(0.0)));
        self.disks.clear();
        self.disks.extend(solution.disks.poses.iter().map(|pose| to_base * *pose));
        self.base = solution.base_wrench;
        self.stable = !solution.diagnostics.is_unstable();
    }
}

/// The meshes on which stability is computed. Its error goes with the fourth power of the step, and is far below
/// what anybody asks of it where positions still matter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sampled<'a> {
    /// Where no span is near its own buckling load.
    pub usual: &'a Mesh,
    /// With four elements to a span at least.
    pub fine: &'a Mesh,
}
