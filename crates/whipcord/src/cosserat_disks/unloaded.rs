//! Robots on which nothing but their cables pulls: one span after the other.
//!
//! Then the total wrench is zero at every cut, and eq. (3) of [`super::joint`] holds for each span by
//! itself: Newton's method finds its `w`, from the span before it or from nothing. Where it does not
//! converge the tensions are raised from nothing in steps that adapt.

use whipcord_numerics::Pose;

use super::joint::{self, Answer, Chord, Factors, Vanished};
use super::layout::{Frame, Mesh, Span};
use super::rod::{self, By, Sample};
use crate::cosserat::section::{BodyWrench, SectionFault};
use crate::cosserat::unloaded::Fault;
use whipcord_numerics::Vec3;

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
    /// What eq. (3) of each span was last factored to.
    tangents: Vec<Factors>,
    /// Changes of the chords by the six components of `w`, span after span.
    rows: Vec<f64>,
    /// Tensions of the last sweep, and `∂w/∂τ` of each passage from the last sweep with derivatives.
    tensions: Vec<f64>,
    by_tension: Vec<BodyWrench>,
    samples: Vec<Sample>,
    /// Newton iterations of all spans.
    pub iterations: usize,
    /// Of the tensions: what the span bore that was last led there from none.
    pub reached: f64,
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
    wrench: Option<BodyWrench>,
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
        let count = frame.spans.len();
        let from = if self.tangents.len() == count { from } else { From::Nothing };
        if from == From::Neighbour && self.by_tension.len() == frame.passages {
            self.foresee(frame, tensions);
        }
        self.wrenches.resize(count, BodyWrench::default());
        self.tangents.resize(count, Factors::default());
        self.poses.resize(mesh.grid.len(), Pose::IDENTITY);
        self.chords.resize(frame.passages, Chord::default());
        self.rows.resize(6 * frame.passages, 0.0);
        self.by_tension.clear();
        self.length_by_tension.clear();
        self.iterations = 0;
        let mut neighbour: Option<(BodyWrench, usize)> = None;
        for (k, span) in frame.spans.iter().enumerate() {
            let pulled = &tensions[span.first..span.first + span.passages.len()];
            let guess = match neighbour {
                _ if from != From::Nothing => {
                    let linearised = from == From::Coarser;
                    Guess { wrench: Some(self.wrenches[k]), linearised }
                }
                // A neighbour with the same cables is a good guess.
                Some((wrench, cables)) if cables == span.passages.len() => {
                    Guess { wrench: Some(wrench), linearised: false }
                }
                _ => Guess { wrench: None, linearised: false },
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
            neighbour = Some((self.wrenches[k], span.passages.len()));
        }
        self.tensions.clear();
        self.tensions.extend_from_slice(tensions);
        Ok(())
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
            let guess = Guess { wrench: Some(here), linearised: false };
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
        let mut wrench = guess.wrench.unwrap_or_default();
        if guess.wrench.is_none() && tensions.iter().any(|&t| t > 0.0) {
            rod::integrate(&mesh.grid, steps.clone(), wrench, None, poses, &mut []);
            joint::draw(span, &poses[poses.len() - 1], chords)?;
            wrench = joint::pull(span, chords, tensions) * -1.0;
        }
        let mut factors = guess.linearised.then(|| self.tangents[k]);
        let near = if derivatives { NEAR_FOR_DERIVATIVES } else { NEAR };
        let mut last = f64::INFINITY;
        for _ in 0..MAX_ITERATIONS {
            self.iterations += 1;
            let fresh = factors.is_none();
            let samples: &mut [Sample] = if fresh { &mut self.samples } else { &mut [] };
            let end = rod::integrate(&mesh.grid, steps.clone(), wrench, None, poses, samples);
            joint::draw(span, &end.pose, chords)?;
            let residual = wrench + joint::pull(span, chords, tensions);
            let tangent = match factors {
                Some(kept) => kept,
                None => {
                    let by =
                        answers(mesh, k, span, &self.samples, chords, tensions, &end.pose, rows);
                    Factors::new(&by).ok_or(Stop::Diverged)?
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
            factors = (size < near).then_some(tangent);
            if size <= STEP_TOLERANCE {
                (self.wrenches[k], self.tangents[k]) = (wrench, tangent);
                rod::integrate(&mesh.grid, steps.clone(), wrench, None, poses, &mut []);
                joint::draw(span, &poses[poses.len() - 1], chords)?;
                if derivatives {
                    self.differentiate(span, &tangent);
                }
                return Ok(());
            }
            if !fresh && size > SLOW * last {
                factors = None;
            }
            last = size;
        }
        Err(Stop::Diverged)
    }

    /// `∂ℓᵢ/∂τⱼ = (∂ℓᵢ/∂w) ∂w/∂τⱼ` of one span.
    fn differentiate(&mut self, span: &Span, tangent: &Factors) {
        let cables = span.passages.len();
        let first = self.length_by_tension.len();
        self.length_by_tension.resize(first + cables * cables, 0.0);
        for (j, passage) in span.passages.iter().enumerate() {
            let pull = joint::unit_pull(passage.near, &self.chords[span.first + j]);
            let change = tangent.solve(pull * -1.0);
            self.by_tension.push(change);
            for i in 0..cables {
                let by = |c: usize| self.rows[6 * span.first + c * cables + i];
                let along: f64 =
                    (0..3).map(|c| by(c) * change.linear[c] + by(3 + c) * change.angular[c]).sum();
                self.length_by_tension[first + i * cables + j] = along;
            }
        }
    }
}

/// The answers to the six components of `w`; `rows` takes those of the chords' lengths.
#[expect(clippy::too_many_arguments, reason = "a span, its state, and where the rows go")]
fn answers(
    mesh: &Mesh,
    k: usize,
    span: &Span,
    samples: &[Sample],
    chords: &[Chord],
    tensions: &[f64],
    pose: &Pose,
    rows: &mut [f64],
) -> [Answer; 6] {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let cables = span.passages.len();
    core::array::from_fn(|c| {
        let by = if c < 3 { By::Force(axes[c]) } else { By::Moment(axes[c - 3]) };
        let variation = rod::linearise(&mesh.grid, mesh.spans[k].clone(), samples, None, by);
        let row = &mut rows[c * cables..(c + 1) * cables];
        joint::answer(span, pose, chords, tensions, &variation, row)
    })
}
