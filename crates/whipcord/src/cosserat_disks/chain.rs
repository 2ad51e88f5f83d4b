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

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::joint::{self, Chord, Factors, Vanished};
use super::layout::{Frame, Mesh, Span};
use super::link::{Link, Push, answers};
use super::rod::{self, InSpan, Sample};
use crate::cosserat::elimination::{Change, Elimination, Size};
use crate::cosserat::loads::AppliedLoads;
use crate::cosserat::section::BodyWrench;
use crate::cosserat::section::SectionFault;
use crate::cosserat::unloaded::Fault;
use crate::shape::Wrench;

/// A disk of the chain.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub rotation: UnitQuaternion,
    /// Total moment beyond the disk, in its frame.
    pub moment: Vec3,
    /// Force of the followers beyond it, base frame.
    pub force: Vec3,
    /// Wrench in the rod beyond it, in its frame.
    pub wrench: BodyWrench,
}

/// What the chain is closed for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Task<'a> {
    pub frame: &'a Frame,
    pub mesh: &'a Mesh,
    pub loads: &'a AppliedLoads,
    /// Of all passages.
    pub tensions: &'a [f64],
    /// Factor on all loads.
    pub load: f64,
    /// Which of the shared tensions each passage has, and how many there are; empty when no
    /// derivative is wanted.
    pub groups: &'a [usize],
    pub group_count: usize,
    /// Greatest gap that counts as closed.
    pub tolerance: f64,
}

/// The chain, and memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    pub nodes: Vec<Node>,
    /// Poses at the ends of all steps, relative to the disk before.
    pub poses: Vec<Pose>,
    pub chords: Vec<Chord>,
    /// Derivatives of the lengths of each group by the tension of each, by rows.
    pub length_by_tension: Vec<f64>,
    pub samples: Vec<Sample>,
    kept: Vec<Node>,
    links: Vec<Link>,
    rows: Vec<f64>,
    columns: Vec<Change>,
    elimination: Elimination,
}

/// Why the chain did not close.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    pub iterations: usize,
    pub gap: f64,
    pub fault: Option<Fault>,
}

const MAX_ITERATIONS: usize = 40;
const LEAST_FRACTION: f64 = 1.0 / 64.0;
/// What rounding may leave where no step improves any more.
const ROUNDING: f64 = 1e-9;

/// Scales of moment and force of a rod.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scales {
    pub moment: f64,
    pub force: f64,
}

impl Scales {
    pub fn of(frame: &Frame, mesh: &Mesh) -> Self {
        let (node, _) = mesh.grid.shooting.at(0, 0, 0);
        let bending = node.section.stiffness.bending;
        let length = frame.rod.backbone().length;
        let moment = bending.x.min(bending.y).min(bending.z) / length;
        Self { moment, force: moment / length }
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

    /// Starts from disks that stand at these poses and what the base exerts on the robot there.
    pub fn start_from(&mut self, task: &Task<'_>, disks: &[Pose], base: Wrench) {
        let frame = task.frame;
        let mut chords = vec![Chord::default(); frame.passages];
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
            let drawn = joint::draw(span, &(near.inverse() * *far), slots);
            let pulled = if drawn.is_ok() {
                joint::pull(span, slots, &task.tensions[span.first..])
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
        let rotation = disks.last().map_or(UnitQuaternion::IDENTITY, |pose| pose.rotation);
        self.nodes.push(Node { rotation, ..Node::default() });
    }

    /// Newton's method; returns the iterations and the greatest gap left.
    pub fn close(&mut self, task: &Task<'_>) -> Result<(usize, f64), Open> {
        let failed = |iterations, gap, fault| Open { iterations, gap, fault };
        let mut gap = self.shoot(task).map_err(|f| failed(0, f64::INFINITY, Some(f)))?;
        for iteration in 0..MAX_ITERATIONS {
            if gap <= task.tolerance {
                return self.finish(task, iteration, gap);
            }
            if !self.eliminate(task, 0) {
                return Err(failed(iteration, gap, None));
            }
            self.kept.clone_from(&self.nodes);
            let mut fraction = 1.0;
            loop {
                self.step(task, fraction);
                match self.shoot(task) {
                    Ok(now) if now < (1.0 - 1e-4 * fraction) * gap => {
                        gap = now;
                        break;
                    }
                    Ok(now) if fraction == 1.0 && now.max(gap) <= ROUNDING => {
                        return self.finish(task, iteration + 1, now);
                    }
                    outcome => {
                        fraction *= 0.5;
                        if fraction < LEAST_FRACTION {
                            return Err(failed(iteration + 1, gap, outcome.err()));
                        }
                        self.restore_links(task);
                    }
                }
            }
        }
        Err(failed(MAX_ITERATIONS, gap, None))
    }

    fn finish(
        &mut self,
        task: &Task<'_>,
        iterations: usize,
        gap: f64,
    ) -> Result<(usize, f64), Open> {
        if !task.groups.is_empty() && !self.differentiate(task) {
            return Err(Open { iterations, gap, fault: None });
        }
        Ok((iterations, gap))
    }

    /// Integrates and linearises all spans; the greatest gap.
    fn shoot(&mut self, task: &Task<'_>) -> Result<f64, Fault> {
        let Task { frame, mesh, loads, load, .. } = *task;
        let scales = Scales::of(frame, mesh);
        let count = frame.spans.len();
        self.links.resize(count, Link::default());
        self.poses.resize(mesh.grid.len(), Pose::IDENTITY);
        self.chords.resize(frame.passages, Chord::default());
        self.samples.resize(3 * mesh.grid.len(), Sample::default());
        self.rows.resize(9 * frame.passages, 0.0);
        let mut greatest: f64 = 0.0;
        for (k, span) in frame.spans.iter().enumerate() {
            let steps = mesh.spans[k].clone();
            let cables = span.passages.len();
            let tensions = &task.tensions[span.first..span.first + cables];
            let (node, next) = (self.nodes[k], self.nodes[k + 1]);
            let to_disk = node.rotation.conjugate();
            let at_start = loads.force(steps.start, 0);
            let inside = InSpan { applied: loads, load, to_disk, at_start };
            let samples = &mut self.samples[3 * steps.start..3 * steps.end];
            let poses = &mut self.poses[steps.clone()];
            let end = rod::integrate(
                &mesh.grid,
                steps.clone(),
                node.wrench,
                Some(&inside),
                poses,
                samples,
            );
            let chords = &mut self.chords[span.first..span.first + cables];
            joint::draw(span, &end.pose, chords).map_err(|gone| folded(gone, span))?;
            let total_force = to_disk.rotate(load * at_start + node.force);
            let total = BodyWrench { linear: total_force, angular: node.moment };
            let residual = node.wrench + joint::pull(span, chords, tensions) - total;
            let rows = &mut self.rows[9 * span.first..9 * (span.first + cables)];
            let by = answers(task, k, samples, chords, &end.pose, &inside, rows);
            let Some(factors) = Factors::new(&by) else {
                return Err(Fault { kind: SectionFault::Diverged, arc_length: span.start });
            };
            let rotation = (node.rotation * end.pose.rotation).renormalized();
            let follower = loads.follower(steps.end);
            let dead = load * rotation.conjugate().rotate(loads.moment(steps.end));
            let applied = dead + load * follower.moment;
            let moment = joint::far_moment(span, &end, chords, tensions) - applied;
            let force = node.force
                - node.rotation.rotate(end.followers)
                - load * rotation.rotate(follower.force);
            let gap = Change {
                turn: (next.rotation.conjugate() * rotation).log(),
                moment: moment - next.moment,
                force: force - next.force,
            };
            greatest = greatest
                .max(gap.turn.norm())
                .max(gap.moment.norm() / (scales.moment + next.moment.norm()))
                .max(gap.force.norm() / (scales.force + next.force.norm()))
                .max(residual.linear.norm() / (scales.force + node.wrench.linear.norm()))
                .max(residual.angular.norm() / (scales.moment + node.wrench.angular.norm()));
            let finite = gap.is_finite() && residual.linear.is_finite();
            if !(finite && residual.angular.is_finite()) {
                greatest = f64::INFINITY;
            }
            self.links[k] = Link {
                by,
                factors,
                residual,
                total_force,
                turn: end.pose.rotation,
                followers: end.followers,
                gap,
                applied: dead,
                follower: load * rotation.rotate(follower.force),
            };
        }
        Ok(greatest)
    }

    /// Eliminates the chain with this many shared tensions.
    fn eliminate(&mut self, task: &Task<'_>, shared: usize) -> bool {
        let cut = if task.loads.any_follower_force() { 6 } else { 3 };
        let scales = Scales::of(task.frame, task.mesh);
        self.elimination.start(Size { cut, shared }, scales.moment, scales.force);
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        for (k, span) in task.frame.spans.iter().enumerate() {
            let link = self.links[k];
            let rotation = self.nodes[k].rotation;
            let mut columns = core::mem::take(&mut self.columns);
            columns.clear();
            for axis in axes {
                columns.push(link.pass(rotation, &Push { turn: axis, ..Push::default() }).1);
            }
            for axis in axes {
                columns.push(link.pass(rotation, &Push { moment: axis, ..Push::default() }).1);
            }
            if cut == 6 {
                for axis in axes {
                    columns.push(link.pass(rotation, &Push { force: axis, ..Push::default() }).1);
                }
            }
            for group in 0..shared {
                columns.push(link.pass(rotation, &self.tug(task, k, group)).1);
            }
            let closing = link.pass(rotation, &Push { close: 1.0, ..Push::default() }).1;
            let gap = link.gap.plus(1.0, closing);
            let regular = self.elimination.push(&columns, &gap);
            self.columns = columns;
            if !regular {
                return false;
            }
            debug_assert_eq!(span.first, task.frame.spans[k].first);
        }
        self.elimination.answer();
        (0..=task.frame.spans.len()).all(|k| self.elimination.change(k, shared).is_finite())
    }

    /// What one more newton in the passages of a group does to a span.
    fn tug(&self, task: &Task<'_>, k: usize, group: usize) -> Push {
        let span = &task.frame.spans[k];
        let to_far = self.links[k].turn.conjugate();
        let mut push = Push::default();
        for (i, passage) in span.passages.iter().enumerate() {
            if task.groups[span.first + i] == group {
                let chord = &self.chords[span.first + i];
                push.pull = push.pull + joint::unit_pull(passage.near, chord);
                push.far += passage.far.cross(to_far.rotate(chord.along));
            }
        }
        push
    }

    /// Goes a fraction of the Newton step from where the nodes were kept; the links are still those
    /// of that place.
    fn step(&mut self, task: &Task<'_>, fraction: f64) {
        for k in 0..self.nodes.len() {
            let change = self.elimination.change(k, 0);
            let kept = self.kept[k];
            let wrench = match self.links.get(k) {
                Some(link) => {
                    let Change { turn, moment, force } = change;
                    let push = Push { turn, moment, force, close: 1.0, ..Push::default() };
                    kept.wrench + link.pass(kept.rotation, &push).0 * fraction
                }
                None => kept.wrench,
            };
            let turned = UnitQuaternion::exp(fraction * change.turn);
            self.nodes[k] = Node {
                rotation: (kept.rotation * turned).renormalized(),
                moment: kept.moment + fraction * change.moment,
                force: kept.force + fraction * change.force,
                wrench,
            };
        }
        debug_assert_eq!(self.nodes.len(), task.frame.spans.len() + 1);
    }

    /// Links and elimination of the kept nodes, after a step that was too long.
    fn restore_links(&mut self, task: &Task<'_>) {
        self.nodes.clone_from(&self.kept);
        // It was possible before, and is again.
        if self.shoot(task).is_ok() {
            self.eliminate(task, 0);
        }
    }

    /// `∂ℓ/∂τ` of the groups, from a closed chain.
    fn differentiate(&mut self, task: &Task<'_>) -> bool {
        let count = task.group_count;
        if !self.eliminate(task, count) {
            return false;
        }
        self.length_by_tension.clear();
        self.length_by_tension.resize(count * count, 0.0);
        for (k, span) in task.frame.spans.iter().enumerate() {
            let link = self.links[k];
            let rotation = self.nodes[k].rotation;
            let cables = span.passages.len();
            let rows = &self.rows[9 * span.first..9 * (span.first + cables)];
            for j in 0..count {
                let Change { turn, moment, force } = self.elimination.change(k, j);
                let push = Push { turn, moment, force, ..self.tug(task, k, j) };
                let change = link.pass(rotation, &push).0;
                for i in 0..cables {
                    let by = |c: usize| rows[c * cables + i];
                    let along: f64 = (0..3)
                        .map(|c| {
                            by(c) * change.linear[c]
                                + by(3 + c) * change.angular[c]
                                + by(6 + c) * turn[c]
                        })
                        .sum();
                    self.length_by_tension[task.groups[span.first + i] * count + j] += along;
                }
            }
        }
        true
    }
}

fn folded(gone: Vanished, span: &Span) -> Fault {
    Fault { kind: SectionFault::Folded { cable: gone.cable }, arc_length: span.start }
}
