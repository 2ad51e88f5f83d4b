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
//! negative beyond it. The fields `η` are piecewise quadratic on the steps of the grid.
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

use whipcord_numerics::{Mat3, Vec3, symmetric_eigenvalues};

use super::command::Command;
use super::grid::Grid;
use super::loaded::{SAMPLED_NODES, Sample};
use super::sensitivity::work;
use crate::shape::Diagnostics;

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
    beyond: Vec<Vec3>,
    next: Vec<Vec3>,
}

/// A taut cable held at its length.
#[derive(Clone, Copy, Debug)]
struct Locked {
    /// Its place in the order of the grid.
    cable: usize,
    /// Its own, in m/N.
    compliance: f64,
}

/// An eigenvalue this close to zero counts as zero.
const NEUTRAL: f64 = Diagnostics::NEUTRAL;
/// Relative accuracy of the eigenvalue.
const TOLERANCE: f64 = 1e-8;
/// Compliance added to each locked cable, relative to what the rod gives: it decides what counts as
/// zero where more cables are taut than lengths are independent.
const REGULARISATION: f64 = 1e-9;

impl Stability {
    /// The least eigenvalue, from three samples to each step of the grid, with the cables that
    /// `commands` hold at their lengths and that are taut.
    pub fn least_eigenvalue(
        &mut self,
        grid: &Grid,
        samples: &[Sample],
        commands: &[Command],
        tensions: &[f64],
    ) -> f64 {
        self.assemble(grid, samples);
        let free = falling_zero(0.0, 1.0, |shift| self.least_of_tip(shift));
        self.lock(grid, samples, commands, tensions);
        if self.locked.is_empty() {
            return free;
        }
        // Constraints only raise it.
        let margin = TOLERANCE * (1.0 + free.abs());
        bisect(free - margin, free + 1.0, |shift| self.negative_directions(shift) > 0)
    }

    /// Whether it is not negative.
    pub fn is_stable(
        &mut self,
        grid: &Grid,
        samples: &[Sample],
        commands: &[Command],
        tensions: &[f64],
    ) -> bool {
        self.assemble(grid, samples);
        if !self.is_indefinite(-NEUTRAL) {
            return true;
        }
        self.lock(grid, samples, commands, tensions);
        !self.locked.is_empty() && self.negative_directions(-NEUTRAL) == 0
    }

    /// The number of directions in which the robot leaves the equilibrium.
    pub fn unstable_directions(
        &mut self,
        grid: &Grid,
        samples: &[Sample],
        commands: &[Command],
        tensions: &[f64],
    ) -> usize {
        self.assemble(grid, samples);
        if !self.is_indefinite(-NEUTRAL) {
            return 0;
        }
        self.lock(grid, samples, commands, tensions);
        self.negative_directions(-NEUTRAL)
    }

    fn assemble(&mut self, grid: &Grid, samples: &[Sample]) {
        self.elements.clear();
        for (k, triple) in samples.chunks_exact(3).enumerate() {
            let bending =
                |j: usize| grid.shooting.at(k, SAMPLED_NODES[j], 0).0.section.bending_stiffness();
            self.elements.push(element(grid.steps[k].length, triple, bending));
        }
    }

    /// Finds the locked cables, and `b` and `D − C` of eq. (11).
    fn lock(&mut self, grid: &Grid, samples: &[Sample], commands: &[Command], tensions: &[f64]) {
        self.locked.clear();
        for (cable, (command, &tension)) in commands.iter().zip(tensions).enumerate() {
            if let Command::Length { compliance, .. } = *command
                && tension > 0.0
            {
                self.locked.push(Locked { cable, compliance });
            }
        }
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
                let turn = Mat3::skew(sample.strain.angular);
                let push = Mat3::skew(sample.wrench.linear);
                for (i, locked) in self.locked.iter().enumerate() {
                    let Some(crossing) = crossings.get(locked.cable) else { continue };
                    let pull = crossing.pull(&sample.strain).0;
                    // δℓ = ∫ t·δv + (r × t)·δu with δv = A⁻¹δN − A⁻¹B δu.
                    let by_strain = coupling.transpose_mul(pull.linear) + pull.angular;
                    let relaxed = compliance * pull.linear;
                    let border = &mut self.borders[first + i];
                    for (j, border) in border.iter_mut().enumerate() {
                        *border += by_strain * (weight * SLOPES[q][j] / step.length);
                    }
                    border[q] += turn.transpose_mul(by_strain) * weight;
                    border[q] += push.transpose_mul(relaxed) * weight;
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
        let in_schur = symmetric_eigenvalues(p, schur).iter().filter(|&&x| x < 0.0).count();
        (negative + in_schur).saturating_sub(p)
    }
}

/// Bisection on whether there is an eigenvalue below a shift: monotone, so it cannot miss.
pub(crate) fn bisect(low: f64, high: f64, mut is_below: impl FnMut(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    let mut reach = high - low;
    while is_below(low) {
        (high, reach) = (low, 4.0 * reach);
        low -= reach;
        if low < -1e12 {
            return low;
        }
    }
    while !is_below(high) {
        (low, reach) = (high, 4.0 * reach);
        high += reach;
        if high > 1e12 {
            return high;
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
        if low < -1e12 {
            return low;
        }
        at_low = f(low);
    }
    let mut at_high = f(high);
    while at_high.is_some_and(|value| value >= 0.0) {
        (low, at_low, reach) = (high, at_high, 4.0 * reach);
        high += reach;
        if high > 1e12 {
            return high;
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
/// `η′ = Σ σᵢ ηᵢ`, with `σᵢ` their slopes, and of `η = η_q`, with `δu = η′ + û η` and `δN = N̂ η`.
pub(crate) fn element(h: f64, samples: &[Sample], bending: impl Fn(usize) -> Mat3) -> Element {
    let mut out = Element::default();
    for (q, sample) in samples.iter().enumerate() {
        let weight = WEIGHTS[q] * h;
        let turn = Mat3::skew(sample.strain.angular);
        let push = Mat3::skew(sample.wrench.linear);
        let moment = Mat3::skew(sample.wrench.angular);
        let (compliance, coupling) = sample.tangent.force_compliance();
        let bends = sample.tangent.reduced;
        // −M·(η × δu) = ηᵀ M̂ δu with M̂ δu = M × δu, made symmetric.
        let yields = coupling.transpose() * push;
        let slope_turn = bends * turn - yields + moment.transpose() * 0.5;
        let sheared = turn.transpose() * yields;
        let twisted = moment * turn;
        let turn_turn = turn.transpose() * (bends * turn)
            - sheared
            - sheared.transpose()
            - push.transpose() * (compliance * push)
            + symmetric(twisted)
            + tilt(sample.strain.linear, sample.wrench.linear);
        let energy = Turning { slope_slope: bends, slope_turn, turn_turn };
        let metric = bending(q);
        let bent = metric * turn;
        let metric =
            Turning { slope_slope: metric, slope_turn: bent, turn_turn: turn.transpose() * bent };
        for i in 0..3 {
            for j in 0..3 {
                out.energy[i][j] += energy.block(q, i, j, h) * weight;
                out.metric[i][j] += metric.block(q, i, j, h) * weight;
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
