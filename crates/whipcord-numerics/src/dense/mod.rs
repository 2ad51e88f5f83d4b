mod columns;

use pulp::{Arch, Simd, WithSimd};

/// The matrix has no usable pivot in this column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Singular {
    /// Column, from 0, at which the elimination stopped.
    pub column: usize,
}

/// LU factors with partial pivoting of a small dense matrix, in a buffer that is kept between uses.
///
/// ```
/// use whipcord_numerics::DenseLu;
/// let mut lu = DenseLu::default();
/// lu.factor(2, &[0.0, 2.0, 1.0, 1.0])?; // by rows
/// let mut x = [2.0, 3.0];
/// lu.solve(&mut x);
/// assert_eq!(x, [2.0, 1.0]);
/// # Ok::<(), whipcord_numerics::Singular>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct DenseLu {
    n: usize,
    /// By columns, so that the loops within a column, which do not wait for one another, are vectorised.
    factors: Vec<f64>,
    pivots: Vec<usize>,
    scales: Vec<f64>,
}

/// Subtracts so many times the factors.
#[inline(always)]
fn subtract(from: &mut [f64], factors: &[f64], times: f64) {
    from.iter_mut().zip(factors).for_each(|(x, factor)| *x -= factor * times);
}

/// How many columns of factors are applied to a column at once: it is then loaded and stored once instead of four times.
const BLOCK: usize = 4;
/// Columns of a large matrix that are eliminated side by side, so that the factors before them are loaded once for several.
const PANEL: usize = 16;
/// From this size on a matrix is large.
const LARGE: usize = 100;
/// Rows of a column that are in registers together.
const ROWS: usize = 8;

/// The elimination of a matrix by columns, with the instructions that the processor has. Each entry takes the factors in the order
/// of their columns and none of the sums is fused: the bits do not depend on the processor.
struct Eliminate<'a> {
    n: usize,
    factors: &'a mut [f64],
    /// Greatest entry of each column.
    scales: &'a [f64],
    pivots: &'a mut Vec<usize>,
}

impl WithSimd for Eliminate<'_> {
    type Output = Result<(), Singular>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { n, factors, scales, pivots } = self;
        // The factors of a smaller matrix are near anyway.
        let most = if n < LARGE { n.max(1) } else { PANEL };
        for first in (0..n).step_by(most) {
            let (done, rest) = factors.split_at_mut(first * n);
            let width = most.min(n - first);
            let panel = &mut rest[..width * n];
            for column in panel.chunks_exact_mut(n) {
                for (i, &pivot) in pivots.iter().enumerate() {
                    column.swap(i, pivot);
                }
            }
            forward_panel(done, n, panel);
            for k in first..first + width {
                let (before, rest) = panel.split_at_mut((k - first) * n);
                let column = &mut rest[..n];
                for (i, &pivot) in pivots.iter().enumerate().skip(first) {
                    column.swap(i, pivot);
                }
                forward(before, n, first, column);
                let mut pivot = k;
                for i in k + 1..n {
                    if column[i].abs() > column[pivot].abs() {
                        pivot = i;
                    }
                }
                let value = column[pivot];
                if value.is_nan() || value.abs() <= 0.25 * f64::EPSILON * scales[k] {
                    return Err(Singular { column: k });
                }
                pivots.push(pivot);
                column.swap(k, pivot);
                if pivot != k {
                    before.chunks_exact_mut(n).for_each(|column| column.swap(k, pivot));
                    done.chunks_exact_mut(n).for_each(|column| column.swap(k, pivot));
                }
                column[k + 1..].iter_mut().for_each(|factor| *factor /= value);
            }
        }
        Ok(())
    }
}

/// Forward substitution of the columns of a panel with these columns of factors, whose number is a multiple of [`BLOCK`]: factors
/// that are loaded once serve four columns.
#[inline(always)]
fn forward_panel(factors: &[f64], n: usize, panel: &mut [f64]) {
    let mut fours = panel.chunks_exact_mut(4 * n);
    for four in &mut fours {
        let (low, high) = four.split_at_mut(2 * n);
        let ((x0, x1), (x2, x3)) = (low.split_at_mut(n), high.split_at_mut(n));
        for (b, block) in factors.chunks_exact(BLOCK * n).enumerate() {
            let k = BLOCK * b;
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| &block[i * n + k..(i + 1) * n]);
            let times = [&mut *x0, &mut *x1, &mut *x2, &mut *x3]
                .map(|x| substitute_block([a, b, c], &mut x[k..]));
            let [a, b, c, d] = [a, b, c, d].map(|factors| factors[BLOCK..].as_chunks::<ROWS>());
            let below = k + BLOCK;
            let [x0, x1, x2, x3] = [&mut *x0, &mut *x1, &mut *x2, &mut *x3]
                .map(|x| x[below..].as_chunks_mut::<ROWS>());
            let rows = x0.0.iter_mut().zip(x1.0).zip(x2.0).zip(x3.0);
            let factors = a.0.iter().zip(b.0).zip(c.0).zip(d.0);
            for ((((x0, x1), x2), x3), (((a, b), c), d)) in rows.zip(factors) {
                for (x, times) in [x0, x1, x2, x3].into_iter().zip(&times) {
                    *x = four_times(*x, [a, b, c, d], times);
                }
            }
            for (x, times) in [x0.1, x1.1, x2.1, x3.1].into_iter().zip(&times) {
                let factors = a.1.iter().zip(b.1).zip(c.1).zip(d.1);
                for (x, (((a, b), c), d)) in x.iter_mut().zip(factors) {
                    *x = *x - a * times[0] - b * times[1] - c * times[2] - d * times[3];
                }
            }
        }
    }
    for column in fours.into_remainder().chunks_exact_mut(n) {
        forward(factors, n, 0, column);
    }
}

/// Forward substitution of a column within a block of [`BLOCK`] columns of factors, from the first row of the block on: how many times it
/// takes each of them.
#[inline(always)]
fn substitute_block([a, b, c]: [&[f64]; 3], below: &mut [f64]) -> [f64; BLOCK] {
    let first = below[0];
    below[1] -= a[1] * first;
    let second = below[1];
    below[2] = below[2] - a[2] * first - b[2] * second;
    let third = below[2];
    below[3] = below[3] - a[3] * first - b[3] * second - c[3] * third;
    [first, second, third, below[3]]
}

/// Some rows of a column, less so many times those of four columns of factors.
#[inline(always)]
fn four_times(
    mut x: [f64; ROWS],
    [a, b, c, d]: [&[f64; ROWS]; 4],
    times: &[f64; 4],
) -> [f64; ROWS] {
    for i in 0..ROWS {
        x[i] = x[i] - a[i] * times[0] - b[i] * times[1] - c[i] * times[2] - d[i] * times[3];
    }
    x
}

/// Forward substitution of a column with these columns of unit lower factors, of which the first is that of row `k`.
#[inline(always)]
fn forward(factors: &[f64], n: usize, mut k: usize, column: &mut [f64]) {
    let mut blocks = factors.chunks_exact(BLOCK * n.max(1));
    for block in &mut blocks {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| &block[i * n + k..(i + 1) * n]);
        let below = &mut column[k..];
        let [first, second, third, fourth] = substitute_block([a, b, c], below);
        let [a, b, c, d] = [a, b, c, d].map(|factors| &factors[BLOCK..]);
        for ((((x, a), b), c), d) in below[BLOCK..].iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *x = *x - a * first - b * second - c * third - d * fourth;
        }
        k += BLOCK;
    }
    for factors in blocks.remainder().chunks_exact(n.max(1)) {
        let (above, below) = column.split_at_mut(k + 1);
        subtract(below, &factors[k + 1..], above[k]);
        k += 1;
    }
}

impl DenseLu {
    /// Factors the `n`×`n` matrix `a`, given by rows.
    ///
    /// # Errors
    /// [`Singular`] when a column has no pivot above rounding.
    pub fn factor(&mut self, n: usize, a: &[f64]) -> Result<(), Singular> {
        debug_assert_eq!(a.len(), n * n);
        self.n = n;
        self.pivots.clear();
        self.scales.clear();
        self.scales.resize(n, 0.0);
        self.factors.resize(n * n, 0.0);
        let (m, scales) = (&mut self.factors[..n * n], &mut self.scales);
        for (i, row) in a.chunks_exact(n.max(1)).enumerate() {
            for (j, (x, scale)) in row.iter().zip(&mut *scales).enumerate() {
                m[j * n + i] = *x;
                *scale = scale.max(x.abs());
            }
        }
        Arch::new().dispatch(Eliminate { n, factors: m, scales, pivots: &mut self.pivots })
    }

    /// The size of the least pivot: that of a matrix which is all but singular is small, beside its entries.
    #[must_use]
    pub fn least_pivot(&self) -> f64 {
        (0..self.n).map(|k| self.factors[k * self.n + k].abs()).fold(f64::INFINITY, f64::min)
    }

    /// Whether the determinant of the matrix is negative.
    #[must_use]
    pub fn is_determinant_negative(&self) -> bool {
        let swaps = self.pivots.iter().enumerate().filter(|&(k, &pivot)| k != pivot).count();
        let negative = (0..self.n).filter(|&k| self.factors[k * self.n + k] < 0.0).count();
        (swaps + negative) % 2 == 1
    }

    /// Overwrites `b` by the solution of `A x = b`.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.n;
        debug_assert_eq!(b.len(), n);
        for k in 0..n {
            b.swap(k, self.pivots[k]);
        }
        forward(&self.factors[..n * n], n, 0, b);
        for (k, factors) in self.factors.chunks_exact(n.max(1)).enumerate().rev() {
            let (above, below) = b.split_at_mut(k);
            below[0] /= factors[k];
            subtract(above, factors, below[0]);
        }
    }
}

/// The eigenvalues of a symmetric `n`×`n` matrix, given by rows and overwritten, in no particular
/// order: by Jacobi's rotations, each accurate to rounding relative to the largest.
///
/// ```
/// use whipcord_numerics::symmetric_eigenvalues;
/// let mut matrix = [2.0, 1.0, 1.0, 2.0];
/// let mut values: Vec<f64> = symmetric_eigenvalues(2, &mut matrix).collect();
/// values.sort_by(f64::total_cmp);
/// assert!((values[0] - 1.0).abs() < 1e-15 && (values[1] - 3.0).abs() < 1e-15);
/// ```
pub fn symmetric_eigenvalues(n: usize, a: &mut [f64]) -> impl ExactSizeIterator<Item = f64> + '_ {
    diagonalize(n, a, |_, _, _, _| ());
    let a = &*a;
    (0..n).map(move |i| a[i * n + i])
}

/// The same with the unit eigenvector of each value, which are written into the rows of `vectors`, an `n`×`n` matrix as well.
///
/// ```
/// use whipcord_numerics::symmetric_eigen;
/// let (mut matrix, mut vectors) = ([2.0, 1.0, 1.0, 2.0], [0.0; 4]);
/// let values: Vec<f64> = symmetric_eigen(2, &mut matrix, &mut vectors).collect();
/// let sum = vectors[0] + vectors[1];
/// assert!((values[0] - if sum.abs() > 1.0 { 3.0 } else { 1.0 }).abs() < 1e-15);
/// ```
pub fn symmetric_eigen<'a>(
    n: usize,
    a: &'a mut [f64],
    vectors: &mut [f64],
) -> impl ExactSizeIterator<Item = f64> + use<'a> {
    debug_assert_eq!(vectors.len(), n * n);
    vectors.fill(0.0);
    for i in 0..n {
        vectors[i * n + i] = 1.0;
    }
    diagonalize(n, a, |i, j, cos, sin| {
        for k in 0..n {
            let (x, y) = (vectors[i * n + k], vectors[j * n + k]);
            vectors[i * n + k] = cos * x - sin * y;
            vectors[j * n + k] = sin * x + cos * y;
        }
    });
    let a = &*a;
    (0..n).map(move |i| a[i * n + i])
}

/// Makes a symmetric matrix diagonal; `rotated` is told the plane of each rotation, its cosine and its sine.
fn diagonalize(n: usize, a: &mut [f64], mut rotated: impl FnMut(usize, usize, f64, f64)) {
    const SWEEPS: usize = 30;
    debug_assert_eq!(a.len(), n * n);
    for _ in 0..SWEEPS {
        let sum = |off: bool, a: &[f64]| -> f64 {
            (0..n * n).filter(|k| (k / n != k % n) == off).map(|k| a[k].abs()).sum()
        };
        let (off, size) = (sum(true, a), sum(false, a));
        // Written so that a NaN ends the loop as well.
        if off.is_nan() || off <= 0.25 * f64::EPSILON * size {
            break;
        }
        for i in 0..n {
            for j in i + 1..n {
                if let Some((cos, sin)) = rotate_away(n, a, i, j) {
                    rotated(i, j, cos, sin);
                }
            }
        }
    }
}

/// Cosine and sine of Jacobi's rotation that makes the symmetric block of `xx`, `yy` and `xy` diagonal.
pub(crate) fn separating_rotation(xx: f64, yy: f64, xy: f64) -> (f64, f64) {
    let half = 0.5 * (yy - xx) / xy;
    let tan = 1.0_f64.copysign(half) / (half.abs() + half.hypot(1.0));
    let cos = 1.0 / (1.0 + tan * tan).sqrt();
    (cos, tan * cos)
}

/// One Jacobi rotation in the plane of `i < j`: its cosine and sine, where one is needed.
fn rotate_away(n: usize, a: &mut [f64], i: usize, j: usize) -> Option<(f64, f64)> {
    let off = a[i * n + j];
    if off == 0.0 {
        return None;
    }
    let (cos, sin) = separating_rotation(a[i * n + i], a[j * n + j], off);
    for k in 0..n {
        let (x, y) = (a[k * n + i], a[k * n + j]);
        a[k * n + i] = cos * x - sin * y;
        a[k * n + j] = sin * x + cos * y;
    }
    for k in 0..n {
        let (x, y) = (a[i * n + k], a[j * n + k]);
        a[i * n + k] = cos * x - sin * y;
        a[j * n + k] = sin * x + cos * y;
    }
    a[i * n + j] = 0.0;
    a[j * n + i] = 0.0;
    Some((cos, sin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_hilbert_like_system() {
        let n = 6;
        let a: Vec<f64> =
            (0..n * n).map(|k| 1.0 / (1.0 + (k / n) as f64 + (k % n) as f64)).collect();
        let x: Vec<f64> = (0..n).map(|i| i as f64 - 2.0).collect();
        let mut b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| a[i * n + j] * x[j]).sum()).collect();
        let mut lu = DenseLu::default();
        lu.factor(n, &a).unwrap();
        lu.solve(&mut b);
        for i in 0..n {
            assert!((b[i] - x[i]).abs() < 1e-9);
        }
    }

    #[test]
    fn the_sign_of_the_determinant() {
        let mut lu = DenseLu::default();
        for (matrix, negative) in [
            ([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], false),
            ([0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0], true),
            ([0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0], false),
            ([1.0, 5.0, 2.0, 3.0, 1.0, 1.0, 2.0, 7.0, -3.0], false),
            ([-2.0, 1.0, 0.0, 1.0, 2.0, 1.0, 0.0, 1.0, 3.0], true),
        ] {
            lu.factor(3, &matrix).unwrap();
            assert_eq!(lu.is_determinant_negative(), negative, "{matrix:?}");
        }
    }

    #[test]
    fn eigenvalues_of_the_second_difference() {
        // 2 − 2 cos(kπ/(n+1)).
        let n = 7;
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            a[i * n + i] = 2.0;
            if i + 1 < n {
                a[i * n + i + 1] = -1.0;
                a[(i + 1) * n + i] = -1.0;
            }
        }
        let mut values: Vec<f64> = symmetric_eigenvalues(n, &mut a).collect();
        values.sort_by(f64::total_cmp);
        for (k, value) in values.iter().enumerate() {
            let angle = (k + 1) as f64 * core::f64::consts::PI / (n + 1) as f64;
            assert!((value - (2.0 - 2.0 * angle.cos())).abs() < 1e-14);
        }
    }

    #[test]
    fn eigenvectors_keep_their_direction() {
        let n = 9;
        let noise = |k: usize| ((k * k + 7) as f64).sin();
        let entry = |i: usize, j: usize| noise(i.max(j) * n + i.min(j));
        let matrix: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let mut vectors = vec![0.0; n * n];
        let mut work = matrix.clone();
        let values: Vec<f64> = symmetric_eigen(n, &mut work, &mut vectors).collect();
        for (value, x) in values.iter().zip(vectors.chunks(n)) {
            assert!((x.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14);
            for i in 0..n {
                let row: f64 = (0..n).map(|j| matrix[i * n + j] * x[j]).sum();
                assert!((row - value * x[i]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn singular_and_nan_are_refused() {
        let mut lu = DenseLu::default();
        assert_eq!(lu.factor(2, &[1.0, 2.0, 2.0, 4.0]), Err(Singular { column: 1 }));
        assert_eq!(lu.factor(1, &[f64::NAN]), Err(Singular { column: 0 }));
    }
}
