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
    factors: Vec<f64>,
    pivots: Vec<usize>,
}

impl DenseLu {
    /// Factors the `n`×`n` matrix `a`, given by rows.
    ///
    /// # Errors
    /// [`Singular`] when a column has no pivot above rounding.
    pub fn factor(&mut self, n: usize, a: &[f64]) -> Result<(), Singular> {
        debug_assert_eq!(a.len(), n * n);
        self.n = n;
        self.factors.clear();
        self.factors.extend_from_slice(a);
        self.pivots.clear();
        let m = &mut self.factors;
        for k in 0..n {
            let column_scale = (0..n).map(|i| a[i * n + k].abs()).fold(0.0, f64::max);
            let mut pivot = k;
            for i in k + 1..n {
                if m[i * n + k].abs() > m[pivot * n + k].abs() {
                    pivot = i;
                }
            }
            let value = m[pivot * n + k];
            if value.is_nan() || value.abs() <= 0.25 * f64::EPSILON * column_scale {
                return Err(Singular { column: k });
            }
            self.pivots.push(pivot);
            if pivot != k {
                for j in 0..n {
                    m.swap(k * n + j, pivot * n + j);
                }
            }
            for i in k + 1..n {
                let f = m[i * n + k] / value;
                m[i * n + k] = f;
                for j in k + 1..n {
                    m[i * n + j] -= f * m[k * n + j];
                }
            }
        }
        Ok(())
    }

    /// Overwrites `b` by the solution of `A x = b`.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.n;
        debug_assert_eq!(b.len(), n);
        for k in 0..n {
            b.swap(k, self.pivots[k]);
        }
        for i in 1..n {
            for j in 0..i {
                b[i] -= self.factors[i * n + j] * b[j];
            }
        }
        for i in (0..n).rev() {
            for j in i + 1..n {
                b[i] -= self.factors[i * n + j] * b[j];
            }
            b[i] /= self.factors[i * n + i];
        }
    }
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
    fn singular_and_nan_are_refused() {
        let mut lu = DenseLu::default();
        assert_eq!(lu.factor(2, &[1.0, 2.0, 2.0, 4.0]), Err(Singular { column: 1 }));
        assert_eq!(lu.factor(1, &[f64::NAN]), Err(Singular { column: 0 }));
    }
}
