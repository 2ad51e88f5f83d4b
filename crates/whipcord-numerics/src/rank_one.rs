//! A symmetric matrix as a sum of terms of rank one, and with it the signs of its eigenvalues.

/// Takes a symmetric `n`×`n` matrix, given by rows and overwritten, apart into `Σ γ u uᵀ` with as many terms as its rank: what is
/// no greater than `tolerance` times its greatest entry counts as zero. By Sylvester's law as many of its eigenvalues are
/// negative as there are terms with `γ < 0`.
///
/// Each term takes away a direction `e`, with `γ = eᵀAe` and `u = Ae/γ`: the greatest entry of the diagonal, or, where an entry beside it is markedly
/// greater, the sum or the difference of two axes, so that no entry of `u` is much greater than 1.
///
/// ```
/// use whipcord_numerics::rank_one_terms;
/// let mut negative = 0;
/// rank_one_terms(2, &mut [0.0, 2.0, 2.0, 0.0], 1e-12, |gamma, _| negative += usize::from(gamma < 0.0));
/// assert_eq!(negative, 1);
/// ```
pub fn rank_one_terms(n: usize, a: &mut [f64], tolerance: f64, mut term: impl FnMut(f64, &[f64])) {
    /// A pivot of the diagonal is taken where no entry beside it is greater than this many times it.
    const PIVOT: f64 = 1.5;
    debug_assert_eq!(a.len(), n * n);
    let least = tolerance * a.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let mut direction = vec![0.0; n];
    for _ in 0..n {
        let (mut diagonal, mut beside) = ((0, 0.0_f64), ((0, 0), 0.0_f64));
        for i in 0..n {
            if a[i * n + i].abs() > diagonal.1 {
                diagonal = (i, a[i * n + i].abs());
            }
            for j in 0..i {
                if a[i * n + j].abs() > beside.1 {
                    beside = ((i, j), a[i * n + j].abs());
                }
            }
        }
        let greatest = diagonal.1.max(beside.1);
        if greatest <= least || !greatest.is_finite() {
            return;
        }
        let gamma;
        if beside.1 <= PIVOT * diagonal.1 {
            let i = diagonal.0;
            gamma = a[i * n + i];
            direction.copy_from_slice(&a[i * n..(i + 1) * n]);
        } else {
            let (i, j) = beside.0;
            let sum = a[i * n + i] + a[j * n + j];
            let sign = if sum * a[i * n + j] < 0.0 { -1.0 } else { 1.0 };
            gamma = sum + 2.0 * sign * a[i * n + j];
            for (k, x) in direction.iter_mut().enumerate() {
                *x = a[i * n + k] + sign * a[j * n + k];
            }
        }
        direction.iter_mut().for_each(|x| *x /= gamma);
        term(gamma, &direction);
        for i in 0..n {
            let by = gamma * direction[i];
            for j in 0..n {
                a[i * n + j] -= by * direction[j];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;
    use crate::symmetric_eigenvalues;

    /// Terms add up to the matrix, and have the signs of its eigenvalues, with zeros on the diagonal and of less than full rank too.
    #[test]
    fn terms_add_up_and_have_the_signs_of_the_eigenvalues() {
        let mut random = SplitMix64::new(7);
        let mut between = || 2.0 * random.next_part() - 1.0;
        for case in 0..200 {
            let n = 1 + case % 9;
            let rank = 1 + (case / 9) % n;
            let mut matrix = vec![0.0; n * n];
            for _ in 0..rank {
                let gamma = between();
                let u: Vec<f64> = (0..n).map(|_| between()).collect();
                for i in 0..n {
                    for j in 0..n {
                        matrix[i * n + j] += gamma * u[i] * u[j];
                    }
                }
            }
            if case % 3 == 0 && n > 1 && rank == n {
                (0..n).for_each(|i| matrix[i * n + i] = 0.0);
            }
            let mut sum = vec![0.0; n * n];
            let (mut terms, mut negative) = (0, 0);
            rank_one_terms(n, &mut matrix.clone(), 1e-12, |gamma, u| {
                terms += 1;
                negative += usize::from(gamma < 0.0);
                for i in 0..n {
                    for j in 0..n {
                        sum[i * n + j] += gamma * u[i] * u[j];
                    }
                }
            });
            for (a, b) in sum.iter().zip(&matrix) {
                assert!((a - b).abs() < 1e-10, "{case}: {a} and {b}");
            }
            let values: Vec<f64> = symmetric_eigenvalues(n, &mut matrix.clone()).collect();
            assert_eq!(negative, values.iter().filter(|&&x| x < -1e-10).count(), "{case}");
            assert_eq!(terms, values.iter().filter(|x| x.abs() > 1e-10).count(), "{case}");
        }
    }

    #[test]
    fn nothing_comes_of_zero_or_of_what_is_no_number() {
        for mut matrix in [[0.0; 4], [f64::NAN; 4]] {
            rank_one_terms(2, &mut matrix, 1e-12, |_, _| panic!("a term"));
        }
    }
}
