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
//! `E″ / ∫ δuᵀ K_bt δu ds`: 1 for the bare rod without load, 0 at the buckling load, negative
//! beyond it. It holds for given tensions; locked cables only add to it. The fields `η` are
//! piecewise quadratic on the steps of the grid.

use whipcord_numerics::{Mat3, Vec3};

use super::grid::Grid;
use super::loaded::{SAMPLED_NODES, Sample};

/// Quadratic forms of one step on (start, middle, end): energy and metric, as 3×3 blocks.
#[derive(Clone, Copy, Debug, Default)]
struct Element {
    energy: [[Mat3; 3]; 3],
    metric: [[Mat3; 3]; 3],
}

/// Memory of the eigenvalue computation.
#[derive(Clone, Debug, Default)]
pub(super) struct Stability {
    elements: Vec<Element>,
}

/// Relative accuracy of the eigenvalue.
const TOLERANCE: f64 = 1e-8;

impl Stability {
    /// The least eigenvalue, from three samples to each step of the grid.
    pub fn least_eigenvalue(&mut self, grid: &Grid, samples: &[Sample]) -> f64 {
        self.assemble(grid, samples);
        self.bisect()
    }

    /// Whether it is positive.
    pub fn is_stable(&mut self, grid: &Grid, samples: &[Sample]) -> bool {
        self.assemble(grid, samples);
        !self.has_eigenvalue_below(0.0)
    }

    fn assemble(&mut self, grid: &Grid, samples: &[Sample]) {
        self.elements.clear();
        for (k, triple) in samples.chunks_exact(3).enumerate() {
            let bending =
                |j: usize| grid.shooting.at(k, SAMPLED_NODES[j], 0).0.section.stiffness.bending;
            self.elements.push(element(grid.steps[k].length, triple, bending));
        }
    }

    /// Bisection on the number of eigenvalues below a shift: monotone, so it cannot miss.
    fn bisect(&self) -> f64 {
        let (mut low, mut high) = (-1.0, 2.0);
        while self.has_eigenvalue_below(low) {
            high = low;
            low *= 4.0;
            if low < -1e12 {
                return low;
            }
        }
        while !self.has_eigenvalue_below(high) {
            low = high;
            high *= 4.0;
            if high > 1e12 {
                return high;
            }
        }
        while high - low > TOLERANCE * (1.0 + low.abs().max(high.abs())) {
            let middle = 0.5 * (low + high);
            if self.has_eigenvalue_below(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Whether `energy − shift · metric` has a negative direction, by block elimination from the
    /// tip to the clamped base.
    fn has_eigenvalue_below(&self, shift: f64) -> bool {
        // What the part beyond the step contributes at its end.
        let mut beyond = Mat3::ZERO;
        for element in self.elements.iter().rev() {
            let block = |i: usize, j: usize| element.energy[i][j] - element.metric[i][j] * shift;
            let Some(middle) = block(1, 1).ldlt() else { return true };
            let to_end = middle.solve_matrix(&block(1, 2));
            let to_start = middle.solve_matrix(&block(1, 0));
            let end = block(2, 2) + beyond - block(2, 1) * to_end;
            let Some(end) = symmetric(end).ldlt() else { return true };
            let coupling = block(2, 0) - block(2, 1) * to_start;
            beyond = block(0, 0)
                - block(0, 1) * to_start
                - coupling.transpose() * end.solve_matrix(&coupling);
            beyond = symmetric(beyond);
        }
        false
    }
}

fn symmetric(a: Mat3) -> Mat3 {
    (a + a.transpose()) * 0.5
}

/// Simpson's rule on the quadratic shape functions of a step.
fn element(h: f64, samples: &[Sample], bending: impl Fn(usize) -> Vec3) -> Element {
    // Slopes of the three shape functions, times h, at start, middle and end.
    const SLOPES: [[f64; 3]; 3] = [[-3.0, 4.0, -1.0], [-1.0, 0.0, 1.0], [1.0, -4.0, 3.0]];
    const WEIGHTS: [f64; 3] = [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0];
    let mut out = Element::default();
    for (q, sample) in samples.iter().enumerate() {
        let weight = WEIGHTS[q] * h;
        let turn = Mat3::skew(sample.strain.angular);
        let push = Mat3::skew(sample.wrench.linear);
        let (v, moment) = (sample.strain.linear, sample.wrench.angular);
        let (compliance, coupling) = sample.tangent.force_compliance();
        let bending = Mat3::diagonal(bending(q));
        // δu = B_i η_i and δN = C_i η_i of each shape function.
        let strain = |i: usize| {
            let own = if i == q { turn } else { Mat3::ZERO };
            own + Mat3::IDENTITY * (SLOPES[q][i] / h)
        };
        let force = |i: usize| if i == q { push } else { Mat3::ZERO };
        for i in 0..3 {
            for j in 0..3 {
                let (bi, bj) = (strain(i), strain(j));
                let (ci, cj) = (force(i), force(j));
                let mut energy = bi.transpose() * sample.tangent.reduced * bj
                    - bi.transpose() * coupling.transpose() * cj
                    - ci.transpose() * coupling * bj
                    - ci.transpose() * compliance * cj;
                // −M·(η × δu) = ηᵀ M̂ δu with M̂ δu = M × δu, made symmetric.
                let cross = Mat3::skew(moment);
                if i == q {
                    energy += cross * bj * 0.5;
                }
                if j == q {
                    energy += bi.transpose() * cross.transpose() * 0.5;
                }
                if i == q && j == q {
                    energy += tilt(v, sample.wrench.linear);
                }
                out.energy[i][j] += energy * weight;
                out.metric[i][j] += bi.transpose() * bending * bj * weight;
            }
        }
    }
    out
}

/// The symmetric matrix of `−v·(η × (η × N)) = (v·N)|η|² − (v·η)(N·η)`.
fn tilt(v: Vec3, force: Vec3) -> Mat3 {
    Mat3::IDENTITY * v.dot(force) - symmetric(Mat3::outer(v, force))
}
