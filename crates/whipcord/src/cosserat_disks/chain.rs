//! The loaded robot: a chain of spans that is closed by Newton's method.
//!
//! Every disk has its rotation `Rₖ`, the total moment `Mₖ` just beyond it and, with loads that turn
//! with the body, their share `Gₖ` of the force there; every span has the wrench `wₖ` in its rod. The
//! residuals are those of eq. (3) and the gaps to the next disk,
//!
//! ```text
//! Rₖ₊₁ = Rₖ Q(wₖ),   Mₖ₊₁ = Qᵀm(ℓ) + Σ τ h₁ × Qᵀt − (moments applied to the disk),   Gₖ₊₁ = Gₖ − …    (4)
//! ```
//!
//! with `(N, M)ₖ = (Rₖᵀ(Fₖ + Gₖ), Mₖ)` and `F` the force of the dead loads, known beforehand. The
//! change of `wₖ` is eliminated span by span, the rest from base to tip by the elimination that the
//! model with continuous cables uses too: like that it stays well conditioned under strong loads.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::anchors::{Anchors, ChordChange};
use super::between_disks::Span;
use super::chord::Chord;
use super::column::Column;
use super::layout::{Frame, Mesh};
use super::loaded_span::{Angles, Gap, Link, OfAnchors, Slope};
use super::node::Direction;
use super::node::Node;
use super::rod::{self, InSpan};
use super::span::{self, Answer, Taut, Vanished};
use super::task::Task;
use super::variation::Sample;
use crate::section::BodyWrench;
use crate::section::Fault;
use crate::section::SectionFault;
use crate::shape::Wrench;
use crate::statics::elimination::{Change, Elimination};
use crate::statics::loads::AppliedLoads;
use crate::statics::passages::Anchor;
use crate::statics::path::state::Part;
use crate::statics::shared_unknowns::SharedUnknowns;
use crate::statics::trace::Trace;

/// The chain, and memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    pub nodes: Vec<Node>,
    /// By group.
    pub tensions: Vec<f64>,
    /// Factor on all loads that Newton's method ended at.
    pub load: f64,
    /// By group, in m.
    pub lengths: Vec<f64>,
    /// Poses at the ends of all steps, relative to the disk before.
    pub poses: Vec<Pose>,
    /// Of all passages.
    pub chords: Vec<Chord>,
    pub pulled: Vec<f64>,
    /// Derivatives of the lengths of each group by the tension of each, by rows.
    pub length_by_tension: Vec<f64>,
    pub(super) samples: Vec<Sample>,
    pub trace: Trace,
    /// How the spans ended short of the next disk, and as what they were last linearised.
    pub(super) gaps: Vec<Gap>,
    pub(super) links: Vec<Link>,
    /// Changes of the chords by what [`Link::by`] counts and by the load, span after span.
    pub(super) rows: Vec<f64>,
    /// By how the pieces of cable are directed, the angles that they enclose in the holes; empty where these do not count.
    pub(super) slopes: Vec<Slope>,
    /// Changes of those angles by what [`Link::by`] counts, span after span: in the near holes, then in the far ones.
    pub(super) angle_rows: Vec<f64>,
    /// What the tensions of cables that are anchored between two disks do at the same wrenches in the rod: by anchor, and the
    /// changes of the chords and of those angles ([`Span::anchor_rows`]).
    pub(super) by_anchor: Vec<Answer>,
    pub(super) anchor_rows: Vec<f64>,
    pub(super) anchor_angles: Vec<f64>,
    anchor_changes: Vec<ChordChange>,
    pub(super) kept: Vec<Node>,
    pub(super) kept_tensions: Vec<f64>,
    pub(super) kept_load: f64,
    pub(super) step: Direction,
    pub(super) columns: Vec<Change>,
    pub(super) elimination: Elimination,
    pub(super) shared: SharedUnknowns,
    pub(super) shared_columns: Vec<Column>,
    /// The numbers of all groups.
    pub(super) all: Vec<usize>,
}

/// Rows of [`Chain::rows`] for each passage.
pub(super) const ROWS: usize = 10;
/// Rows of [`Chain::angle_rows`] for each passage.
pub(super) const ANGLE_ROWS: usize = 18;

/// [`Chain::measure`] with the instructions that the processor has, to the same bits.
struct Measure<'a> {
    chain: &'a mut Chain,
    task: &'a Task<'a>,
}

impl WithSimd for Measure<'_> {
    type Output = Result<f64, Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.chain.measure_with(self.task)
    }
}

/// [`Chain::linearise`] likewise.
struct Linearise<'a> {
    chain: &'a mut Chain,
    task: &'a Task<'a>,
}

impl WithSimd for Linearise<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.chain.linearise_with(self.task)
    }
}

impl Chain {
    /// Starts from spans without load.
    pub fn start(&mut self, frame: &Frame, mesh: &Mesh, wrenches: &[BodyWrench], poses: &[Pose]) {
        self.nodes.clear();
        let mut rotation = UnitQuaternion::IDENTITY;
        for (steps, &wrench) in mesh.spans.iter().zip(wrenches) {
            self.nodes.push(Node { rotation, wrench, ..Node::default() });
            rotation = (rotation * poses[steps.end - 1].rotation).renormalized();
        }
        self.nodes.push(Node { rotation, ..Node::default() });
        debug_assert_eq!(self.nodes.len(), frame.spans.len() + 1);
    }

    /// Starts from a robot that is bent evenly, by this rotation in all; `unit` bends it by 1 rad.
    pub fn start_bent(&mut self, frame: &Frame, bend: Vec3, unit: f64) {
        let length = frame.rod.backbone().length;
        let moment = unit * bend;
        let wrench = BodyWrench { linear: Vec3::ZERO, angular: moment };
        let turned = |s: f64| UnitQuaternion::exp(bend * (s / length));
        let node = |s: f64| Node { rotation: turned(s), moment, wrench, ..Node::default() };
        self.nodes.clear();
        self.nodes.extend(frame.spans.iter().map(|span| node(span.start)));
        self.nodes.push(Node { rotation: turned(length), ..Node::default() });
    }

    /// Starts from disks that stand at these poses and what the base exerts on the robot there.
    pub fn start_from(&mut self, task: &Task<'_>, disks: &[Pose], base: Wrench) {
        let frame = task.frame;
        let mut chords = core::mem::take(&mut self.chords);
        chords.resize(frame.passages, Chord::default());
        let mut moment = base.moment;
        let mut share = task.loads.follower_share(base.force);
        self.nodes.clear();
        for (k, span) in frame.spans.iter().enumerate() {
            let (near, far) = (&disks[k], &disks[k + 1]);
            let steps = &task.mesh.spans[k];
            let to_disk = near.rotation.conjugate();
            let dead = |k: usize, j: usize| task.loads.force(k, j);
            let force = to_disk.rotate(dead(steps.start, 0) + share);
            let total = BodyWrench { linear: force, angular: to_disk.rotate(moment) };
            let slots = &mut chords[span.first..span.first + span.passages.len()];
            let drawn = span::estimate(span, &(near.inverse() * *far), slots);
            let pulled = if drawn.is_ok() {
                span::pull(span, slots, &self.pulled[span.first..])
            } else {
                BodyWrench::default()
            };
            self.nodes.push(Node {
                rotation: near.rotation,
                moment: total.angular,
                force: share,
                wrench: total - pulled,
            });
            let middle = 0.5 * (dead(steps.start, 0) + dead(steps.end - 1, 4)) + share;
            moment -= (far.position - near.position).cross(middle);
            for (step, place) in steps.clone().zip(steps.start + 1..) {
                if let Some(line) = task.loads.line(step) {
                    let h = task.mesh.grid.steps[step].length;
                    let turned = far.rotation.rotate(line.follower_moment(0.5));
                    moment -= h * (line.moment(0.5) + turned);
                    share -= h * far.rotation.rotate(line.follower_force(0.5));
                }
                let follower = task.loads.follower(place);
                moment -= task.loads.moment(place) + far.rotation.rotate(follower.moment);
                share -= far.rotation.rotate(follower.force);
            }
        }
        self.chords = chords;
        let rotation = disks.last().map_or(UnitQuaternion::IDENTITY, |pose| pose.rotation);
        self.nodes.push(Node { rotation, ..Node::default() });
    }

    /// Gives the passages the tensions of their groups.
    pub fn pull(&mut self, groups: &[usize], tensions: &[f64]) {
        self.tensions.clear();
        self.tensions.extend_from_slice(tensions);
        self.expand(groups);
    }

    fn expand(&mut self, groups: &[usize]) {
        self.pulled.clear();
        self.pulled.extend(groups.iter().map(|&group| self.tensions[group]));
    }

    /// Integrates all spans; the greatest gap.
    pub(super) fn measure(&mut self, task: &Task<'_>) -> Result<f64, Fault> {
        Arch::new().dispatch(Measure { chain: self, task })
    }

    #[inline(always)]
    fn measure_with(&mut self, task: &Task<'_>) -> Result<f64, Fault> {
        let Task { frame, mesh, loads, load, .. } = *task;
        task.meter.integrate(mesh.grid.len());
        let scales = frame.scales(mesh);
        let count = frame.spans.len();
        self.gaps.resize(count, Gap::default());
        self.poses.resize(mesh.grid.len(), Pose::IDENTITY);
        self.chords.resize(frame.passages, Chord::default());
        self.samples.resize(3 * mesh.grid.len(), Sample::default());
        self.lengths.clear();
        self.lengths.resize(self.tensions.len(), 0.0);
        let mut greatest: f64 = 0.0;
        for (k, span) in frame.spans.iter().enumerate() {
            let steps = mesh.spans[k].clone();
            let cables = span.passages.len();
            let (node, next) = (self.nodes[k], self.nodes[k + 1]);
            let inside = InSpan::at(loads, load, node.rotation, steps.start);
            let samples = &mut self.samples[3 * steps.start..3 * steps.end];
            let poses = &mut self.poses[steps.clone()];
            let grid = &mesh.grid;
            let chords = &mut self.chords[span.first..span.first + cables];
            let tensions = &self.pulled[span.first..span.first + cables];
            let at = mesh.anchors_of(span);
            let anchors = Anchors { at, passages: &span.passages, tensions };
            let anchors = (&anchors, &mut *chords);
            let end =
                rod::integrate(grid, steps.clone(), node.wrench, &inside, anchors, poses, samples);
            span::draw(span, &end.pose, chords).map_err(|gone| folded(gone, span))?;
            for (chord, &group) in chords.iter().zip(&task.groups[span.first..]) {
                self.lengths[group] += chord.length;
            }
            let gap = Gap::new(task, k, (&node, &next), &end, chords, tensions);
            greatest = greatest.max(gap.size(&scales, &node, &next));
            self.gaps[k] = gap;
        }
        for (i, command) in task.commands.iter().enumerate() {
            let Self { tensions, lengths, .. } = &*self;
            let left = command.complementarity_residual(i, tensions, lengths, scales.of_cables());
            // A NaN must not pass for a closed gap.
            greatest = if left.is_finite() { greatest.max(left) } else { f64::INFINITY };
        }
        Ok(greatest)
    }

    /// Linearises all spans where they were last measured; `false` where one is singular.
    pub(super) fn linearise(&mut self, task: &Task<'_>) -> bool {
        Arch::new().dispatch(Linearise { chain: self, task })
    }

    #[inline(always)]
    fn linearise_with(&mut self, task: &Task<'_>) -> bool {
        let frame = task.frame;
        self.links.resize(frame.spans.len(), Link::default());
        self.rows.resize(ROWS * frame.passages, 0.0);
        self.angle_rows.resize(ANGLE_ROWS * self.slopes.len(), 0.0);
        self.by_anchor.resize(task.mesh.anchors.len(), Answer::default());
        self.anchor_rows.resize(frame.anchor_rows, 0.0);
        let counts = !self.slopes.is_empty();
        self.anchor_angles.resize(if counts { 2 * frame.anchor_rows } else { 0 }, 0.0);
        for (k, span) in frame.spans.iter().enumerate() {
            let steps = &task.mesh.spans[k];
            let passages = span.first..span.first + span.passages.len();
            let anchors = task.mesh.anchors_of(span);
            let of_anchors =
                span.anchor_rows..span.anchor_rows + anchors.len() * span.passages.len();
            self.anchor_changes.resize(6 * anchors.len(), ChordChange::default());
            let taut = Taut {
                span,
                anchors,
                samples: &self.samples[3 * steps.start..3 * steps.end],
                pose: self.poses[steps.end - 1],
                chords: &self.chords[passages.clone()],
                tensions: &self.pulled[passages.clone()],
            };
            let rows = &mut self.rows[ROWS * passages.start..ROWS * passages.end];
            let angles = match self.slopes.get(passages.clone()) {
                Some(slopes) => {
                    let rows = ANGLE_ROWS * passages.start..ANGLE_ROWS * passages.end;
                    let both = 2 * of_anchors.start..2 * of_anchors.end;
                    Angles {
                        slopes,
                        rows: &mut self.angle_rows[rows],
                        by_tension: self.anchor_angles.get_mut(both).unwrap_or_default(),
                    }
                }
                None => Angles::default(),
            };
            let of_anchors = OfAnchors {
                answers: &mut self.by_anchor[span.anchors.clone()],
                rows: &mut self.anchor_rows[of_anchors],
                changes: &mut self.anchor_changes,
            };
            let rotation = self.nodes[k].rotation;
            let gap = &self.gaps[k];
            match Link::new(task, k, rotation, gap, &taut, (rows, angles), of_anchors) {
                Some(link) => self.links[k] = link,
                None => {
                    self.links.clear();
                    return false;
                }
            }
        }
        true
    }

    /// What acts in the rod just beyond disks and anchors, in the base frame and beyond the dead loads, at the steps that begin
    /// there.
    pub fn starts_into(
        &self,
        frame: &Frame,
        mesh: &Mesh,
        loads: &AppliedLoads,
        starts: &mut Vec<Option<Wrench>>,
    ) {
        starts.clear();
        starts.resize(mesh.grid.len(), None);
        let spans = frame.spans.iter().zip(&mesh.spans);
        for ((span, steps), node) in spans.zip(&self.nodes) {
            let disk = node.rotation;
            let start = |step: usize, turn: UnitQuaternion, wrench: &BodyWrench| Wrench {
                force: turn.rotate(wrench.linear) - loads.force(step, 0),
                moment: turn.rotate(wrench.angular),
            };
            starts[steps.start] = Some(start(steps.start, disk, &node.wrench));
            for &Anchor { node, .. } in mesh.anchors_of(span) {
                // The first sample of the step that begins there.
                let Sample { rotation, wrench, .. } = &self.samples[3 * node];
                starts[node] = Some(start(node, disk * *rotation, wrench));
            }
        }
    }

    /// Goes a fraction of the step from where the nodes were kept.
    pub(super) fn go(&mut self, task: &mut Task<'_>, fraction: f64) {
        for ((node, kept), step) in self.nodes.iter_mut().zip(&self.kept).zip(&self.step.nodes) {
            *node = kept.stepped(fraction, step);
        }
        task.load = self.kept_load + fraction * self.step.load;
        if !self.shared.cables.is_empty() {
            for &group in &self.shared.cables {
                let change = fraction * self.step.tensions[group];
                self.tensions[group] = (self.kept_tensions[group] + change).max(0.0);
            }
            self.expand(task.groups);
        }
    }
}

fn folded(gone: Vanished, span: &Span) -> Fault {
    Fault { kind: SectionFault::Folded { cable: gone.cable }, arc_length: span.start }
}
