//! Linear equations of which some unknowns are known, as the forces of open contacts are.

use whipcord_numerics::{DenseLu, Singular};

/// Memory of a solution.
#[derive(Clone, Debug, Default)]
pub(super) struct PartlyKnown {
    part: Vec<f64>,
    right: Vec<f64>,
    lu: DenseLu,
}

impl PartlyKnown {
    /// Solves the rows of the unknowns with these numbers of `A x = b`, with a matrix by rows. In `x` come the right-hand side where it is
    /// unknown, and the values that are known; the solution takes the place of the right-hand side, which is lost after an error. Rows of
    /// what is known are not looked at.
    ///
    /// # Errors
    /// [`Singular`] where the equations of the unknowns do not determine them.
    pub fn solve(
        &mut self,
        unknown: &[usize],
        matrix: &[f64],
        x: &mut [f64],
    ) -> Result<(), Singular> {
        let Self { part, right, lu } = self;
        let count = x.len();
        part.clear();
        right.clear();
        for &i in unknown {
            let row = &matrix[i * count..(i + 1) * count];
            part.extend(unknown.iter().map(|&j| row[j]));
            right.push(x[i]);
        }
        // What is known goes to the other side, without the right-hand sides.
        unknown.iter().for_each(|&i| x[i] = 0.0);
        for (&i, right) in unknown.iter().zip(right.iter_mut()) {
            let row = &matrix[i * count..(i + 1) * count];
            *right -= row.iter().zip(&*x).map(|(a, x)| a * x).sum::<f64>();
        }
        lu.factor(unknown.len(), part)?;
        lu.solve(right);
        unknown.iter().zip(right).for_each(|(&i, &mut found)| x[i] = found);
        Ok(())
    }

    /// Whether the determinant of the part of the matrix that was solved last is negative.
    #[must_use]
    pub fn is_determinant_negative(&self) -> bool {
        self.lu.is_determinant_negative()
    }
}

#[cfg(test)]
mod tests {
    use super::PartlyKnown;

    #[test]
    fn known_values_are_kept_and_counted() {
        // 2x + 3y + z = 13 and −x + 4z = 10 with y = 2: x = 2, z = 3.
        let matrix = [2.0, 3.0, 1.0, 7.0, 7.0, 7.0, -1.0, 0.0, 4.0];
        let mut x = [13.0, 2.0, 10.0];
        let mut system = PartlyKnown::default();
        system.solve(&[0, 2], &matrix, &mut x).unwrap();
        let left = [x[0] - 2.0, x[1] - 2.0, x[2] - 3.0];
        assert!(left.iter().all(|left| left.abs() < 1e-15), "{x:?}");
        assert!(!system.is_determinant_negative());
        // The determinant of the part, −2, is negative, that of the whole is not.
        let matrix = [0.0, 5.0, 1.0, 5.0, -1.0, 5.0, 2.0, 5.0, 0.0];
        let mut x = [3.0, 0.0, 4.0];
        system.solve(&[0, 2], &matrix, &mut x).unwrap();
        assert_eq!(x, [2.0, 0.0, 3.0]);
        assert!(system.is_determinant_negative());
        // Nothing is unknown.
        system.solve(&[], &matrix, &mut x).unwrap();
        assert_eq!(x, [2.0, 0.0, 3.0]);
        assert!(system.solve(&[0, 1], &[1.0, 1.0, 1.0, 1.0], &mut [1.0, 2.0]).is_err());
    }
}
