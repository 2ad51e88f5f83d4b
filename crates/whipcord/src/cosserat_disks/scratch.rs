//! Memory of a solve, and the answer it ends with.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::chain::Chain;
use super::chord::{self, Chord};
use super::layout::{Frame, Mesh};
use super::node::Node;
use super::problem::Problem;
use super::stability::{Locked, Stability};
use super::unloaded::Unloaded;
use super::variation::Sample;
use crate::section::BodyWrench;
use crate::shape::Wrench;
use crate::statics::friction::{Course, FrictionScratch, History};
use crate::statics::lengths::{Effort, LengthScratch};
use crate::statics::loads::AppliedLoads;
use crate::statics::outcome::Found;

/// Memory of a solve, and the answer it ends with.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// Frames at the ends of all steps, the base first.
    pub poses: Vec<Pose>,
    /// By cable, in N and m.
    pub tensions: Vec<f64>,
    pub lengths: Vec<f64>,
    pub base_wrench: Wrench,
    /// The state of hole friction.
    pub(super) history: History<Vec<Node>>,
    /// Whether the last answer from cold is an equilibrium that the robot leaves, and no stable one was found.
    pub(super) unstable: bool,
    /// Whether the robot under loads was found without them.
    pub(super) found_without_load: bool,
    /// What the iterate leaves open at which the budget was spent; it is then in the place of the answer.
    pub(super) open: Option<Effort>,
    /// The state of the holes in the iteration.
    pub(super) friction: FrictionScratch,
    /// The substeps of the step of actuation, from 0 to 1; empty where they are not known.
    pub(super) course: Course<Vec<Node>>,
    pub(super) applied: AppliedLoads,
    pub(super) unloaded: Unloaded,
    pub(super) chain: Chain,
    /// Tension of every passage.
    pub(super) pulled: Vec<f64>,
    pub(super) stability: Stability,
    pub(super) samples: Vec<Sample>,
    pub(super) sampled: Vec<Pose>,
    pub(super) sampled_chords: Vec<Chord>,
    pub(super) applied_to_sample: AppliedLoads,
    pub(super) groups: Vec<usize>,
    /// What is held at its length, for stability; and how the disks are turned.
    pub(super) locked: Locked,
    pub(super) turned: Vec<UnitQuaternion>,
    pub(super) length_by_tension: Vec<f64>,
    pub(super) length_scratch: LengthScratch,
    /// The tensions where a search for lengths begins.
    pub(super) first_tensions: Vec<f64>,
}

impl Scratch {
    /// What acts in the rod of the answer just beyond the disks, as [`crate::derivatives`] takes it.
    pub fn starts_into(&self, frame: &Frame, mesh: &Mesh, starts: &mut Vec<Option<Wrench>>) {
        if self.applied.any() {
            return self.chain.starts_into(frame, mesh, &self.applied, starts);
        }
        let Self { unloaded, pulled, poses, .. } = self;
        starts.clear();
        starts.resize(mesh.grid.len(), None);
        for ((span, steps), wrench) in frame.spans.iter().zip(&mesh.spans).zip(&unloaded.wrenches) {
            let disk = poses[steps.start].rotation;
            let mut wrench = *wrench;
            let mut put = |node: usize, wrench: BodyWrench| {
                let position = match node - steps.start {
                    0 => Vec3::ZERO,
                    _ => unloaded.poses[node - 1].position,
                };
                let moment = wrench.angular - position.cross(wrench.linear);
                starts[node] =
                    Some(Wrench { force: disk.rotate(wrench.linear), moment: disk.rotate(moment) });
            };
            put(steps.start, wrench);
            for anchor in mesh.anchors_of(span) {
                let p = span.first + anchor.passage;
                let near = span.passages[anchor.passage].near;
                wrench = wrench + chord::unit_pull(near, &unloaded.chords[p]) * pulled[p];
                put(anchor.node, wrench);
            }
        }
    }
}

/// Frames from base to tip and what the base bears, from the spans of the answer.
pub(super) fn copy_out(problem: &Problem<'_>, scratch: &mut Scratch) {
    let loaded = scratch.applied.any();
    let relative = if loaded { &scratch.chain.poses } else { &scratch.unloaded.poses };
    scratch.poses.clear();
    scratch.poses.push(Pose::IDENTITY);
    let mut disk = Pose::IDENTITY;
    for steps in &problem.mesh.spans {
        for k in steps.clone() {
            scratch.poses.push(disk * relative[k]);
        }
        disk = disk * relative[steps.end - 1];
    }
    scratch.base_wrench = match scratch.chain.nodes.first() {
        Some(node) if loaded => {
            Wrench { force: scratch.applied.base_force() + node.force, moment: node.moment }
        }
        _ => Wrench::default(),
    };
}

/// Copies the answer out of the closed chain.
pub(super) fn finish(problem: &Problem<'_>, scratch: &mut Scratch, effort: Effort) -> Found {
    scratch.tensions.clone_from(&scratch.chain.tensions);
    scratch.lengths.clone_from(&scratch.chain.lengths);
    scratch.pulled.clone_from(&scratch.chain.pulled);
    copy_out(problem, scratch);
    Found::with(effort)
}
