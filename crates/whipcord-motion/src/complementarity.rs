//! Linear complementarity problems of a few unknowns.

use whipcord_numerics::DenseLu;

/// Solves `0 ≤ x ⟂ q + S x ≥ 0` by block principal pivoting, with single exchanges where those cycle (Júdice and Pires, *A block principal
/// pivoting algorithm for large-scale strictly monotone linear complementarity problems*, Computers & Operations Research 21, 1994).
#[derive(Clone, Debug, Default)]
pub(crate) struct Complementarity {
    /// Which unknowns may be positive: the prediction, then the answer.
    pub active: Vec<bool>,
    indices: Vec<usize>,
    block: Vec<f64>,
    values: Vec<f64>,
    lu: DenseLu,
}

/// No exchange leads to an answer: the matrix is singular to rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NoComplement;

impl Complementarity {
    /// Writes the answer into `x`; `matrix` holds the rows of `S`. Gaps down to `-least_gap` count as zero.
    pub fn solve(
        &mut self,
        matrix: &[f64],
        q: &[f64],
        least_gap: f64,
        x: &mut [f64],
    ) -> Result<(), NoComplement> {
        /// Exchanges of several at a time without fewer that violate, before there is one at a time.
        const PATIENCE: usize = 3;
        let n = q.len();
        let (mut fewest, mut patience) = (n + 1, PATIENCE);
        for _ in 0..20 * (n + 1) {
            self.solve_active(matrix, q, x)?;
            let violates = |i: usize| {
                if self.active[i] {
                    return x[i] < 0.0;
                }
                let row = &matrix[i * n..(i + 1) * n];
                q[i] + row.iter().zip(&*x).map(|(s, x)| s * x).sum::<f64>() < -least_gap
            };
            let count = (0..n).filter(|&i| violates(i)).count();
            if count == 0 {
                return Ok(());
            }
            if count < fewest {
                (fewest, patience) = (count, PATIENCE);
            } else {
                patience = patience.saturating_sub(1);
            }
            if patience > 0 {
                self.indices.clear();
                self.indices.extend((0..n).filter(|&i| violates(i)));
            } else {
                let last = (0..n).rev().find(|&i| violates(i));
                self.indices.clear();
                self.indices.extend(last);
            }
            for &i in &self.indices {
                self.active[i] = !self.active[i];
            }
        }
        Err(NoComplement)
    }

    /// The unknowns with gaps of zero, the others zero.
    fn solve_active(
        &mut self,
        matrix: &[f64],
        q: &[f64],
        x: &mut [f64],
    ) -> Result<(), NoComplement> {
        let n = q.len();
        let Self { active, indices, block, values, lu } = self;
        indices.clear();
        indices.extend((0..n).filter(|&i| active[i]));
        block.clear();
        values.clear();
        for &i in &*indices {
            block.extend(indices.iter().map(|&j| matrix[i * n + j]));
            values.push(-q[i]);
        }
        lu.factor(indices.len(), block).map_err(|_| NoComplement)?;
        lu.solve(values);
        x.fill(0.0);
        for (&i, &value) in indices.iter().zip(&*values) {
            x[i] = value;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_complementary() {
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 40) as f64 / (1_u64 << 24) as f64 - 0.5
        };
        for n in [1, 2, 3, 6, 12] {
            for _ in 0..100 {
                let root: Vec<f64> = (0..n * n).map(|_| random()).collect();
                let matrix: Vec<f64> = (0..n * n)
                    .map(|k| {
                        let (i, j) = (k / n, k % n);
                        let sum: f64 = (0..n).map(|l| root[i * n + l] * root[j * n + l]).sum();
                        sum + if i == j { 0.05 } else { 0.01 * random() }
                    })
                    .collect();
                let q: Vec<f64> = (0..n).map(|_| random()).collect();
                let mut solver = Complementarity { active: vec![true; n], ..Default::default() };
                let mut x = vec![0.0; n];
                solver.solve(&matrix, &q, 1e-14, &mut x).unwrap();
                for i in 0..n {
                    let row = &matrix[i * n..(i + 1) * n];
                    let gap = q[i] + row.iter().zip(&x).map(|(s, x)| s * x).sum::<f64>();
                    assert!(x[i] >= 0.0 && gap > -1e-12 && (x[i] * gap).abs() < 1e-12);
                }
            }
        }
    }
}
