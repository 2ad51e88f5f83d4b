//! Stability of an equilibrium under dead loads.
//!
//! The energy depends on the rotations of all cross-sections and, through the chords, on the way
//! `dₖ = pₖ₊₁ − pₖ` from disk to disk. With a multiplier for `dₖ = ∫ R v ds`, which at equilibrium is
//! what the cables pull with, its second variation is that of the rod under the forces it bears
//! itself, eq. (8) of the model with continuous cables, bordered by a force `ν` in every span, and
//! the second variation of the chords:
//!
//! ```text
//! E″ = Σₖ ∫ (8) with δN = N × η + Rᵀν  −  2 ν·R(η × v) ds + 2 ν·δd
//!        + Σ τᵢ (δcᵢᵀ (I − tᵢtᵢᵀ) δcᵢ/ℓᵢ + tᵢ·δ²cᵢ)                                             (7)
//! ```
//!
//! Each `ν` adds three negative directions; what is negative beyond them is a way to leave. An anchor between two disks divides
//! its span: the way from the near disk to the anchor has a `ν` of its own. Reported
//! is the least value of `E″ / ∫ δuᵀ K_bt δu ds`, as in that model.
//!
//! A taut cable that is held at its length, or a piece of one that sticks in its holes, admits only
//! what leaves it that long: the form is bordered by `b = ∂ℓ/∂(η, d)`, and its negative directions are
//! counted by eq. (11) of that model with `D = 0`, since a chord knows the tension only through the
//! shape.

use whipcord_numerics::{Mat3, UnitQuaternion, Vec3, symmetric_eigenvalues};

use super::between_disks::Span;
use super::chord::Chord;
use super::layout::{Frame, Mesh};
use super::span_form::{Border, Carried, Form, Step, Tie, put, step};
use super::variation::Sample;
use crate::solution::{Diagnostics, NoStability};
use crate::statics::eigenvalue::{
    FAR, INSENSITIVE, REGULARISATION, bisect, falling_zero, plausible,
};
use crate::statics::loads::AppliedLoads;
use crate::statics::quadratic_form::{WEIGHTS, across, negative_eigenvalues, pivot, symmetric};
use crate::statics::self_stress::SelfStress;

/// Quadratic forms of the steps and spans, and memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Stability {
    steps: Vec<Step>,
    ties: Vec<Tie>,
    /// Those of each span.
    of_span: Vec<core::ops::Range<usize>>,
    borders: Vec<Border>,
    locked: Locked,
    schur: Vec<f64>,
    carried: Vec<Vec3>,
    within: Vec<Carried>,
    self_stress: SelfStress,
}

/// What is asked whether it is stable.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equilibrium<'a> {
    pub frame: &'a Frame,
    pub mesh: &'a Mesh,
    /// Three to each step of the mesh.
    pub samples: &'a [Sample],
    /// Of all passages.
    pub chords: &'a [Chord],
    pub tensions: &'a [f64],
    /// What 1 N shortens a cable by, in m, in order of magnitude.
    pub scale: f64,
    /// Where dead moments act: the loads on this mesh, and how the disks are turned.
    pub moments: Option<(&'a AppliedLoads, &'a [UnitQuaternion])>,
}

/// What is held at its length: whole cables, or pieces of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Locked {
    /// Which lock each whole cable is.
    pub of_cable: Vec<Option<usize>>,
    /// Which lock each passage belongs to.
    pub of_passage: Vec<Option<usize>>,
    /// What a tension of 1 N adds to each, in m.
    pub compliances: Vec<f64>,
    /// Whether each is at its length without tension.
    pub idle: Vec<bool>,
}

impl Locked {
    /// Holds nothing, in the memory that it has, of so many cables.
    pub fn clear(&mut self, cables: usize) {
        self.of_passage.clear();
        self.compliances.clear();
        self.idle.clear();
        self.of_cable.clear();
        self.of_cable.resize(cables, None);
    }

    fn copy_from(&mut self, other: &Self) {
        self.of_passage.clone_from(&other.of_passage);
        self.compliances.clone_from(&other.compliances);
        self.idle.clone_from(&other.idle);
    }
}

impl Stability {
    /// The least eigenvalue with these cables or pieces held, or why there is none; under dead moments as in
    /// the model with continuous cables.
    pub fn least_eigenvalue(
        &mut self,
        at: &Equilibrium<'_>,
        locked: &Locked,
    ) -> Result<f64, NoStability> {
        self.assemble(at, locked).ok_or(NoStability::Undetermined)?;
        let spans = &at.mesh.spans;
        let least = self.least(spans)?;
        if at.moments.is_none() {
            return Ok(least);
        }
        self.add_moments(at, -0.5);
        if least > 0.0 && self.negative_directions(spans, -Diagnostics::NEUTRAL) == 0 {
            return Ok(least);
        }
        let with_less = self.least(spans)?;
        self.add_moments(at, 1.0);
        let spread = self.least(spans)? - with_less;
        if spread <= INSENSITIVE * (1.0 + least.abs()) {
            Ok(least)
        } else {
            Err(NoStability::DeadMoments)
        }
    }

    fn least(&mut self, spans: &[core::ops::Range<usize>]) -> Result<f64, NoStability> {
        let free = falling_zero(0.0, 1.0, |shift| self.least_of_base(spans, shift));
        let least = if self.locked.compliances.is_empty() || !free.is_finite() {
            free
        } else {
            // What is held only raises it.
            let margin = 1e-7 * (1.0 + free.abs());
            let mut negative = |shift: f64| self.negative_directions(spans, shift) > 0;
            bisect(free - margin, free + 1.0, &mut negative)
        };
        plausible(least, self.steps.iter().map(|step| &step.rod))
    }

    /// Whether no eigenvalue is less than a bound.
    pub fn is_above(&mut self, bound: f64, at: &Equilibrium<'_>, locked: &Locked) -> Option<bool> {
        Some(self.below(bound, at, locked)? == 0)
    }

    /// The number of eigenvalues less than a bound.
    pub fn below(&mut self, bound: f64, at: &Equilibrium<'_>, locked: &Locked) -> Option<usize> {
        self.assemble(at, locked)?;
        Some(self.negative_directions(&at.mesh.spans, bound))
    }

    /// Whether no eigenvalue is less than [`Diagnostics::NEAR_CRITICAL`], whatever the skew part of dead moments does.
    pub fn is_clearly_stable(&mut self, at: &Equilibrium<'_>, locked: &Locked) -> Option<bool> {
        self.assemble(at, locked)?;
        self.add_moments(at, -0.5);
        Some(self.negative_directions(&at.mesh.spans, Diagnostics::NEAR_CRITICAL) == 0)
    }

    /// Adds `f |m||η|²` across the dead moments `m` to the energy.
    fn add_moments(&mut self, at: &Equilibrium<'_>, f: f64) {
        let Some((applied, disks)) = at.moments else { return };
        for (steps, disk) in at.mesh.spans.iter().zip(disks) {
            for k in steps.clone() {
                let rod = &mut self.steps[k].rod;
                let mut add = |q: usize, moment: Vec3| {
                    rod.energy[q][q] += across(disk.conjugate().rotate(moment)) * f;
                };
                add(2, applied.moment(k + 1));
                if let Some(line) = applied.line(k) {
                    let h = at.mesh.grid.steps[k].length;
                    for (q, weight) in WEIGHTS.into_iter().enumerate() {
                        add(q, weight * h * line.moment(0.5 * q as f64));
                    }
                }
            }
        }
    }

    /// The forms of steps and spans, and what is held.
    fn assemble(&mut self, at: &Equilibrium<'_>, locked: &Locked) -> Option<()> {
        let Equilibrium { mesh, samples, scale, .. } = *at;
        self.steps.clear();
        for (k, triple) in samples.chunks_exact(3).enumerate() {
            self.steps.push(step(mesh, k, triple)?);
        }
        self.locked.copy_from(locked);
        for compliance in &mut self.locked.compliances {
            *compliance += REGULARISATION * scale;
        }
        self.tie(at)?;
        if self.locked.idle.iter().any(|&idle| idle) {
            self.release(at)?;
        }
        Some(())
    }

    /// Takes what is idle and held by nothing else out of what is held.
    fn release(&mut self, at: &Equilibrium<'_>) -> Option<()> {
        let spans = &at.mesh.spans;
        let mut shift = -1.0;
        while self.least_of_base(spans, shift).is_none_or(|least| least < 0.0) && shift > -FAR {
            shift *= 4.0;
        }
        self.eliminate(spans, shift, true);
        let Self { schur, locked, self_stress, .. } = self;
        let held = self_stress.held(schur, locked.idle.iter().copied());
        if held.iter().all(|&held| held) {
            return Some(());
        }
        let before = |lock: usize| held[..lock].iter().filter(|&&held| held).count();
        for lock in &mut locked.of_passage {
            *lock = lock.filter(|&lock| held[lock]).map(before);
        }
        let mut keep = held.iter();
        locked.compliances.retain(|_| keep.next() == Some(&true));
        let mut keep = held.iter();
        locked.idle.retain(|_| keep.next() == Some(&true));
        self.tie(at)
    }

    /// The forms of the chords of all spans.
    fn tie(&mut self, at: &Equilibrium<'_>) -> Option<()> {
        let Equilibrium { frame, mesh, .. } = *at;
        let locked = &self.locked;
        self.ties.clear();
        self.of_span.clear();
        self.borders.clear();
        for (k, span) in frame.spans.iter().enumerate() {
            let first = self.ties.len();
            let mut anchors = mesh.anchors_of(span);
            while let Some(next) = anchors.first() {
                let here = anchors.iter().take_while(|anchor| anchor.node == next.node).count();
                let mut tie = Tie { node: next.node, ..Tie::default() };
                let of_place = anchors[..here].iter().map(|anchor| anchor.passage);
                tie.tie(at, locked, span, of_place, &mut self.borders)?;
                self.ties.push(tie);
                anchors = &anchors[here..];
            }
            let mut tie = Tie { node: mesh.spans[k].end, ..Tie::default() };
            let inside = |&i: &usize| span.passages[i].is_anchored_inside();
            let through = (0..span.passages.len()).filter(|i| !inside(i));
            tie.tie(at, locked, span, through, &mut self.borders)?;
            self.ties.push(tie);
            self.of_span.push(first..self.ties.len());
        }
        Some(())
    }

    /// The least eigenvalue of the last pivot, that of the first disk beyond the base, for `E″` less
    /// the shifted metric; `None` where anything before it is negative already. It falls with the shift
    /// and is concave: a Schur complement, whose poles are those of the robot held at that disk too.
    fn least_of_base(&mut self, spans: &[core::ops::Range<usize>], shift: f64) -> Option<f64> {
        let (before, last) = self.eliminate(spans, shift, false);
        let least = last.symmetric_eigenvalues().into_iter().fold(f64::INFINITY, f64::min);
        (before <= 3 * self.ties.len()).then_some(least)
    }

    /// The number of negative directions of `E″` less the shifted metric among those admitted.
    fn negative_directions(&mut self, spans: &[core::ops::Range<usize>], shift: f64) -> usize {
        let (before, last) = self.eliminate(spans, shift, true);
        let held = self.locked.compliances.len();
        let of_locks = symmetric_eigenvalues(held, &mut self.schur).filter(|&x| x < 0.0).count();
        let negative = before + negative_eigenvalues(&last) + of_locks;
        negative.saturating_sub(3 * self.ties.len() + held)
    }

    /// Block elimination from the tip to the base: how many directions are negative before the last
    /// pivot, and that pivot. With `locks` the Schur complement of what is held is left behind.
    fn eliminate(
        &mut self,
        spans: &[core::ops::Range<usize>],
        shift: f64,
        locks: bool,
    ) -> (usize, Mat3) {
        let Self {
            steps: of_steps, ties, of_span, borders, locked, schur, carried, within, ..
        } = self;
        let held = if locks { locked.compliances.len() } else { 0 };
        schur.clear();
        schur.resize(held * held, 0.0);
        carried.clear();
        carried.resize(held, Vec3::ZERO);
        for i in 0..held {
            schur[i * held + i] = -locked.compliances[i];
        }
        let mut negative = 0;
        let mut beyond = Mat3::ZERO;
        let mut last = Mat3::ZERO;
        for (k, steps) in spans.iter().enumerate().rev() {
            within.clear();
            within.resize(held, Carried::default());
            let mut form: Option<Form> = None;
            let mut start = steps.start;
            let [inside @ .., far] = &ties[of_span[k].clone()] else { continue };
            for tie in inside {
                let of_steps = &of_steps[start..tie.node];
                let Some(here) = Form::along(form, of_steps, shift, (within, schur), &mut negative)
                else {
                    continue;
                };
                start = tie.node;
                put(tie, borders, within);
                let tied = here.tie(tie);
                negative += tied.pair.negative;
                let force = here.force;
                let by_force = force * tied.pair.force;
                let by_way = force * tied.pair.across;
                tied.eliminate(within, schur);
                for carried in within.iter_mut() {
                    carried.force -= by_force * carried.force + by_way * carried.way;
                    carried.way = Vec3::ZERO;
                }
                form = Some(Form {
                    near: tied.near,
                    here: tied.here,
                    near_here: tied.near_here,
                    force: symmetric(force - by_force * force),
                    near_force: here.near_force - tied.near_force * force,
                    here_force: here.here_force - tied.here_force * force,
                });
            }
            let of_steps = &of_steps[start..steps.end];
            let Some(form) = Form::along(form, of_steps, shift, (within, schur), &mut negative)
            else {
                continue;
            };
            put(far, borders, within);
            let tied = form.tie(far);
            negative += tied.pair.negative;
            tied.eliminate(within, schur);
            let turn = far.turn;
            last = symmetric(tied.here + turn * beyond * turn.transpose());
            let (end, below) = pivot(last);
            if k > 0 {
                negative += below;
            }
            beyond = symmetric(tied.near - tied.near_here * (end * tied.near_here.transpose()));
            for (carried, within) in carried.iter_mut().zip(&*within) {
                *carried = turn * *carried + within.here;
            }
            for i in 0..held {
                let at_end = end * carried[i];
                for j in 0..held {
                    schur[i * held + j] -= at_end.dot(carried[j]);
                }
            }
            for (carried, within) in carried.iter_mut().zip(&*within) {
                *carried = within.near - tied.near_here * (end * *carried);
            }
        }
        (negative, last)
    }
}

impl Tie {
    /// Adds these passages of a span, which end here.
    fn tie(
        &mut self,
        at: &Equilibrium<'_>,
        locked: &Locked,
        span: &Span,
        passages: impl Iterator<Item = usize>,
        borders: &mut Vec<Border>,
    ) -> Option<()> {
        let first = borders.len();
        // The last sample of a step stands at its end.
        let turn = at.samples.get(3 * self.node - 1)?.rotation.to_matrix();
        for i in passages {
            let (passage, p) = (&span.passages[i], span.first + i);
            self.add(passage.near, passage.far, &turn, &at.chords[p], at.tensions[p]);
            if let Some(lock) = locked.of_passage[p] {
                let t = at.chords[p].along;
                borders.push(Border {
                    lock,
                    near: t.cross(passage.near),
                    far: turn * passage.far.cross(turn.transpose_mul(t)),
                    way: t,
                });
            }
        }
        (self.borders, self.turn) = (first..borders.len(), turn);
        Some(())
    }
}
