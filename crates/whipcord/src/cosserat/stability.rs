//! Whether an equilibrium under dead loads is one the robot stays in.
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
//! with the blocks `A`, `B`, `S` of [`super::section`]. Reported is the least value of
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
//! an idle cable is positive, such a field cannot make it shorter either ([`implied`]): that idle cable is
//! held like a taut one. Any other idle cable is taken as slack.
//!
//! A dead moment `m` has no potential: its tangent has the skew part `½ m·(η₁ × η₂)`, which (8) leaves out.
//! Bounded by `±½|m||η|²` across `m`, it decides whether there is a verdict ([`Stability::verdict`]).

use whipcord_numerics::{BoundedQuadratic, Mat3, Vec3, symmetric_eigenvalues};

use super::command::Command;
use super::grid::Grid;
use super::loaded::{SAMPLED_NODES, Sample};
use super::loads::AppliedLoads;
use super::sensitivity::work;
use crate::shape::{Diagnostics, NoStability};

/// Quadratic forms of one step on (start, middle, end): energy and metric, as 3×3 blocks.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Element {
    pub energy: [[Mat3; 3]; 3],
    pub metric: [[Mat3; 3]; 3],
}

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
    quadratic: BoundedQuadratic,
    beyond: Vec<Vec3>,
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

/// An eigenvalue this close to zero counts as zero.
const NEUTRAL: f64 = Diagnostics::NEUTRAL;
/// Relative accuracy of the eigenvalue.
const TOLERANCE: f64 = 1e-8;
/// Compliance added to each locked cable, relative to what the rod gives: it decides what counts as
/// zero where more cables are taut than lengths are independent.
const REGULARISATION: f64 = 1e-9;
/// Of the backbone's length: a cable without tension that is no looser than this is at its length.
const IDLE: f64 = 1e-6;
/// An idle cable is held where the others leave no more than this part of the square of its effect.
const IMPLIED: f64 = 1e-6;
/// A taut cable may take this much less tension in a state of self-stress, each in units of its effect.
const RELEASED: f64 = -1e6;
/// Eigenvalues beyond this are not looked for.
pub(crate) const FAR: f64 = 1e12;
/// What dead moments may do to the least eigenvalue where they count as held.
pub(crate) const INSENSITIVE: f64 = 1e-6;
/// An eigenvalue greater than the greatest stiffness of the robot, relative to its metric, by this factor is
/// an artefact of rounding.
const IMPLAUSIBLE: f64 = 1e3;

impl Stability {
    /// The least eigenvalue with the cables that are held at their lengths, or why there is none.
    ///
    /// Under dead moments it is that of the symmetric part of the tangent. It counts where the skew part
    /// cannot matter: where the equilibrium stays stable with `½|m||η|²` taken off, or where adding or taking
    /// off as much changes nothing, because the section that bears the moment cannot turn.
    pub fn verdict(&mut self, at: &Equilibrium<'_>) -> Result<f64, NoStability> {
        self.assemble(at);
        self.lock(at);
        let least = self.least()?;
        if !at.applied.any_dead_moment() {
            return Ok(least);
        }
        self.add_moments(at, -0.5);
        if least > 0.0 && self.negative_directions(-Diagnostics::NEUTRAL) == 0 {
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

    /// Whether it is not negative.
    pub fn is_stable(&mut self, at: &Equilibrium<'_>) -> bool {
        self.unstable_directions(at) == 0
    }

    /// The number of directions in which the robot leaves the equilibrium.
    pub fn unstable_directions(&mut self, at: &Equilibrium<'_>) -> usize {
        self.assemble(at);
        if !self.is_indefinite(-NEUTRAL) {
            return 0;
        }
        self.lock(at);
        self.negative_directions(-NEUTRAL)
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
        let Self { locked, schur, quadratic, .. } = self;
        let idle: Vec<bool> = locked.iter().map(|locked| locked.idle).collect();
        let held = implied(schur, &idle, quadratic);
        if !held.iter().all(|&held| held) {
            let mut held = held.into_iter();
            locked.retain(|_| held.next().unwrap_or(false));
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

    /// Whether `energy − shift · metric` has a negative direction.
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
    /// locked cables admit, eq. (11): by elimination from the tip to the base through negative pivots,
    /// with the borders carried along.
    fn negative_directions(&mut self, shift: f64) -> usize {
        let negative = self.eliminate(shift);
        let p = self.locked.len();
        let of_locks = symmetric_eigenvalues(p, &mut self.schur);
        (negative + of_locks.iter().filter(|&&x| x < 0.0).count()).saturating_sub(p)
    }

    /// The elimination of [`Self::negative_directions`]: how many pivots are negative; the Schur complement
    /// of the locked cables is left behind.
    fn eliminate(&mut self, shift: f64) -> usize {
        let p = self.locked.len();
        let Self { elements, borders, corner, schur, beyond: far, next, .. } = self;
        schur.clone_from(corner);
        far.clear();
        far.resize(p, Vec3::ZERO);
        let mut negative = 0;
        let mut beyond = Mat3::ZERO;
        for (k, element) in elements.iter().enumerate().rev() {
            let border = &borders[k * p..(k + 1) * p];
            let block = |i: usize, j: usize| element.energy[i][j] - element.metric[i][j] * shift;
            let (middle, below) = pivot(block(1, 1));
            negative += below;
            let to_end = middle * block(1, 2);
            let to_start = middle * block(1, 0);
            let (end, below) = pivot(symmetric(block(2, 2) + beyond - block(2, 1) * to_end));
            negative += below;
            let coupling = block(2, 0) - block(2, 1) * to_start;
            beyond = block(0, 0) - block(0, 1) * to_start - coupling.transpose() * (end * coupling);
            beyond = symmetric(beyond);
            for (far, border) in far.iter_mut().zip(border) {
                *far += border[2] - to_end.transpose_mul(border[1]);
            }
            next.clear();
            for i in 0..p {
                let (at_middle, at_end) = (middle * border[i][1], end * far[i]);
                for j in 0..p {
                    schur[i * p + j] -= at_middle.dot(border[j][1]) + at_end.dot(far[j]);
                }
                next.push(
                    border[i][0]
                        - to_start.transpose_mul(border[i][1])
                        - coupling.transpose_mul(at_end),
                );
            }
            core::mem::swap(far, next);
        }
        negative
    }
}

/// Whether a cable without tension, this slack in m, is at its length; a cable that stretches gives way.
pub(crate) fn is_idle(compliance: f64, slack: f64, length: f64) -> bool {
    compliance == 0.0 && slack <= IDLE * length
}

/// Which cables are held at their lengths: those that are not idle, and the idle ones of which some state of
/// self-stress, with tension in idle cables only and of either sign in the others, has tension. `schur` is the Schur
/// complement of the locked cables where the form is positive: minus the products of their effects.
pub(crate) fn implied(schur: &[f64], idle: &[bool], quadratic: &mut BoundedQuadratic) -> Vec<bool> {
    let p = idle.len();
    let size = |i: usize| (-schur[i * p + i]).max(f64::MIN_POSITIVE).sqrt();
    let product = |i: usize, j: usize| -schur[i * p + j] / (size(i) * size(j));
    let (mut others, mut stress) = (Vec::new(), Vec::new());
    let (mut matrix, mut gradient, mut least) = (Vec::new(), Vec::new(), Vec::new());
    let mut is_held = |i: usize| {
        if !idle[i] {
            return true;
        }
        others.clear();
        others.extend((0..p).filter(|&j| j != i));
        matrix.clear();
        for &j in &others {
            let ridge = |k: usize| if j == k { 1e-3 * IMPLIED } else { 0.0 };
            matrix.extend(others.iter().map(|&k| product(j, k) + ridge(k)));
        }
        gradient.clear();
        gradient.extend(others.iter().map(|&j| product(i, j)));
        least.clear();
        least.extend(others.iter().map(|&j| if idle[j] { 0.0 } else { RELEASED }));
        if quadratic.minimise(&matrix, &gradient, &least, &mut stress).is_err() {
            return false;
        }
        let mut left = product(i, i);
        for (&j, &a) in others.iter().zip(&stress) {
            left += 2.0 * a * product(i, j);
            for (&k, &b) in others.iter().zip(&stress) {
                left += a * b * product(j, k);
            }
        }
        left <= IMPLIED
    };
    (0..p).map(&mut is_held).collect()
}

/// An eigenvalue that the stiffness of the elements allows, or the reason why there is none. The least
/// eigenvalue cannot exceed the greatest one of fields that are zero but in the middle of one element.
pub(crate) fn plausible<'a>(
    value: f64,
    elements: impl Iterator<Item = &'a Element>,
) -> Result<f64, NoStability> {
    if value.abs() <= IMPLAUSIBLE {
        return Ok(value);
    }
    let ratio = |element: &Element| {
        let of_middle = symmetric(element.energy[1][1]);
        let [.., greatest] = of_middle.eigenvalues_relative_to(&symmetric(element.metric[1][1]))?;
        Some(greatest.abs())
    };
    let greatest = elements.filter_map(ratio).fold(1.0, f64::max);
    let is_possible = value.is_finite() && value <= IMPLAUSIBLE * greatest;
    if is_possible { Ok(value) } else { Err(NoStability::Undetermined) }
}

/// `|m||η|²` of the part of `η` across `m`.
pub(crate) fn across(m: Vec3) -> Mat3 {
    let size = m.norm();
    if size == 0.0 {
        return Mat3::ZERO;
    }
    Mat3::IDENTITY * size - Mat3::outer(m, m) * (1.0 / size)
}

/// Bisection on whether there is an eigenvalue below a shift: monotone, so it cannot miss.
pub(crate) fn bisect(low: f64, high: f64, mut is_below: impl FnMut(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    let mut reach = high - low;
    while is_below(low) {
        (high, reach) = (low, 4.0 * reach);
        low -= reach;
        if low < -FAR {
            return f64::NEG_INFINITY;
        }
    }
    while !is_below(high) {
        (low, reach) = (high, 4.0 * reach);
        high += reach;
        if high > FAR {
            return f64::INFINITY;
        }
    }
    while high - low > TOLERANCE * (1.0 + low.abs().max(high.abs())) {
        let middle = 0.5 * (low + high);
        if is_below(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

/// The zero of a function that falls, is concave, and has no value (`None`) from some place on, where it
/// counts as negative: a bracket is shrunk by chords that are kept from stalling (the Illinois
/// method), and halved where an end has no value.
pub(crate) fn falling_zero(low: f64, high: f64, mut f: impl FnMut(f64) -> Option<f64>) -> f64 {
    let (mut low, mut high) = (low, high);
    let mut reach = high - low;
    let mut at_low = f(low);
    while at_low.is_none_or(|value| value < 0.0) {
        (high, reach) = (low, 4.0 * reach);
        low -= reach;
        if low < -FAR {
            return f64::NEG_INFINITY;
        }
        at_low = f(low);
    }
    let mut at_high = f(high);
    while at_high.is_some_and(|value| value >= 0.0) {
        (low, at_low, reach) = (high, at_high, 4.0 * reach);
        high += reach;
        if high > FAR {
            return f64::INFINITY;
        }
        at_high = f(high);
    }
    // Which end the last trial replaced: twice the same one, and the chord hangs on the other.
    let mut replaced_low = None;
    let tolerance = |low: f64, high: f64| TOLERANCE * (1.0 + low.abs().max(high.abs()));
    while high - low > tolerance(low, high) {
        let trial = match (at_low, at_high) {
            (Some(a), Some(b)) if a > 0.0 => {
                // A step beyond the zero closes the bracket from the other side.
                let chord = low + (high - low) * (a / (a - b));
                let margin = 0.5 * tolerance(low, high);
                chord.clamp(low + margin, high - margin)
            }
            _ => 0.5 * (low + high),
        };
        match f(trial) {
            Some(value) if value >= 0.0 => {
                if replaced_low == Some(true) {
                    at_high = at_high.map(|b| 0.5 * b);
                }
                (low, at_low, replaced_low) = (trial, Some(value), Some(true));
            }
            value => {
                if replaced_low == Some(false) {
                    at_low = at_low.map(|a| 0.5 * a);
                }
                (high, at_high, replaced_low) = (trial, value, Some(false));
            }
        }
    }
    0.5 * (low + high)
}

/// The number of negative eigenvalues of a symmetric block: by the signs of its leading minors where
/// they are plain.
pub(crate) fn negative_eigenvalues(block: &Mat3) -> usize {
    let rows = &block.rows;
    let size = rows.iter().map(|row| row.max_abs()).fold(0.0, f64::max);
    let first = rows[0][0];
    let second = first * rows[1][1] - rows[1][0] * rows[1][0];
    let third = block.determinant();
    let plain = first.abs() > 1e-8 * size
        && second.abs() > 1e-8 * size * size
        && third.abs() > 1e-8 * size * size * size;
    if !plain {
        return block.symmetric_eigenvalues().iter().filter(|&&x| x < 0.0).count();
    }
    let changes = |a: f64, b: f64| usize::from((a < 0.0) != (b < 0.0));
    changes(1.0, first) + changes(first, second) + changes(second, third)
}

/// The inverse of a symmetric block and the number of its negative eigenvalues. A block that is
/// singular to working precision is moved off by as much as rounding has.
pub(crate) fn pivot(block: Mat3) -> (Mat3, usize) {
    let negative = negative_eigenvalues(&block);
    let inverse = block.inverse().unwrap_or_else(|| {
        let size = block.rows.iter().map(|row| row.max_abs()).fold(f64::MIN_POSITIVE, f64::max);
        let moved = block + Mat3::IDENTITY * (16.0 * f64::EPSILON * size);
        moved.inverse().unwrap_or(Mat3::IDENTITY * (1.0 / (f64::EPSILON * size)))
    });
    (inverse, negative)
}

pub(crate) fn symmetric(a: Mat3) -> Mat3 {
    (a + a.transpose()) * 0.5
}

/// Slopes of the three shape functions of a step, times its length, at start, middle and end.
pub(crate) const SLOPES: [[f64; 3]; 3] = [[-3.0, 4.0, -1.0], [-1.0, 0.0, 1.0], [1.0, -4.0, 3.0]];
/// Simpson's rule.
pub(crate) const WEIGHTS: [f64; 3] = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];

/// Simpson's rule on the quadratic shape functions of a step.
///
/// Each shape function is 1 at one sample and 0 at the two others: at sample `q` the energy is a form of
/// `ζ′ = Σ σᵢ ζᵢ`, with `σᵢ` their slopes, and of `ζ = ζ_q`. The unknowns `ζ = R η` are rotations in the frame that the
/// rotations of the samples are given in: there `δu = Rᵀ ζ′` exactly, however much the rod turns within a step.
pub(crate) fn element(h: f64, samples: &[Sample], bending: impl Fn(usize) -> Mat3) -> Element {
    let mut out = Element::default();
    for (q, sample) in samples.iter().enumerate() {
        let weight = WEIGHTS[q] * h;
        let frame = sample.rotation.to_matrix();
        let fixed = |of_body: Mat3| frame * of_body * frame.transpose();
        let push = Mat3::skew(sample.wrench.linear);
        let moment = Mat3::skew(sample.wrench.angular);
        let (compliance, coupling) = sample.tangent.force_compliance();
        // −M·(η × δu) = ηᵀ M̂ δu with M̂ δu = M × δu, made symmetric.
        let slope_turn = moment.transpose() * 0.5 - coupling.transpose() * push;
        let turn_turn = tilt(sample.strain.linear, sample.wrench.linear)
            - push.transpose() * (compliance * push);
        let energy = Turning {
            slope_slope: fixed(sample.tangent.reduced),
            slope_turn: fixed(slope_turn),
            turn_turn: fixed(turn_turn),
        };
        let metric = fixed(bending(q));
        for i in 0..3 {
            for j in 0..3 {
                out.energy[i][j] += energy.block(q, i, j, h) * weight;
                out.metric[i][j] += metric * (SLOPES[q][i] * SLOPES[q][j] * weight / (h * h));
            }
        }
    }
    out
}

/// A symmetric form of `η′` and `η` at a place.
struct Turning {
    slope_slope: Mat3,
    slope_turn: Mat3,
    turn_turn: Mat3,
}

impl Turning {
    /// The form of shape functions `i` and `j` of a step this long, at its sample `q`.
    fn block(&self, q: usize, i: usize, j: usize, h: f64) -> Mat3 {
        let (a, b) = (SLOPES[q][i] / h, SLOPES[q][j] / h);
        let mut block = self.slope_slope * (a * b);
        if j == q {
            block += self.slope_turn * a;
        }
        if i == q {
            block += self.slope_turn.transpose() * b;
        }
        if i == q && j == q {
            block += self.turn_turn;
        }
        block
    }
}

/// The symmetric matrix of `−v·(η × (η × N)) = (v·N)|η|² − (v·η)(N·η)`.
fn tilt(v: Vec3, force: Vec3) -> Mat3 {
    Mat3::IDENTITY * v.dot(force) - symmetric(Mat3::outer(v, force))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn element() -> Element {
        let mut element = Element::default();
        (element.energy[1][1], element.metric[1][1]) = (Mat3::IDENTITY * 3.0, Mat3::IDENTITY);
        element
    }

    /// Where no pivot ever turns negative the search for an eigenvalue ends beyond all of them.
    #[test]
    fn a_value_beyond_any_stiffness_is_none() {
        let elements = [element()];
        let of = |value: f64| plausible(value, elements.iter());
        assert_eq!(of(-2e5), Ok(-2e5));
        assert_eq!(of(2.5), Ok(2.5));
        assert_eq!(of(1.47e12), Err(NoStability::Undetermined));
        assert_eq!(of(bisect(0.0, 1.0, |_| false)), Err(NoStability::Undetermined));
        assert_eq!(of(falling_zero(0.0, 1.0, |_| Some(1.0))), Err(NoStability::Undetermined));
        assert_eq!(of(falling_zero(0.0, 1.0, |_| None)), Err(NoStability::Undetermined));
    }

    /// Four cables around an axis: bending about two axes and compression leave one state of self-stress, in which
    /// opposite cables pull alike and their neighbours push.
    #[test]
    fn idle_cables_are_held_where_a_state_of_self_stress_pulls_them() {
        let effects = [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [-1.0, 0.0, 1.0], [0.0, -1.0, 1.0]];
        let held = |axial: f64, cables: &[(usize, bool)]| {
            let product = |i: usize, j: usize| {
                let [a, b, c] = effects[i];
                let [d, e, f] = effects[j];
                -(a * d + b * e + axial * c * f)
            };
            let pairs = cables.iter().flat_map(|&(i, _)| cables.iter().map(move |&(j, _)| (i, j)));
            let schur: Vec<f64> = pairs.map(|(i, j)| product(i, j)).collect();
            let idle: Vec<bool> = cables.iter().map(|&(_, idle)| idle).collect();
            implied(&schur, &idle, &mut BoundedQuadratic::default())
        };
        let (taut, idle) = (false, true);
        // The backbone stretches: two idle cables are held by two taut ones, but not by neighbours.
        assert_eq!(held(1.0, &[(0, taut), (1, idle), (2, taut), (3, idle)]), [true; 4]);
        assert_eq!(held(1.0, &[(0, taut), (1, idle), (2, taut)]), [true, false, true]);
        assert_eq!(held(1.0, &[(0, idle), (1, idle), (2, idle), (3, idle)]), [false; 4]);
        // It does not: opposite cables hold one another.
        assert_eq!(held(0.0, &[(0, idle), (1, idle), (2, idle), (3, idle)]), [true; 4]);
        assert_eq!(held(0.0, &[(0, idle), (1, idle), (2, idle)]), [true, false, true]);
    }
}
