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
    /// The rows that were replaced since, in no order, and the place of each row among them.
    rows: Vec<usize>,
    places: Vec<Option<usize>>,
    /// What is added to each of these rows of the matrix of the factors.
    added: Vec<Vec<f64>>,
    /// The product of what is added to a row with a column of the inverse, by their places; rows of so many.
    products: Vec<f64>,
    most: usize,
    /// Of the inverse, by the row that was replaced; empty where none was.
    columns: Vec<Vec<f64>>,
    /// The last right-hand side, and its solution with the matrix of the factors.
    given: Vec<f64>,
    solved: Vec<f64>,
    all: Vec<usize>,
    small: Vec<f64>,
    parts: Vec<f64>,
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
        let mut all = core::mem::take(&mut self.all);
        all.clear();
        all.extend(0..b.len());
        let solved = self.solve_changed(a, &all, b);
        self.all = all;
        solved
    }

    /// The same where at most these rows of the matrix differ from those of the last system.
    ///
    /// # Errors
    /// [`Singular`] when a column has no pivot above rounding.
    pub fn solve_changed(
        &mut self,
        a: &[f64],
        changed: &[usize],
        b: &mut [f64],
    ) -> Result<Factors, Singular> {
        let n = b.len();
        debug_assert_eq!(a.len(), n * n);
        if !self.matrix.is_empty() && self.matrix.len() == a.len() {
            // From about here on, factors cost less.
            if self.note_changes(a, changed) && self.replace(a, b) {
                return Ok(Factors::Kept);
            }
        }
        self.matrix.clear();
        self.lu.factor(n, a)?;
        self.matrix.extend_from_slice(a);
        self.rows.clear();
        self.places.clear();
        self.places.resize(n, None);
        self.most = n / 4;
        self.products.resize(self.most * self.most, 0.0);
        self.added.resize(self.most, Vec::new());
        self.columns.iter_mut().for_each(Vec::clear);
        self.columns.resize(n, Vec::new());
        self.given.clear();
        self.given.extend_from_slice(b);
        self.lu.solve(b);
        self.solved.clear();
        self.solved.extend_from_slice(b);
        Ok(Factors::New)
    }

    /// Takes over which rows are replaced and by what; `false` where they are too many.
    fn note_changes(&mut self, a: &[f64], changed: &[usize]) -> bool {
        let n = self.places.len();
        for &row in changed {
            let of = row * n..(row + 1) * n;
            let (old, new) = (&self.matrix[of.clone()], &a[of]);
            match (self.places[row], old == new) {
                (None, true) => {}
                (Some(place), true) => self.put_back(place),
                (Some(place), false) => {
                    let differs = |(added, (new, old)): (&f64, (&f64, &f64))| *added != new - old;
                    if self.added[place].iter().zip(new.iter().zip(old)).any(differs) {
                        self.put(place, a);
                    }
                }
                (None, false) => {
                    let place = self.rows.len();
                    if place == self.most {
                        return false;
                    }
                    self.rows.push(row);
                    self.places[row] = Some(place);
                    let column = &mut self.columns[row];
                    if column.is_empty() {
                        column.resize(n, 0.0);
                        column[row] = 1.0;
                        self.lu.solve(column);
                    }
                    for other in 0..place {
                        self.products[other * self.most + place] =
                            dot(&self.added[other], &self.columns[row]);
                    }
                    self.put(place, a);
                }
            }
        }
        true
    }

    /// What is added to the row at a place.
    fn put(&mut self, place: usize, a: &[f64]) {
        let Self { matrix, rows, places, added, products, most, columns, .. } = self;
        let of = rows[place] * places.len()..(rows[place] + 1) * places.len();
        let added = &mut added[place];
        added.clear();
        added.extend(a[of.clone()].iter().zip(&matrix[of]).map(|(new, old)| new - old));
        for (product, row) in products[place * *most..].iter_mut().zip(&*rows) {
            *product = dot(added, &columns[*row]);
        }
    }

    /// The row at a place is that of the factors again; the last one comes to its place.
    fn put_back(&mut self, place: usize) {
        let last = self.rows.len() - 1;
        self.places[self.rows[last]] = Some(place);
        self.places[self.rows[place]] = None;
        self.rows.swap_remove(place);
        self.added.swap(place, last);
        for other in 0..=last {
            self.products[place * self.most + other] = self.products[last * self.most + other];
        }
        for other in 0..=last {
            self.products[other * self.most + place] = self.products[other * self.most + last];
        }
    }

    /// With the rows `D` that are added to the matrix of the factors, `x = y − Z s` with `A y = b`, the columns `Z` of the inverse, and
    /// `(1 + D Z) s = D y`; `false` where that is singular or not exact, with the right-hand side as it was.
    fn replace(&mut self, a: &[f64], b: &mut [f64]) -> bool {
        let Self {
            lu,
            rows,
            columns,
            added,
            products,
            most,
            small,
            small_lu,
            given,
            solved,
            parts,
            ..
        } = self;
        if *b != given[..] {
            given.clear();
            given.extend_from_slice(b);
            solved.clear();
            solved.extend_from_slice(b);
            lu.solve(solved);
        }
        b.copy_from_slice(solved);
        let count = rows.len();
        if count == 0 {
            return true;
        }
        small.clear();
        parts.clear();
        for (i, added) in added[..count].iter().enumerate() {
            small.extend_from_slice(&products[i * *most..][..count]);
            small[i * count + i] += 1.0;
            parts.push(dot(added, b));
        }
        let regular = small_lu.factor(count, small).is_ok();
        if regular {
            small_lu.solve(parts);
            for (part, &row) in parts.iter().zip(&*rows) {
                let column = &columns[row];
                b.iter_mut().zip(column).for_each(|(x, z)| *x -= part * z);
            }
        }
        if !regular || !self.is_exact(a, b) {
            b.copy_from_slice(&self.given);
            return false;
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
        let first: Vec<f64> = (0..n * n).map(noise).collect();
        let mut a = first.clone();
        let mut b: Vec<f64> = (0..n).map(|i| noise(900 + i)).collect();
        let mut system = ReplacedRows::default();
        system.solve(&a, &mut b.clone()).unwrap();
        // Some rows are replaced again, and some come back.
        let rows = [3, 17, 0, 20, 3, 17, 8, 0, 9, 17, 17, 5, 10, 1, 2, 11];
        for (time, row) in rows.into_iter().enumerate() {
            let back = [5, 7, 9].contains(&time);
            for column in row * n..(row + 1) * n {
                a[column] = if back { first[column] } else { noise(5000 + 7 * time + column) };
            }
            if time == 3 {
                b[5] += 1.0;
            }
            let (mut x, mut exact) = (b.clone(), b.clone());
            let factors = system.solve_changed(&a, &[row], &mut x).unwrap();
            assert_eq!(factors == Factors::New, time == 11, "{time}");
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
