//! Stability of an equilibrium under dead loads.
//!
//! With forces `F(s)` known, the energy is a functional of the rotations alone:
//! `E[R] = ∫ Ψ(s, u, RᵀF) ds`, `Ψ = min_v (½‖ξ − ξ*‖²_K + Σ τᵢ‖pᵢ′‖ − RᵀF·v)`. Along
//! `R exp(ε η̂)` with `η(0) = 0` its second derivative is
//!
//! ```text
//! E″ = ∫ δuᵀ S δu + 2 δuᵀ(BᵀA⁻¹)δN − δNᵀA⁻¹δN − M·(η × δu) − v·(η × (η × N)) ds      (8)
//!      δu = η′ + u × η,   δN = N × η
//! ```
//!
//! with the blocks `A`, `B`, `S` of [`crate::section`]. Reported is the least value of
//! `E″ / ∫ δuᵀ K_bt δu ds`, with the reduced stiffness of the bare section for `K_bt` where bending
//! is coupled with shear or extension: 1 for the bare rod without load, 0 at the buckling load,
//! negative beyond it. The fields `R η` are piecewise quadratic on the steps of the grid.
//!
//! A cable that is held at its length admits only such fields as leave it that long, or, where it
//! is elastic, adds its stiffness. With `bᵢ = ∂ℓᵢ/∂η`, `Dᵢⱼ = ∂ℓᵢ/∂τⱼ` at fixed rotations and `C`
//! the cables' own compliances, the number of negative eigenvalues among those fields is
//!
//! ```text
//! n₋(K − λM) + n₋(D − C − bᵀ(K − λM)⁻¹b) − p      p: the cables held       (11)
//! ```
//!
//! by Haynsworth's formula, taken twice on the matrix bordered by `b`.
//!
//! A cable at its commanded length without tension is *idle*. It admits only fields that do not make it
//! longer. Where the cables that are taut or idle have a state of self-stress in which every tension of
//! an idle cable is positive, such a field cannot make it shorter either ([`SelfStress`]): that idle cable is
//! held like a taut one. Any other idle cable is taken as slack.
//!
//! A dead moment `m` has no potential: its tangent has the skew part `½ m·(η₁ × η₂)`, which (8) leaves out.
//! Bounded by `±½|m||η|²` across `m`, it decides whether there is a verdict ([`Stability::verdict`]).

use whipcord_numerics::{Mat3, Vec3, symmetric_eigenvalues};

use super::sensitivity::work;
use crate::solution::{Diagnostics, NoStability, Verdict};
use crate::statics::command::Command;
use crate::statics::eigenvalue::{
    FAR, INSENSITIVE, NEUTRAL, REGULARISATION, TOLERANCE, bisect, falling_zero, plausible,
};
use crate::statics::grid::Grid;
use crate::statics::loads::AppliedLoads;
use crate::statics::options::StabilityAnalysis;
use crate::statics::quadratic_form::{
    Element, SLOPES, Sample, WEIGHTS, across, element, pivot, symmetric,
};
use crate::statics::runge_kutta::SAMPLED_NODES;
use crate::statics::self_stress::{SelfStress, is_idle};

/// Memory of the eigenvalue computation.
#[derive(Clone, Debug, Default)]
pub(super) struct Stability {
    elements: Vec<Element>,
    locked: Vec<Locked>,
    /// `bᵢ` of each element on (start, middle, end), locked cable by locked cable.
    borders: Vec<[Vec3; 3]>,
    /// `D − C` by rows.
    corner: Vec<f64>,
    schur: Vec<f64>,
    self_stress: SelfStress,
    /// Of the locked cables, what the part before a step leaves of their borders at its start, and at its end.
    near: Vec<Vec3>,
    next: Vec<Vec3>,
}

/// A cable held at its length.
#[derive(Clone, Copy, Debug)]
struct Locked {
    /// Its place in the order of the grid.
    cable: usize,
    /// Its own, in m/N.
    compliance: f64,
    /// Whether it is at its length without tension.
    idle: bool,
}

/// The equilibrium whose stability is asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equilibrium<'a> {
    pub grid: &'a Grid,
    /// Three to each step of the grid.
    pub samples: &'a [Sample],
    /// In the order of the grid, as tensions and lengths.
    pub commands: &'a [Command],
    pub tensions: &'a [f64],
    /// In m.
    pub lengths: &'a [f64],
    pub applied: &'a AppliedLoads,
    /// Factor on all loads.
    pub load: f64,
}

impl Stability {
    /// The least eigenvalue with the cables that are held at their lengths, or why there is none.
    ///
    /// Under dead moments it is that of the symmetric part of the tangent. It counts where the skew part
    /// cannot matter: where the equilibrium stays stable with `½|m||η|²` taken off, or where adding or taking
    /// off as much changes nothing, because the section that bears the moment cannot turn.
    fn least_eigenvalue(&mut self, at: &Equilibrium<'_>) -> Result<f64, NoStability> {
        self.assemble(at);
        self.lock(at);
        let least = self.least()?;
        if !at.applied.any_dead_moment() {
            return Ok(least);
        }
        self.add_moments(at, -0.5);
        if least > 0.0 && !self.has_negative_direction(-Diagnostics::NEUTRAL) {
            return Ok(least);
        }
        let with_less = self.least()?;
        self.add_moments(at, 1.0);
        let spread = self.least()? - with_less;
        if spread <= INSENSITIVE * (1.0 + least.abs()) {
            Ok(least)
        } else {
            Err(NoStability::DeadMoments)
        }
    }

    /// Whether the equilibrium is stable, or why that is not known. Its least eigenvalue is computed where it is asked
    /// for, and where it decides.
    pub fn verdict(
        &mut self,
        at: &Equilibrium<'_>,
        analysis: StabilityAnalysis,
    ) -> Result<Verdict, NoStability> {
        if analysis == StabilityAnalysis::Verdict && self.is_clearly_stable(at) {
            return Ok(Verdict::STABLE);
        }
        self.least_eigenvalue(at).map(Verdict::of_eigenvalue)
    }

    /// Whether it is not negative.
    pub fn is_stable(&mut self, at: &Equilibrium<'_>) -> bool {
        self.unstable_directions(at) == 0
    }

    /// Whether it is no less than [`Diagnostics::NEAR_CRITICAL`], whatever the skew part of dead moments does.
    fn is_clearly_stable(&mut self, at: &Equilibrium<'_>) -> bool {
        const BOUND: f64 = Diagnostics::NEAR_CRITICAL;
        self.assemble(at);
        let has_moments = at.applied.any_dead_moment();
        if !has_moments && !self.is_indefinite(BOUND) {
            return true;
        }
        self.lock(at);
        if has_moments {
            self.add_moments(at, -0.5);
        }
        !self.has_negative_direction(BOUND)
    }

    /// The number of directions in which the robot leaves the equilibrium.
    pub fn unstable_directions(&mut self, at: &Equilibrium<'_>) -> usize {
        self.assemble(at);
        if !self.is_indefinite(-NEUTRAL) {
            return 0;
        }
        self.lock(at);
        let negative = self.negative_directions(-NEUTRAL);
        if self.locked.is_empty() { negative.max(1) } else { negative }
    }

    /// The least eigenvalue with the cables that are locked.
    fn least(&mut self) -> Result<f64, NoStability> {
        let free = falling_zero(0.0, 1.0, |shift| self.least_of_tip(shift));
        let least = if self.locked.is_empty() || !free.is_finite() {
            free
        } else {
            // Constraints only raise it.
            let margin = TOLERANCE * (1.0 + free.abs());
            bisect(free - margin, free + 1.0, |shift| self.negative_directions(shift) > 0)
        };
        plausible(least, self.elements.iter())
    }

    fn assemble(&mut self, at: &Equilibrium<'_>) {
        let Equilibrium { grid, samples, .. } = *at;
        self.elements.clear();
        for (k, triple) in samples.chunks_exact(3).enumerate() {
            let bending =
                |j: usize| grid.shooting.at(k, SAMPLED_NODES[j], 0).0.section.bending_stiffness();
            self.elements.push(element(grid.steps[k].length, triple, bending));
        }
    }

    /// Adds `f |m||η|²` across the dead moments `m` to the energy.
    fn add_moments(&mut self, at: &Equilibrium<'_>, f: f64) {
        for (k, element) in self.elements.iter_mut().enumerate() {
            let mut add = |q: usize, moment: Vec3| {
                element.energy[q][q] += across(at.load * moment) * f;
            };
            add(2, at.applied.moment(k + 1));
            if let Some(line) = at.applied.line(k) {
                for (q, weight) in WEIGHTS.into_iter().enumerate() {
                    add(q, weight * at.grid.steps[k].length * line.moment(0.5 * q as f64));
                }
            }
        }
    }

    /// Finds the locked cables, and `b` and `D − C` of eq. (11).
    fn lock(&mut self, at: &Equilibrium<'_>) {
        self.locked.clear();
        let end = at.grid.steps.last().map_or(0.0, |step| step.start + step.length);
        let cables = at.commands.iter().zip(at.tensions).zip(at.lengths).enumerate();
        for (cable, ((command, &tension), &length)) in cables {
            if let Command::Length { compliance, .. } = *command {
                let slack = command.slackness(tension, length);
                if tension > 0.0 {
                    self.locked.push(Locked { cable, compliance, idle: false });
                } else if is_idle(compliance, slack, end) {
                    self.locked.push(Locked { cable, compliance, idle: true });
                }
            }
        }
        if !self.locked.iter().any(|locked| locked.idle) {
            self.border(at);
            return;
        }
        self.border(at);
        let mut shift = -1.0;
        while self.is_indefinite(shift) && shift > -FAR {
            shift *= 4.0;
        }
        self.eliminate(shift);
        let Self { locked, schur, self_stress, .. } = self;
        let held = self_stress.held(schur, locked.iter().map(|locked| locked.idle));
        if !held.iter().all(|&held| held) {
            let mut held = held.iter();
            locked.retain(|_| held.next() == Some(&true));
            self.border(at);
        }
    }

    /// `b` and `D − C` of eq. (11) of the locked cables.
    fn border(&mut self, at: &Equilibrium<'_>) {
        let Equilibrium { grid, samples, .. } = *at;
        let p = self.locked.len();
        self.borders.clear();
        self.corner.clear();
        self.corner.resize(p * p, 0.0);
        for (k, triple) in samples.chunks_exact(3).enumerate() {
            let step = grid.steps[k];
            let first = self.borders.len();
            self.borders.resize(first + p, [Vec3::ZERO; 3]);
            for (q, sample) in triple.iter().enumerate() {
                let (_, crossings) = grid.shooting.at(k, SAMPLED_NODES[q], step.active);
                let weight = WEIGHTS[q] * step.length;
                let (compliance, coupling) = sample.tangent.force_compliance();
                let frame = sample.rotation.to_matrix();
                let push = Mat3::skew(sample.wrench.linear);
                for (i, locked) in self.locked.iter().enumerate() {
                    let Some(crossing) = crossings.get(locked.cable) else { continue };
                    let pull = crossing.pull(&sample.strain).0;
                    // δℓ = ∫ t·δv + (r × t)·δu with δv = A⁻¹δN − A⁻¹B δu.
                    let by_strain = coupling.transpose_mul(pull.linear) + pull.angular;
                    let relaxed = compliance * pull.linear;
                    let border = &mut self.borders[first + i];
                    for (j, border) in border.iter_mut().enumerate() {
                        *border += frame * by_strain * (weight * SLOPES[q][j] / step.length);
                    }
                    border[q] += frame * push.transpose_mul(relaxed) * weight;
                    for (j, other) in self.locked.iter().enumerate() {
                        if let Some(other) = crossings.get(other.cable) {
                            let along = other.pull(&sample.strain).0.linear;
                            self.corner[i * p + j] -= weight * along.dot(relaxed);
                        }
                    }
                }
            }
        }
        let scale = self.own_compliance(grid, samples);
        for (i, locked) in self.locked.iter().enumerate() {
            self.corner[i * p + i] -= locked.compliance + REGULARISATION * scale;
        }
    }

    /// The greatest `∫ qᵢᵀ H⁻¹ qᵢ ds`: what a locked cable gives on a rod without load.
    fn own_compliance(&self, grid: &Grid, samples: &[Sample]) -> f64 {
        let of_cable = |locked: &Locked| -> f64 {
            (samples.iter().enumerate())
                .filter_map(|(n, sample)| {
                    let (k, q) = (n / 3, n % 3);
                    let step = grid.steps[k];
                    let (_, crossings) = grid.shooting.at(k, SAMPLED_NODES[q], step.active);
                    let pull = crossings.get(locked.cable)?.pull(&sample.strain).0;
                    Some(WEIGHTS[q] * step.length * work(&pull, &sample.tangent.solve(pull)))
                })
                .sum()
        };
        self.locked.iter().map(of_cable).fold(0.0, f64::max)
    }

    /// Whether `energy − shift · metric` has a negative direction among the fields that the locked cables admit.
    fn has_negative_direction(&mut self, shift: f64) -> bool {
        if self.locked.is_empty() {
            return self.is_indefinite(shift);
        }
        self.negative_directions(shift) > 0
    }

    /// Whether `energy − shift · metric` has a negative direction. From the clamped base no pivot is small where the robot
    /// is stable.
    fn is_indefinite(&self, shift: f64) -> bool {
        self.left_at_tip(shift).is_none_or(|tip| tip.ldlt().is_none())
    }

    /// The least eigenvalue of what is left at the tip. It falls with the shift and is concave: a Schur
    /// complement, whose poles are those of the robot held at the tip too.
    fn least_of_tip(&self, shift: f64) -> Option<f64> {
        let [least, ..] = self.left_at_tip(shift)?.symmetric_eigenvalues();
        Some(least)
    }

    /// What block elimination of `energy − shift · metric` from the clamped base to the tip leaves there;
    /// `None` where anything before it is negative already.
    fn left_at_tip(&self, shift: f64) -> Option<Mat3> {
        // What the part before a step contributes at its start.
        let mut before = Mat3::ZERO;
        for (k, element) in self.elements.iter().enumerate() {
            let block = |i: usize, j: usize| element.energy[i][j] - element.metric[i][j] * shift;
            let (from_start, from_end) = (block(1, 0), block(1, 2));
            let middle = block(1, 1).ldlt()?;
            let to_end = middle.solve_matrix(&from_end);
            let end = block(2, 2) - from_end.transpose() * to_end;
            if k == 0 {
                before = symmetric(end);
                continue;
            }
            let to_start = middle.solve_matrix(&from_start);
            let start = before + block(0, 0) - from_start.transpose() * to_start;
            let coupling = block(0, 2) - from_start.transpose() * to_end;
            let start = symmetric(start).ldlt()?;
            before = symmetric(end - coupling.transpose() * start.solve_matrix(&coupling));
        }
        Some(before)
    }

    /// The number of negative directions of `energy − shift · metric` among the fields that the
    /// locked cables admit, eq. (11): by elimination from the base to the tip through negative pivots,
    /// with the borders carried along.
    fn negative_directions(&mut self, shift: f64) -> usize {
        let negative = self.eliminate(shift);
        let p = self.locked.len();
        let of_locks = symmetric_eigenvalues(p, &mut self.schur).filter(|&x| x < 0.0).count();
        (negative + of_locks).saturating_sub(p)
    }

    /// The elimination of [`Self::negative_directions`]: how many pivots are negative; the Schur complement
    /// of the locked cables is left behind.
    fn eliminate(&mut self, shift: f64) -> usize {
        let p = self.locked.len();
        let Self { elements, borders, corner, schur, near, next, .. } = self;
        schur.clone_from(corner);
        near.clear();
        near.resize(p, Vec3::ZERO);
        let mut negative = 0;
        // What the part before a step contributes at its start.
        let mut before = Mat3::ZERO;
        for (k, element) in elements.iter().enumerate() {
            let border = &borders[k * p..(k + 1) * p];
            let block = |i: usize, j: usize| element.energy[i][j] - element.metric[i][j] * shift;
            let (middle, below) = pivot(block(1, 1));
            negative += below;
            let (to_start, to_end) = (middle * block(1, 0), middle * block(1, 2));
            let end = block(2, 2) - block(2, 1) * to_end;
            next.clear();
            next.extend(border.iter().map(|of| of[2] - to_end.transpose_mul(of[1])));
            for i in 0..p {
                let at_middle = middle * border[i][1];
                for j in 0..p {
                    schur[i * p + j] -= at_middle.dot(border[j][1]);
                }
            }
            if k == 0 {
                // The base is clamped.
                before = symmetric(end);
            } else {
                let coupling = block(0, 2) - block(0, 1) * to_end;
                let start = before + block(0, 0) - block(0, 1) * to_start;
                let (start, below) = pivot(symmetric(start));
                negative += below;
                for (near, of) in near.iter_mut().zip(border) {
                    *near += of[0] - to_start.transpose_mul(of[1]);
                }
                for i in 0..p {
                    let at_start = start * near[i];
                    for j in 0..p {
                        schur[i * p + j] -= at_start.dot(near[j]);
                    }
                    next[i] -= coupling.transpose_mul(at_start);
                }
                before = symmetric(end - coupling.transpose() * (start * coupling));
            }
            core::mem::swap(near, next);
        }
        let (tip, below) = pivot(before);
        negative += below;
        for i in 0..p {
            let at_tip = tip * near[i];
            for j in 0..p {
                schur[i * p + j] -= at_tip.dot(near[j]);
            }
        }
        negative
    }
}
