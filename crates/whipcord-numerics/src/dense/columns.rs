//! Solutions for several right-hand sides, side by side in the lanes of the processor.

use pulp::{Simd, WithSimd};

use super::{BLOCK, DenseLu};
use crate::lanes::{Lanes, Width};

/// Columns that are solved for side by side at most.
const MOST_LANES: usize = 8;

impl DenseLu {
    /// Overwrites each column `b` by the solution of `A x = b`, to the bits of [`Self::solve`], in less time than one by one.
    ///
    /// ```
    /// use whipcord_numerics::DenseLu;
    /// let mut lu = DenseLu::default();
    /// lu.factor(2, &[0.0, 2.0, 1.0, 1.0])?; // by rows
    /// let mut columns = [vec![2.0, 3.0], vec![4.0, 1.0]];
    /// lu.solve_columns(&mut columns);
    /// assert_eq!(columns, [vec![2.0, 1.0], vec![-1.0, 2.0]]);
    /// # Ok::<(), whipcord_numerics::Singular>(())
    /// ```
    pub fn solve_columns(&self, columns: &mut [Vec<f64>]) {
        Width::Widest.dispatch(SolveColumns { lu: self, columns });
    }

    /// The first so many columns of the inverse.
    ///
    /// ```
    /// # use whipcord_numerics::DenseLu;
    /// let mut lu = DenseLu::default();
    /// lu.factor(2, &[2.0, 0.0, 0.0, 4.0])?;
    /// assert_eq!(lu.inverse_columns(1), [vec![0.5, 0.0]]);
    /// # Ok::<(), whipcord_numerics::Singular>(())
    /// ```
    #[must_use]
    pub fn inverse_columns(&self, count: usize) -> Vec<Vec<f64>> {
        let unit = |i: usize| {
            let mut column = vec![0.0; self.n];
            column[i] = 1.0;
            column
        };
        let mut columns: Vec<Vec<f64>> = (0..count).map(unit).collect();
        self.solve_columns(&mut columns);
        columns
    }
}

/// The solution of several columns, with the instructions that the processor has; none of the sums is fused.
struct SolveColumns<'a> {
    lu: &'a DenseLu,
    columns: &'a mut [Vec<f64>],
}

impl WithSimd for SolveColumns<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { lu, columns } = self;
        let DenseLu { n, factors, pivots, .. } = lu;
        let n = *n;
        if Lanes::<S>::COUNT == 1 {
            return columns.iter_mut().for_each(|column| lu.solve(column));
        }
        const { assert!(Lanes::<S>::COUNT <= MOST_LANES) };
        let mut block = vec![Lanes::splat(simd, 0.0); n];
        for columns in columns.chunks_mut(Lanes::<S>::COUNT) {
            let mut values = [0.0; MOST_LANES];
            for (i, lanes) in block.iter_mut().enumerate() {
                for (x, column) in values.iter_mut().zip(columns.iter()) {
                    *x = column[i];
                }
                *lanes = Lanes::load(simd, &values, 0);
            }
            for (k, &pivot) in pivots.iter().enumerate() {
                block.swap(k, pivot);
            }
            let mut k = 0;
            while k + BLOCK <= n {
                let [a, b, c, d] = [0, 1, 2, 3].map(|i| &factors[(k + i) * n..(k + i + 1) * n]);
                for (i, factors) in [a, b, c].into_iter().enumerate() {
                    let times = block[k + i];
                    for row in k + i + 1..k + BLOCK {
                        block[row] = block[row] - times * factors[row];
                    }
                }
                let (above, below) = block.split_at_mut(k + BLOCK);
                let times = [above[k], above[k + 1], above[k + 2], above[k + 3]];
                subtract_lanes(below, [a, b, c, d].map(|factors| &factors[k + BLOCK..]), &times);
                k += BLOCK;
            }
            for k in k..n {
                let times = block[k];
                for row in k + 1..n {
                    block[row] = block[row] - times * factors[k * n + row];
                }
            }
            let mut left = n;
            while left >= BLOCK {
                let k = left - BLOCK;
                let [a, b, c, d] = [0, 1, 2, 3].map(|i| &factors[(k + i) * n..(k + i + 1) * n]);
                for (i, factors) in [a, b, c, d].into_iter().enumerate().rev() {
                    block[k + i] = block[k + i] / Lanes::splat(simd, factors[k + i]);
                    let times = block[k + i];
                    for row in k..k + i {
                        block[row] = block[row] - times * factors[row];
                    }
                }
                let (above, below) = block.split_at_mut(k);
                let times = [below[3], below[2], below[1], below[0]];
                subtract_lanes(above, [d, c, b, a].map(|factors| &factors[..k]), &times);
                left = k;
            }
            for k in (0..left).rev() {
                block[k] = block[k] / Lanes::splat(simd, factors[k * n + k]);
                let times = block[k];
                for row in 0..k {
                    block[row] = block[row] - times * factors[k * n + row];
                }
            }
            for (i, lanes) in block.iter().enumerate() {
                for (x, column) in lanes.as_slice().iter().zip(columns.iter_mut()) {
                    column[i] = *x;
                }
            }
        }
    }
}

/// Subtracts so many times the factors of four columns from some rows, in their order.
#[inline(always)]
fn subtract_lanes<S: Simd>(
    rows: &mut [Lanes<S>],
    [a, b, c, d]: [&[f64]; 4],
    times: &[Lanes<S>; 4],
) {
    let factors = a.iter().zip(b).zip(c).zip(d);
    for (x, (((a, b), c), d)) in rows.iter_mut().zip(factors) {
        *x = *x - times[0] * *a - times[1] * *b - times[2] * *c - times[3] * *d;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_side_by_side_are_those_one_by_one() {
        let noise = |k: usize| ((k * k + 7) as f64).sin();
        for n in (0..=13).chain([40]) {
            let a: Vec<f64> = (0..n * n).map(noise).collect();
            let mut lu = DenseLu::default();
            lu.factor(n, &a).unwrap();
            for count in [0, 1, 7, 8, 19] {
                let column = |c: usize| (0..n).map(|i| noise(1000 + c * n + i)).collect();
                let columns: Vec<Vec<f64>> = (0..count).map(column).collect();
                let mut single = columns.clone();
                single.iter_mut().for_each(|b| lu.solve(b));
                let bits = |columns: &[Vec<f64>]| -> Vec<u64> {
                    columns.iter().flatten().map(|x| x.to_bits()).collect()
                };
                for width in [Width::Widest, Width::Avx2, Width::One] {
                    let mut together = columns.clone();
                    width.dispatch(SolveColumns { lu: &lu, columns: &mut together });
                    assert_eq!(bits(&together), bits(&single), "{n} {count} {width:?}");
                }
            }
        }
    }
}
