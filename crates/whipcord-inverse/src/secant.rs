//! The second-order part of the Hessian of a sum of squares, by secants.
//!
//! Far from its minimum the Gauss–Newton matrix `JᵀJ` is all that a step needs. Where the residuals cannot vanish, as of a target that is out of
//! reach, what it leaves out, `S = Σ rᵢ ∇²rᵢ`, decides: at a fold of the reachable places `JᵀJ` is singular. `S` is
//! learned from the gradients at both ends of each step by the update of Dennis, Gay and Welsch (ACM Transactions on Mathematical Software
//! 7, 1981).

use crate::linear::Linear;

/// `S`, in scales of the unknowns.
#[derive(Clone, Debug, Default)]
pub(crate) struct SecondOrder {
    matrix: Vec<f64>,
    /// `S d`, and how the gradient has changed beyond the change of the residuals, then at all.
    along: Vec<f64>,
    structured: Vec<f64>,
    change: Vec<f64>,
}

/// A step that is so near to orthogonal to the change of the gradient teaches nothing.
const LEAST_COSINE: f64 = 1e-8;

impl SecondOrder {
    /// By rows; empty as long as nothing is known.
    pub fn matrix(&self) -> &[f64] {
        &self.matrix
    }

    /// Learns from a step `d` in scales, and from both its ends:
    ///
    /// ```text
    /// y# = J₊ᵀ r₊ − J₋ᵀ r₊,   y = J₊ᵀ r₊ − J₋ᵀ r₋,   τ = min(1, |dᵀy#|/|dᵀS d|),   v = y# − τ S d,
    /// S₊ = τ S + (v yᵀ + y vᵀ)/(yᵀd) − (vᵀd) y yᵀ/(yᵀd)²
    /// ```
    pub fn learn(&mut self, step: &[f64], scales: &[f64], before: &Linear, after: &Linear) {
        let n = scales.len();
        let step = &step[..n];
        self.matrix.resize(n * n, 0.0);
        for list in [&mut self.along, &mut self.structured, &mut self.change] {
            list.clear();
            list.resize(n, 0.0);
        }
        let residuals = before.residual.iter().zip(&after.residual);
        let rows = before.jacobian.chunks_exact(n).zip(after.jacobian.chunks_exact(n));
        for ((was, is), (row, next)) in residuals.zip(rows) {
            for (k, ((row, next), scale)) in row.iter().zip(next).zip(scales).enumerate() {
                self.structured[k] += scale * (next - row) * is;
                self.change[k] += scale * (next * is - row * was);
            }
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for (row, along) in self.matrix.chunks_exact(n).zip(&mut self.along) {
            *along = dot(row, step);
        }
        let across = dot(&self.change, step);
        let norms = dot(&self.change, &self.change).sqrt() * dot(step, step).sqrt();
        if across.abs() <= LEAST_COSINE * norms || across == 0.0 {
            return;
        }
        let (of_step, known) = (dot(&self.structured, step), dot(&self.along, step));
        let size = if known == 0.0 { 1.0 } else { (of_step / known).abs().min(1.0) };
        let missing = |k: usize| self.structured[k] - size * self.along[k];
        let left: f64 = (0..n).map(|k| missing(k) * step[k]).sum();
        for a in 0..n {
            for b in 0..n {
                let (ya, yb) = (self.change[a], self.change[b]);
                let update = (missing(a) * yb + ya * missing(b)) / across
                    - left * ya * yb / (across * across);
                let entry = &mut self.matrix[a * n + b];
                *entry = size * *entry + update;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `r = (x² + y, x y − 1, y²/2)` with its derivatives by x and y.
    fn at([x, y]: [f64; 2]) -> Linear {
        Linear {
            residual: vec![x * x + y, x * y - 1.0, 0.5 * y * y],
            jacobian: vec![2.0 * x, 1.0, y, x, 0.0, y],
            ..Linear::default()
        }
    }

    #[test]
    fn steps_teach_the_second_order_part() {
        let scales = [2.0, 0.5];
        let place = [0.7, -0.4];
        let size = 1e-5;
        let steps = [[size, 0.3 * size], [-0.2 * size, size]];
        let r = at(place).residual;
        // r₁ ∇²(x² + y) + r₂ ∇²(x y) + r₃ ∇²(y²/2), in scales.
        let exact = [r[0] * 2.0 * 4.0, r[1], r[1], r[2] * 0.25];
        let mut second = SecondOrder::default();
        for step in steps.iter().cycle().take(40) {
            let to = [place[0] + step[0] * scales[0], place[1] + step[1] * scales[1]];
            second.learn(step, &scales, &at(place), &at(to));
            let found = second.matrix();
            assert_eq!(found[1], found[2]);
            // The change along the step itself is known at once, but for what is left of higher order.
            for (row, exact) in found.chunks_exact(2).zip(exact.chunks_exact(2)) {
                let along = |row: &[f64]| row[0] * step[0] + row[1] * step[1];
                assert!((along(row) - along(exact)).abs() < 1e-3 * size, "{found:?} {exact:?}");
            }
        }
        for (found, exact) in second.matrix().iter().zip(exact) {
            assert!((found - exact).abs() < 0.05, "{:?} {exact}", second.matrix());
        }
    }
}
