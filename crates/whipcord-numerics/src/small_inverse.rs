/// The inverse of a matrix, and the sign of its determinant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallInverse<const N: usize> {
    /// By rows.
    pub rows: [[f64; N]; N],
    /// Whether the determinant is negative.
    pub is_determinant_negative: bool,
}

impl<const N: usize> SmallInverse<N> {
    /// Of a matrix of a few rows, by the method of Gauss and Jordan with partial pivoting; `None` where it is singular to working
    /// precision.
    #[inline(always)]
    #[must_use]
    pub fn of(matrix: &[[f64; N]; N]) -> Option<Self> {
        let mut rows = *matrix;
        let mut pivots = [0; N];
        let mut is_determinant_negative = false;
        for k in 0..N {
            let scale = matrix.iter().fold(0.0, |scale: f64, row| scale.max(row[k].abs()));
            let mut pivot = k;
            for i in k + 1..N {
                if rows[i][k].abs() > rows[pivot][k].abs() {
                    pivot = i;
                }
            }
            let value = rows[pivot][k];
            if value.is_nan() || value.abs() <= 0.25 * f64::EPSILON * scale {
                return None;
            }
            rows.swap(k, pivot);
            pivots[k] = pivot;
            is_determinant_negative ^= (pivot != k) ^ (value < 0.0);
            let inverse = 1.0 / value;
            rows[k][k] = 1.0;
            let row = rows[k].map(|entry| entry * inverse);
            rows[k] = row;
            for (i, other) in rows.iter_mut().enumerate() {
                if i == k {
                    continue;
                }
                let times = core::mem::take(&mut other[k]);
                for (entry, row) in other.iter_mut().zip(row) {
                    *entry -= times * row;
                }
            }
        }
        for (k, &pivot) in pivots.iter().enumerate().rev() {
            for row in &mut rows {
                row.swap(k, pivot);
            }
        }
        Some(Self { rows, is_determinant_negative })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DenseLu;
    use crate::random::SplitMix64;

    fn check<const N: usize>() {
        let mut random = SplitMix64::new(N as u64);
        for _ in 0..200 {
            let matrix: [[f64; N]; N] =
                core::array::from_fn(|_| core::array::from_fn(|_| 2.0 * random.next_part() - 1.0));
            let inverse = SmallInverse::of(&matrix).unwrap();
            let mut lu = DenseLu::default();
            lu.factor(N, matrix.as_flattened()).unwrap();
            assert_eq!(inverse.is_determinant_negative, lu.is_determinant_negative());
            for j in 0..N {
                let mut column = [0.0; N];
                column[j] = 1.0;
                lu.solve(&mut column);
                let size = column.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
                for (i, x) in column.into_iter().enumerate() {
                    assert!((inverse.rows[i][j] - x).abs() < 1e-10 * size * size);
                }
            }
        }
    }

    #[test]
    fn is_what_the_factors_have() {
        check::<1>();
        check::<3>();
        check::<6>();
    }

    #[test]
    fn a_singular_matrix_has_none() {
        assert_eq!(SmallInverse::of(&[[1.0, 2.0], [2.0, 4.0]]), None);
        assert_eq!(SmallInverse::of(&[[f64::NAN]]), None);
        assert_eq!(SmallInverse::of(&[[0.0, 1.0], [0.0, 1.0]]), None);
    }
}
