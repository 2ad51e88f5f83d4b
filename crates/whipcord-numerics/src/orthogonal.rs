//! Orthogonal factors of dense matrices with few columns.

use crate::dense::separating_rotation;

/// Makes the `rows`×`columns` matrix `a`, by rows, upper triangular by Householder's reflections and applies
/// the same to `b`: `a = Q R` leaves `R` in the first rows of `a` and `Qᵀ b` in `b`. A column that depends on
/// those before it leaves a zero, to rounding, on the diagonal.
///
/// `reflected` is scratch.
///
/// Source: Golub and Van Loan, Matrix Computations, 4th ed. (2013), algorithms 5.1.1 and 5.2.1.
pub(crate) fn triangularise(
    columns: usize,
    a: &mut [f64],
    b: &mut [f64],
    reflected: &mut Vec<f64>,
) {
    let rows = b.len();
    debug_assert_eq!(a.len(), rows * columns);
    reflected.clear();
    reflected.resize(columns, 0.0);
    for k in 0..columns.min(rows) {
        let size = norm((k..rows).map(|i| a[i * columns + k]));
        if size == 0.0 {
            continue;
        }
        let diagonal = a[k * columns + k];
        // v = x + sign(x₁) ‖x‖ e₁, so that nothing cancels.
        let first = diagonal + size.copysign(diagonal);
        a[k * columns + k] = first;
        // 2 / vᵀv
        let factor = 1.0 / (size * first.abs());
        reflected[k + 1..].fill(0.0);
        let mut along = 0.0;
        for (row, value) in a.chunks_exact(columns).zip(&*b).skip(k) {
            let v = row[k];
            along += v * value;
            for (sum, entry) in reflected[k + 1..].iter_mut().zip(&row[k + 1..]) {
                *sum += v * entry;
            }
        }
        along *= factor;
        for (row, value) in a.chunks_exact_mut(columns).zip(&mut *b).skip(k) {
            let v = row[k];
            *value -= v * along;
            for (entry, sum) in row[k + 1..].iter_mut().zip(&reflected[k + 1..]) {
                *entry -= v * factor * sum;
            }
            row[k] = 0.0;
        }
        a[k * columns + k] = -size.copysign(diagonal);
    }
}

/// Euclid's norm, without overflow on the way.
pub(crate) fn norm(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = values.clone().map(f64::abs).fold(0.0, f64::max);
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * values.map(|x| (x / largest) * (x / largest)).sum::<f64>().sqrt()
}

/// Singular values of a dense matrix with few columns, and the directions among its columns that belong to
/// them.
///
/// ```
/// use whipcord_numerics::SingularValues;
/// // The columns are seen by their sum alone.
/// let seen = SingularValues::of(2, &[1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
/// assert!((seen.values[0] - 28f64.sqrt()).abs() < 1e-14 && seen.values[1] < 1e-15);
/// let unseen = seen.direction(1);
/// assert!((unseen[0] + unseen[1]).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SingularValues {
    /// The singular values, the largest first; as many as there are columns.
    pub values: Vec<f64>,
    /// The right singular vectors one after the other, in the order of the values.
    directions: Vec<f64>,
}

/// Sweeps after which rounding must be what keeps the rotations going.
const SWEEPS: usize = 40;

impl SingularValues {
    /// Of the matrix with so many columns whose rows are `a`.
    ///
    /// Jacobi's rotations are applied to the triangular factor from one side, which keeps small values
    /// accurate relative to the columns they come from (Demmel and Veselić, SIAM J. Matrix Anal. Appl. 13
    /// (1992) 1204).
    #[must_use]
    pub fn of(columns: usize, a: &[f64]) -> Self {
        let n = columns;
        let rows = a.len().checked_div(n).unwrap_or(0);
        let mut reduced = a.to_vec();
        triangularise(n, &mut reduced, &mut vec![0.0; rows], &mut Vec::new());
        reduced.truncate(rows.min(n) * n);
        // Column j of the factor and of the rotations, as row j.
        let height = rows.min(n);
        let mut factor = vec![0.0; n * height];
        let mut turned = vec![0.0; n * n];
        for j in 0..n {
            turned[j * n + j] = 1.0;
            for i in 0..height {
                factor[j * height + i] = reduced[i * n + j];
            }
        }
        for _ in 0..SWEEPS {
            let mut still = true;
            for i in 0..n {
                for j in i + 1..n {
                    if let Some((cos, sin)) = separating(&factor, height, i, j) {
                        still = false;
                        rotate_rows(&mut factor, height, i, j, cos, sin);
                        rotate_rows(&mut turned, n, i, j, cos, sin);
                    }
                }
            }
            if still {
                break;
            }
        }
        let length = |j: usize| norm(factor[j * height..(j + 1) * height].iter().copied());
        let mut order: Vec<(usize, f64)> = (0..n).map(|j| (j, length(j))).collect();
        order.sort_by(|x, y| y.1.total_cmp(&x.1));
        Self {
            values: order.iter().map(|&(_, value)| value).collect(),
            directions: order
                .iter()
                .flat_map(|&(j, _)| turned[j * n..(j + 1) * n].iter().copied())
                .collect(),
        }
    }

    /// The unit vector among the columns that belongs to value `k`.
    #[must_use]
    pub fn direction(&self, k: usize) -> &[f64] {
        let n = self.values.len();
        &self.directions[k * n..(k + 1) * n]
    }
}

/// Cosine and sine of the rotation that makes columns `i` and `j` orthogonal; none where they are.
fn separating(factor: &[f64], height: usize, i: usize, j: usize) -> Option<(f64, f64)> {
    let (x, y) = (&factor[i * height..(i + 1) * height], &factor[j * height..(j + 1) * height]);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (xx, yy, xy) = (dot(x, x), dot(y, y), dot(x, y));
    let least = f64::EPSILON * xx.sqrt() * yy.sqrt();
    if xy.is_nan() || xy.abs() <= least.max(f64::MIN_POSITIVE) {
        return None;
    }
    Some(separating_rotation(xx, yy, xy))
}

fn rotate_rows(a: &mut [f64], length: usize, i: usize, j: usize, cos: f64, sin: f64) {
    let (before, after) = a.split_at_mut(j * length);
    let (x, y) = (&mut before[i * length..(i + 1) * length], &mut after[..length]);
    for (x, y) in x.iter_mut().zip(y) {
        (*x, *y) = (cos * *x - sin * *y, sin * *x + cos * *y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product(columns: usize, a: &[f64], x: &[f64]) -> Vec<f64> {
        a.chunks_exact(columns).map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
    }

    #[test]
    fn a_triangular_factor_keeps_norms_and_products() {
        let (rows, columns) = (7, 4);
        let a: Vec<f64> =
            (0..rows * columns).map(|k| ((k * k * 7 + 3) % 11) as f64 - 4.5).collect();
        let b: Vec<f64> = (0..rows).map(|i| (i as f64).sin() + 0.2).collect();
        let (mut r, mut c) = (a.clone(), b.clone());
        triangularise(columns, &mut r, &mut c, &mut Vec::new());
        for (i, row) in r.chunks_exact(columns).enumerate() {
            assert!(row.iter().take(i).all(|&entry| entry == 0.0));
        }
        // AᵀA = RᵀR and Aᵀb = Rᵀ(Qᵀb).
        for i in 0..columns {
            let column = |m: &[f64], j: usize| -> Vec<f64> {
                m.chunks_exact(columns).map(|row| row[j]).collect()
            };
            let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            for j in 0..columns {
                let (before, after) =
                    (dot(&column(&a, i), &column(&a, j)), dot(&column(&r, i), &column(&r, j)));
                assert!((before - after).abs() < 1e-12 * (1.0 + before.abs()));
            }
            let (before, after) = (dot(&column(&a, i), &b), dot(&column(&r, i), &c));
            assert!((before - after).abs() < 1e-12);
        }
    }

    #[test]
    fn singular_values_of_a_hilbert_matrix() {
        let n = 5;
        let a: Vec<f64> = (0..n * n).map(|k| 1.0 / (1 + k / n + k % n) as f64).collect();
        let found = SingularValues::of(n, &a);
        // It is positive definite: its trace and its determinant, 1/266716800000, are the sum and the
        // product of these values.
        let trace = (0..n).map(|i| a[i * n + i]).sum::<f64>();
        assert!((found.values.iter().sum::<f64>() - trace).abs() < 1e-14);
        let product_of_all: f64 = found.values.iter().product();
        assert!((product_of_all * 266_716_800_000.0 - 1.0).abs() < 1e-9);
        for k in 0..n {
            let direction = found.direction(k);
            for (image, entry) in product(n, &a, direction).iter().zip(direction) {
                assert!((image - found.values[k] * entry).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn fewer_rows_than_columns_leave_directions_unseen() {
        let found = SingularValues::of(3, &[3.0, 0.0, 4.0]);
        assert!((found.values[0] - 5.0).abs() < 1e-15);
        assert_eq!(found.values[1..], [0.0, 0.0]);
        for k in 1..3 {
            assert!(product(3, &[3.0, 0.0, 4.0], found.direction(k))[0].abs() < 1e-15);
        }
    }
}
