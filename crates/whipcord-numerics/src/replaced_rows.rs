use crate::dense::{DenseLu, Singular};
use crate::dot::dot;

/// Of the right-hand side: a solution that leaves more is found with factors of its own.
const RESIDUAL: f64 = 1e-12;

/// Linear systems one after the other, of which each differs from the one before in few rows: the factors of the first serve the next
/// ones as well (Sherman, Morrison and Woodbury's formula), as long as that is exact to rounding.
///
/// ```
/// use whipcord_numerics::ReplacedRows;
/// let mut system = ReplacedRows::default();
/// let mut x = [2.0, 3.0];
/// system.solve(&[0.0, 2.0, 1.0, 1.0], &mut x)?; // by rows
/// assert_eq!(x, [2.0, 1.0]);
/// let mut x = [2.0, 3.0];
/// system.solve(&[0.0, 2.0, 1.0, 2.0], &mut x)?;
/// assert_eq!(x, [1.0, 1.0]);
/// # Ok::<(), whipcord_numerics::Singular>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct ReplacedRows {
    lu: DenseLu,
    /// The matrix of the factors; empty where there are none.
    matrix: Vec<f64>,
    rows: Vec<usize>,
    given: Vec<f64>,
    /// Of the inverse, by the row that was replaced; empty where none was.
    columns: Vec<Vec<f64>>,
    /// What is added to a row of the matrix of the factors.
    added: Vec<f64>,
    small: Vec<f64>,
    small_lu: DenseLu,
}

/// Which factors a system was solved with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Factors {
    /// Those of an earlier system.
    Kept,
    /// Its own.
    New,
}

impl ReplacedRows {
    /// Forgets the factors, so that what follows does not depend on what was solved before.
    pub fn forget(&mut self) {
        self.matrix.clear();
    }

    /// Overwrites `b` by the solution of `A x = b`, with `a` given by rows, and tells which factors that took.
    ///
    /// # Errors
    /// [`Singular`] when a column has no pivot above rounding.
    pub fn solve(&mut self, a: &[f64], b: &mut [f64]) -> Result<Factors, Singular> {
        let n = b.len();
        debug_assert_eq!(a.len(), n * n);
        if self.matrix.len() == a.len() {
            let rows = self.matrix.chunks_exact(n).zip(a.chunks_exact(n)).enumerate();
            self.rows.clear();
            self.rows.extend(rows.filter(|(_, (old, new))| old != new).map(|(row, _)| row));
            if self.rows.is_empty() {
                self.lu.solve(b);
                return Ok(Factors::Kept);
            }
            // From about here on, factors cost less.
            if 4 * self.rows.len() <= n {
                self.given.clear();
                self.given.extend_from_slice(b);
                if self.replace(a, b) && self.is_exact(a, b) {
                    return Ok(Factors::Kept);
                }
                b.copy_from_slice(&self.given);
            }
        }
        self.matrix.clear();
        self.lu.factor(n, a)?;
        self.matrix.extend_from_slice(a);
        self.columns.iter_mut().for_each(Vec::clear);
        self.columns.resize(n, Vec::new());
        self.lu.solve(b);
        Ok(Factors::New)
    }

    /// With the rows `D` that are added to the matrix of the factors, `x = y − Z s` with `A y = b`, the columns `Z` of the inverse, and
    /// `(1 + D Z) s = D y`; `false` where that is singular.
    fn replace(&mut self, a: &[f64], b: &mut [f64]) -> bool {
        let Self { lu, matrix, rows, columns, added, small, small_lu, .. } = self;
        let (n, count) = (b.len(), rows.len());
        lu.solve(b);
        for &row in &*rows {
            let column = &mut columns[row];
            if column.is_empty() {
                column.resize(n, 0.0);
                column[row] = 1.0;
                lu.solve(column);
            }
        }
        small.clear();
        let mut parts = Vec::with_capacity(count);
        for (i, &row) in rows.iter().enumerate() {
            let of = row * n..(row + 1) * n;
            added.clear();
            added.extend(a[of.clone()].iter().zip(&matrix[of]).map(|(new, old)| new - old));
            let unit = |j: usize| if i == j { 1.0 } else { 0.0 };
            let columns = rows.iter().map(|&of| &columns[of]).enumerate();
            small.extend(columns.map(|(j, column)| unit(j) + dot(added, column)));
            parts.push(dot(added, b));
        }
        if small_lu.factor(count, small).is_err() {
            return false;
        }
        small_lu.solve(&mut parts);
        for (part, &row) in parts.iter().zip(&*rows) {
            let column = &columns[row];
            b.iter_mut().zip(column).for_each(|(x, z)| *x -= part * z);
        }
        true
    }

    /// Whether a solution leaves nothing but rounding of the given right-hand side.
    fn is_exact(&self, a: &[f64], x: &[f64]) -> bool {
        let greatest = self.given.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        a.chunks_exact(x.len())
            .zip(&self.given)
            .all(|(row, b)| (dot(row, x) - b).abs() <= RESIDUAL * greatest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(k: usize) -> f64 {
        ((k * k + 7) as f64).sin()
    }

    /// The same as with factors of its own, for any number of replaced rows.
    #[test]
    fn replaced_rows_give_the_solution_of_the_new_matrix() {
        let n = 21;
        let mut a: Vec<f64> = (0..n * n).map(noise).collect();
        let b: Vec<f64> = (0..n).map(|i| noise(900 + i)).collect();
        let mut system = ReplacedRows::default();
        system.solve(&a, &mut b.clone()).unwrap();
        for row in [3, 17, 0, 20, 8, 9, 10] {
            for column in 0..n {
                a[row * n + column] = noise(5000 + 31 * row + column);
            }
            let (mut x, mut exact) = (b.clone(), b.clone());
            system.solve(&a, &mut x).unwrap();
            let mut lu = DenseLu::default();
            lu.factor(n, &a).unwrap();
            lu.solve(&mut exact);
            for (x, exact) in x.iter().zip(&exact) {
                assert!((x - exact).abs() < 1e-9 * (1.0 + exact.abs()), "{row}: {x} {exact}");
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_refused_and_forgotten() {
        let regular =
            [2.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 4.0];
        let mut singular = regular;
        singular[5] = 0.0;
        let mut system = ReplacedRows::default();
        let mut x = [2.0, 3.0, 1.0, 4.0];
        system.solve(&regular, &mut x).unwrap();
        assert_eq!(x, [1.0; 4]);
        assert!(system.solve(&singular, &mut [1.0; 4]).is_err());
        let mut x = [2.0, 3.0, 1.0, 4.0];
        system.solve(&regular, &mut x).unwrap();
        assert_eq!(x, [1.0; 4]);
    }
}
