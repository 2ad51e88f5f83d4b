//! Robots on which nothing but their cables pulls: one span after the other.
//!
//! Then the total wrench is zero at every cut, and eq. (3) of [`super::joint`] holds for each span by
//! itself: Newton's method finds its `w`, from what the span before it says of it, and spans that are
//! alike are solved once. Where it does not converge the tensions are raised from nothing in steps that
//! adapt.

use pulp::{Arch, Simd, WithSimd};
use whipcord_numerics::{Mat3, Pose, UnitQuaternion, Vec3};

use super::anchors::{Anchors, ChordChange};
use super::between_disks::Span;
use super::chain::Chain;
use super::chord;
use super::chord::Chord;
use super::layout::{Frame, Mesh};
use super::repeated_spans::RepeatedSpan;
use super::span::{self, Answer, Factors, Tangent, Taut, Vanished};
use super::unloaded_span;
use super::variation::Sample;
use crate::section::Fault;
use crate::section::{BodyWrench, SectionFault};
use crate::statics::passages::{Anchor, Passage};

/// The answer, and memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Unloaded {
    /// Wrench in the rod at the start of each span, in the frame of its disk.
    pub wrenches: Vec<BodyWrench>,
    /// Poses at the ends of all steps, relative to the disk before.
    pub poses: Vec<Pose>,
    /// Of all passages.
    pub chords: Vec<Chord>,
    /// `∂ℓᵢ/∂τⱼ` of the passages of each span by rows, span after span.
    pub length_by_tension: Vec<f64>,
    /// Where those of each span begin.
    blocks: Vec<usize>,
    /// What eq. (3) of each span was last factored to; nothing of a span that follows its twin.
    tangents: Vec<Option<Tangent>>,
    /// Changes of the chords by the unknowns of their span, of which there are up to six, span after span.
    rows: Vec<f64>,
    /// Tensions of the last sweep, and `∂w/∂τ` of each passage from the last sweep with derivatives.
    tensions: Vec<f64>,
    by_tension: Vec<BodyWrench>,
    samples: Vec<Sample>,
    /// What tensions change of cables that are anchored between two disks.
    of_anchors: OfAnchors,
    /// Newton iterations of all spans.
    pub iterations: usize,
    /// Of the tensions: what the span bore that was last led there from none.
    pub reached: f64,
}

/// What the tensions of cables that are anchored between two disks change at the same wrench in the rod.
#[derive(Clone, Debug, Default)]
struct OfAnchors {
    /// Of the share of the other cables in eq. (3), by anchor.
    pulls: Vec<BodyWrench>,
    /// Of the chords, see [`Span::anchor_rows`].
    rows: Vec<f64>,
    /// Of the chords of the anchors of the span at hand, by its unknowns.
    changes: Vec<ChordChange>,
}

/// What a sweep starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum From {
    /// From nothing.
    Nothing,
    /// From the answer of the last sweep, and what it said of other tensions.
    Neighbour,
    /// From that answer and its linearisation: the mesh is finer, the tensions nearly the same.
    Coarser,
}

/// How a span is solved.
#[derive(Clone, Copy)]
struct Guess {
    wrench: BodyWrench,
    /// Whether the linearisation that is kept of the span is near enough.
    linearised: bool,
}

/// A step of `w` this small, relative to its scale, leaves an error of its square.
const STEP_TOLERANCE: f64 = 1e-8;
const MAX_ITERATIONS: usize = 25;
/// A step of `w` this small changes the linearisation so little that it is kept; that of the lengths
/// has to be nearer.
const NEAR: f64 = 1e-2;
const NEAR_FOR_DERIVATIVES: f64 = 1e-3;
/// A kept linearisation that leaves more than this of the step before is made anew.
const SLOW: f64 = 0.3;
/// A span whose cables have so many times the lever of those before it is not told by it.
const MOST_STRETCH: f64 = 3.0;
/// A step of `w` so small leaves the span as it was last integrated.
const NO_STEP: f64 = 1e-13;
/// The tensions are raised by at least this fraction, or the span folds.
const LEAST_STEP: f64 = 1.0 / 1024.0;

enum Stop {
    Vanished(usize),
    Diverged,
}

impl core::convert::From<Vanished> for Stop {
    fn from(at: Vanished) -> Self {
        Self::Vanished(at.cable)
    }
}

/// [`Unloaded::sweep`] with the instructions that the processor has, to the same bits.
struct Sweep<'a> {
    unloaded: &'a mut Unloaded,
    frame: &'a Frame,
    mesh: &'a Mesh,
    tensions: &'a [f64],
    from: From,
    derivatives: bool,
}

impl WithSimd for Sweep<'_> {
    type Output = Result<(), Fault>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { unloaded, frame, mesh, tensions, from, derivatives } = self;
        unloaded.sweep_with(frame, mesh, tensions, from, derivatives)
    }
}

impl Unloaded {
    /// Solves all spans for the tensions of all passages.
    pub fn sweep(
        &mut self,
        frame: &Frame,
        mesh: &Mesh,
        tensions: &[f64],
        from: From,
        derivatives: bool,
    ) -> Result<(), Fault> {
        Arch::new().dispatch(Sweep { unloaded: self, frame, mesh, tensions, from, derivatives })
    }

    #[inline(always)]
    fn sweep_with(
        &mut self,
        frame: &Frame,
        mesh: &Mesh,
        tensions: &[f64],
        from: From,
        derivatives: bool,
    ) -> Result<(), Fault> {
        let count = frame.spans.len();
        let from = if self.tangents.len() == count { from } else { From::Nothing };
        if from == From::Neighbour && self.by_tension.len() == frame.passages {
            self.foresee(frame, tensions);
        }
        self.wrenches.resize(count, BodyWrench::default());
        self.tangents.resize(count, None);
        self.poses.resize(mesh.grid.len(), Pose::IDENTITY);
        self.chords.resize(frame.passages, Chord::default());
        self.rows.resize(6 * frame.passages, 0.0);
        self.of_anchors.pulls.resize(mesh.anchors.len(), BodyWrench::default());
        self.of_anchors.rows.resize(frame.anchor_rows, 0.0);
        self.by_tension.clear();
        self.length_by_tension.clear();
        self.blocks.clear();
        self.iterations = 0;
        for (k, span) in frame.spans.iter().enumerate() {
            let pulls = |span: &Span| &tensions[span.first..span.first + span.passages.len()];
            let pulled = pulls(span);
            self.blocks.push(self.length_by_tension.len());
            if let Some(repeated) = &mesh.repeated_spans[k]
                && pulls(&frame.spans[repeated.of]) == pulled
            {
                self.follow(frame, mesh, k, repeated, derivatives);
                continue;
            }
            let guess = if from == From::Nothing {
                Guess { wrench: self.foretell(frame, k, tensions), linearised: false }
            } else {
                Guess { wrench: self.wrenches[k], linearised: from == From::Coarser }
            };
            let solved = self.solve(frame, mesh, k, pulled, guess, derivatives);
            let solved = match solved {
                Err(_) => self.raise(frame, mesh, k, pulled, derivatives),
                done => done,
            };
            if let Err(stop) = solved {
                self.tangents.clear();
                let kind = match stop {
                    Stop::Vanished(cable) => SectionFault::Folded { cable },
                    Stop::Diverged => self.folding(span, pulled),
                };
                return Err(Fault { kind, arc_length: span.start });
            }
        }
        self.tensions.clear();
        self.tensions.extend_from_slice(tensions);
        Ok(())
    }

    /// The answer of a span that is an earlier one, turned, under the same tensions.
    #[inline(always)]
    fn follow(
        &mut self,
        frame: &Frame,
        mesh: &Mesh,
        k: usize,
        repeated: &RepeatedSpan,
        derivatives: bool,
    ) {
        let RepeatedSpan { of, turn } = *repeated;
        let (span, first) = (&frame.spans[k], &frame.spans[of]);
        let matrix = turn.to_matrix();
        let turned =
            |w: BodyWrench| BodyWrench { linear: matrix * w.linear, angular: matrix * w.angular };
        self.wrenches[k] = turned(self.wrenches[of]);
        self.tangents[k] = None;
        for (from, to) in mesh.spans[of].clone().zip(mesh.spans[k].clone()) {
            let Pose { position, rotation } = self.poses[from];
            let rotation = UnitQuaternion { w: rotation.w, v: matrix * rotation.v };
            self.poses[to] = Pose { position: matrix * position, rotation };
        }
        let cables = span.passages.len();
        for i in 0..cables {
            let Chord { along, length } = self.chords[first.first + i];
            self.chords[span.first + i] = Chord { along: matrix * along, length };
            if derivatives {
                self.by_tension.push(turned(self.by_tension[first.first + i]));
            }
        }
        if derivatives {
            let block = self.blocks[of];
            self.length_by_tension.extend_from_within(block..block + cables * cables);
        }
    }

    /// The wrench in a span as that before it has it: what the cables exert on the rod at rest, and
    /// what it differs from that turned and stretched as the moment of the cables does.
    #[inline(always)]
    fn foretell(&self, frame: &Frame, k: usize, tensions: &[f64]) -> BodyWrench {
        let at_rest = |k: usize| {
            let span = &frame.spans[k];
            let (mut pull, mut lever) = (BodyWrench::default(), Vec3::ZERO);
            for (i, passage) in span.passages.iter().enumerate() {
                let (chord, tension) =
                    (&frame.rest_chords[span.first + i], tensions[span.first + i]);
                pull = pull + chord::unit_pull(passage.near, chord) * -tension;
                lever += tension * (passage.near + passage.far);
            }
            (pull, lever)
        };
        let (pull, lever) = at_rest(k);
        let Some(before) = k.checked_sub(1) else { return pull };
        let (pull_before, lever_before) = at_rest(before);
        let change = self.wrenches[before] + pull_before * -1.0;
        // The turn and stretch that take one lever to the other.
        let size = lever_before.x * lever_before.x + lever_before.y * lever_before.y;
        let along = lever_before.x * lever.x + lever_before.y * lever.y;
        let across = lever_before.x * lever.y - lever_before.y * lever.x;
        let stretch = (along * along + across * across).sqrt();
        if size == 0.0 || stretch > MOST_STRETCH * size {
            return pull;
        }
        let (cos, sin, scale) = (along / size, across / size, stretch / size);
        let turned = |a: Vec3| Vec3::new(cos * a.x - sin * a.y, sin * a.x + cos * a.y, scale * a.z);
        pull + BodyWrench { linear: turned(change.linear), angular: turned(change.angular) }
    }

    /// Takes over an answer that was found otherwise, to start the next sweep from.
    pub fn adopt(&mut self, chain: &Chain, frame: &Frame) {
        let spans = frame.spans.len();
        self.wrenches.clear();
        self.wrenches.extend(chain.nodes[..spans].iter().map(|node| node.wrench));
        self.poses.clone_from(&chain.poses);
        self.chords.clone_from(&chain.chords);
        self.tangents.clear();
        self.tangents.resize(frame.spans.len(), None);
        self.by_tension.clear();
    }

    /// Moves the wrenches along with the tensions.
    fn foresee(&mut self, frame: &Frame, tensions: &[f64]) {
        for (span, wrench) in frame.spans.iter().zip(&mut self.wrenches) {
            for p in span.first..span.first + span.passages.len() {
                *wrench = *wrench + self.by_tension[p] * (tensions[p] - self.tensions[p]);
            }
        }
    }

    /// The cable that pulls most: what folds a span without load is tension alone.
    fn folding(&self, span: &Span, tensions: &[f64]) -> SectionFault {
        let pulled = span.passages.iter().zip(tensions);
        match pulled.max_by(|a, b| a.1.total_cmp(b.1)) {
            Some((passage, &tension)) if tension > 0.0 => {
                SectionFault::Folded { cable: passage.cable }
            }
            _ => SectionFault::Diverged,
        }
    }

    /// Raises the tensions of one span from nothing.
    #[cold]
    fn raise(
        &mut self,
        frame: &Frame,
        mesh: &Mesh,
        k: usize,
        tensions: &[f64],
        derivatives: bool,
    ) -> Result<(), Stop> {
        let (mut reached, mut step) = (0.0, 0.25);
        let mut here = BodyWrench::default();
        loop {
            let next = f64::min(reached + step, 1.0);
            let part: Vec<f64> = tensions.iter().map(|t| t * next).collect();
            let guess = Guess { wrench: here, linearised: false };
            match self.solve(frame, mesh, k, &part, guess, derivatives && next >= 1.0) {
                Ok(()) if next >= 1.0 => return Ok(()),
                Ok(()) => {
                    here = self.wrenches[k];
                    reached = next;
                    step *= 1.5;
                }
                Err(stop) => {
                    step *= 0.5;
                    if step < LEAST_STEP {
                        self.reached = reached;
                        return Err(stop);
                    }
                }
            }
        }
    }

    /// Newton's method on one span.
    #[inline(always)]
    fn solve(
        &mut self,
        frame: &Frame,
        mesh: &Mesh,
        k: usize,
        tensions: &[f64],
        guess: Guess,
        derivatives: bool,
    ) -> Result<(), Stop> {
        let span = &frame.spans[k];
        let steps = mesh.spans[k].clone();
        let cables = span.passages.len();
        self.samples.resize(3 * steps.len(), Sample::default());
        let rows = &mut self.rows[6 * span.first..6 * (span.first + cables)];
        let of_anchors = &mut self.of_anchors;
        let samples = &mut self.samples;
        let anchors = Anchors { at: mesh.anchors_of(span), passages: &span.passages, tensions };
        let chords = &mut self.chords[span.first..span.first + cables];
        let poses = &mut self.poses[steps.clone()];
        let (node, _) = mesh.grid.shooting.at(steps.start, 0, 0);
        let bending = node.section.stiffness.bending;
        let length: f64 = mesh.grid.steps[steps.clone()].iter().map(|step| step.length).sum();
        let moment_scale = bending.x.max(bending.y) / length;
        let force_scale = moment_scale / length;
        let relative = |w: &BodyWrench| {
            (w.linear.max_abs() / force_scale).max(w.angular.max_abs() / moment_scale)
        };
        let mut wrench = guess.wrench;
        if let [passage] = &span.passages[..] {
            wrench = chord::along_cable(passage.near, wrench.linear);
        }
        let mut kept = if guess.linearised { self.tangents[k] } else { None };
        let near = if derivatives { NEAR_FOR_DERIVATIVES } else { NEAR };
        let mut last = f64::INFINITY;
        for _ in 0..MAX_ITERATIONS {
            self.iterations += 1;
            let anchored = (&anchors, &mut *chords);
            let (pose, _) = unloaded_span::integrate(
                &mesh.grid,
                steps.clone(),
                wrench,
                anchored,
                poses,
                samples,
            );
            span::draw(span, &pose, chords)?;
            let residual = wrench + span::pull(span, chords, tensions);
            let fresh = kept.is_none();
            let tangent = match kept {
                Some(tangent) => tangent,
                None => {
                    let at = anchors.at;
                    let taut = Taut { span, anchors: at, samples, pose, chords, tensions };
                    linearise(mesh, k, &taut, rows, of_anchors).ok_or(Stop::Diverged)?
                }
            };
            let change = tangent.solve(residual * -1.0);
            let size = relative(&change) / (1.0 + relative(&wrench));
            if !size.is_finite() {
                return Err(Stop::Diverged);
            }
            // A step far too long is shortened; Newton's method recovers.
            let fraction = if size > 1.0 { 1.0 / size } else { 1.0 };
            wrench = wrench + change * fraction;
            // Kept factors contract by the size of the step before.
            kept = (size < near).then_some(tangent);
            if size <= STEP_TOLERANCE {
                (self.wrenches[k], self.tangents[k]) = (wrench, Some(tangent));
                if size > NO_STEP {
                    let anchored = (&anchors, &mut *chords);
                    let (pose, _) = unloaded_span::integrate(
                        &mesh.grid,
                        steps.clone(),
                        wrench,
                        anchored,
                        poses,
                        &mut [],
                    );
                    span::draw(span, &pose, chords)?;
                }
                if derivatives {
                    self.differentiate(span, anchors.at, &tangent);
                }
                return Ok(());
            }
            if !fresh && size > SLOW * last {
                kept = None;
            }
            last = size;
        }
        Err(Stop::Diverged)
    }

    /// `∂ℓᵢ/∂τⱼ = (∂ℓᵢ/∂w) ∂w/∂τⱼ` of one span.
    #[inline(always)]
    fn differentiate(&mut self, span: &Span, anchors: &[Anchor], tangent: &Tangent) {
        let cables = span.passages.len();
        let first = self.length_by_tension.len();
        self.length_by_tension.resize(first + cables * cables, 0.0);
        for (j, passage) in span.passages.iter().enumerate() {
            let mut pull = chord::unit_pull(passage.near, &self.chords[span.first + j]);
            let anchor = anchors.iter().position(|anchor| anchor.passage == j);
            if let Some(a) = anchor {
                pull = pull + self.of_anchors.pulls[span.anchors.start + a];
            }
            let change = tangent.solve(pull * -1.0);
            self.by_tension.push(change);
            for i in 0..cables {
                let by = |c: usize| self.rows[6 * span.first + c * cables + i];
                let mut along: f64 = (0..3).map(|c| by(c) * change.linear[c]).sum();
                if matches!(tangent, Tangent::Cables(_)) {
                    along += (0..3).map(|c| by(3 + c) * change.angular[c]).sum::<f64>();
                }
                if let Some(a) = anchor {
                    along += self.of_anchors.rows[span.anchor_rows + a * cables + i];
                }
                self.length_by_tension[first + i * cables + j] = along;
            }
        }
    }
}

/// Eq. (3) linearised where the span was last integrated; `rows` takes the changes of the chords by its
/// unknowns. `None` where it is singular.
#[inline(always)]
fn linearise(
    mesh: &Mesh,
    k: usize,
    taut: &Taut<'_>,
    rows: &mut [f64],
    of_anchors: &mut OfAnchors,
) -> Option<Tangent> {
    let (grid, steps) = (&mesh.grid, mesh.spans[k].clone());
    let (cables, anchors) = (taut.chords.len(), taut.anchors.len());
    of_anchors.changes.resize(6 * anchors, ChordChange::default());
    let changes = &mut of_anchors.changes[..];
    for a in 0..anchors {
        let [by] = unloaded_span::linearise(
            grid,
            steps.clone(),
            taut,
            &[BodyWrench::default()],
            Some(a),
            &mut changes[..anchors],
        );
        let first = taut.span.anchor_rows + a * cables;
        let row = &mut of_anchors.rows[first..first + cables];
        let answer = span::answer(taut, &by, &changes[..anchors], row);
        of_anchors.pulls[taut.span.anchors.start + a] = answer.pull;
    }
    let mut answers = [Answer::default(); 6];
    if let [Passage { near, .. }] = taut.span.passages[..] {
        let units = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| chord::along_cable(near, axis));
        let by = unloaded_span::linearise(grid, steps, taut, &units, None, changes);
        for (c, ((answer, by), row)) in
            answers.iter_mut().zip(&by).zip(rows.chunks_exact_mut(1)).enumerate()
        {
            *answer = span::answer(taut, by, &changes[c * anchors..(c + 1) * anchors], row);
        }
        let [x, y, z, ..] = answers.map(|answer| answer.pull.linear);
        let force = Mat3::from_columns(x, y, z).plus_identity().inverse()?;
        return Some(Tangent::OneCable { force, near });
    }
    let units = unloaded_span::units();
    let by = unloaded_span::linearise(grid, steps, taut, &units, None, changes);
    for (c, (answer, by)) in answers.iter_mut().zip(&by).enumerate() {
        let row = &mut rows[c * cables..(c + 1) * cables];
        *answer = span::answer(taut, by, &changes[c * anchors..(c + 1) * anchors], row);
    }
    Factors::new(&answers).map(Tangent::Cables)
}
