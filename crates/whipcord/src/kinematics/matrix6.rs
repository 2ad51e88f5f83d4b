use whipcord_numerics::{DenseLu, Mat3, Twist, Vec3};

use crate::shape::Wrench;

/// A matrix between motions and wrenches of one place: of a compliance the rows are translation (x,
/// y, z) in m and rotation (x, y, z) in rad, the columns force in N and moment in N·m; of a stiffness
/// the other way round. All in the base frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Matrix6 {
    /// The four 3×3 blocks: `blocks[0][1]` is what translation owes to moments.
    pub blocks: [[Mat3; 2]; 2],
}

impl Matrix6 {
    /// The matrix with these columns.
    #[must_use]
    pub fn from_columns(columns: &[Twist; 6]) -> Self {
        let block = |row: fn(&Twist) -> Vec3, first: usize| {
            let [a, b, c] = [0, 1, 2].map(|j| row(&columns[first + j]));
            Mat3::from_columns(a, b, c)
        };
        let linear = |t: &Twist| t.linear;
        let angular = |t: &Twist| t.angular;
        Self {
            blocks: [[block(linear, 0), block(linear, 3)], [block(angular, 0), block(angular, 3)]],
        }
    }

    /// Entry by row and column, each from 0 to 5.
    #[must_use]
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.blocks[row / 3][column / 3].rows[row % 3][column % 3]
    }

    /// By rows.
    #[must_use]
    pub fn rows(&self) -> [[f64; 6]; 6] {
        core::array::from_fn(|i| core::array::from_fn(|j| self.at(i, j)))
    }

    /// What a wrench does, or what a motion takes.
    #[must_use]
    pub fn apply(&self, wrench: &Wrench) -> Twist {
        let [[a, b], [c, d]] = &self.blocks;
        Twist {
            linear: *a * wrench.force + *b * wrench.moment,
            angular: *c * wrench.force + *d * wrench.moment,
        }
    }

    /// The inverse of a compliance; `None` when it is singular to working precision, as where a robot
    /// does not yield in some direction at all. `length` in m makes translations comparable to
    /// rotations.
    #[must_use]
    pub fn inverse(&self, length: f64) -> Option<Self> {
        /// Beyond this condition rounding decides on what is left.
        const GREATEST_CONDITION: f64 = 1e11;
        let unit = |i: usize| if i < 3 { 1.0 / length } else { 1.0 };
        let scaled: Vec<f64> =
            (0..36).map(|k| self.at(k / 6, k % 6) * unit(k / 6) * unit(k % 6)).collect();
        let mut lu = DenseLu::default();
        lu.factor(6, &scaled).ok()?;
        let greatest = |values: &[f64]| values.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let mut out = Self::default();
        let mut most = 0.0_f64;
        for j in 0..6 {
            let mut column = [0.0; 6];
            column[j] = 1.0;
            lu.solve(&mut column);
            most = most.max(greatest(&column));
            for (i, value) in column.iter().enumerate() {
                out.blocks[i / 3][j / 3].rows[i % 3][j % 3] = value * unit(i) * unit(j);
            }
        }
        // Written so that a NaN is refused as well.
        (most * greatest(&scaled) <= GREATEST_CONDITION).then_some(out)
    }

    /// Largest difference between an entry and its mirror image, where lengths are counted in
    /// `length` m and entries relative to the greatest one.
    #[must_use]
    pub fn asymmetry(&self, length: f64) -> f64 {
        let unit = |i: usize| if i < 3 { 1.0 / length } else { 1.0 };
        let entry = |i: usize, j: usize| self.at(i, j) * unit(i) * unit(j);
        let (mut worst, mut greatest) = (0.0_f64, 0.0_f64);
        for i in 0..6 {
            for j in 0..6 {
                worst = worst.max((entry(i, j) - entry(j, i)).abs());
                greatest = greatest.max(entry(i, j).abs());
            }
        }
        if greatest > 0.0 { worst / greatest } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_a_cantilever_is_its_stiffness() {
        // Deflection and slope of a cantilever in one plane, and springs elsewhere.
        let (l, ei) = (0.2, 4e-3);
        let columns: [Twist; 6] = core::array::from_fn(|j| {
            let mut column = Twist::default();
            match j {
                0 => {
                    column.linear.x = l * l * l / (3.0 * ei);
                    column.angular.y = l * l / (2.0 * ei);
                }
                4 => {
                    column.linear.x = l * l / (2.0 * ei);
                    column.angular.y = l / ei;
                }
                1 | 2 => column.linear[j] = 1e-5,
                _ => column.angular[j - 3] = 50.0,
            }
            column
        });
        let stiffness = Matrix6::from_columns(&columns).inverse(l).unwrap();
        assert!((stiffness.at(0, 0) - 12.0 * ei / l.powi(3)).abs() < 1e-9);
        assert!((stiffness.at(0, 4) + 6.0 * ei / l.powi(2)).abs() < 1e-9);
        assert!((stiffness.at(4, 4) - 4.0 * ei / l).abs() < 1e-9);
        assert!(stiffness.asymmetry(l) < 1e-12);
        assert!(Matrix6::default().inverse(l).is_none());
        // What does not yield about one axis, but for rounding, has no stiffness.
        let mut rigid = columns;
        rigid[4] = Twist { angular: Vec3::Y * 1e-16, ..Twist::default() };
        rigid[0].angular.y = 0.0;
        assert!(Matrix6::from_columns(&rigid).inverse(l).is_none());
    }
}
