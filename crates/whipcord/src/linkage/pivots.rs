//! The signs of eigenvalues, by elimination.

/// Of a matrix, taken for symmetric, by elimination without exchanges; `None` where a pivot vanishes.
pub(super) fn negative_pivots(n: usize, matrix: &[f64], work: &mut Vec<f64>) -> Option<usize> {
    work.clear();
    work.extend_from_slice(matrix);
    let mut negative = 0;
    for k in 0..n {
        let pivot = work[k * n + k];
        if pivot == 0.0 || !pivot.is_finite() {
            return None;
        }
        negative += usize::from(pivot < 0.0);
        for i in k + 1..n {
            let factor = work[i * n + k] / pivot;
            for j in k + 1..n {
                work[i * n + j] -= factor * work[k * n + j];
            }
        }
    }
    Some(negative)
}

/// Of the matrix `c + CᵀH⁻¹C` of the held cables, by elimination.
/// The cables are given with how far each of them gives in m/N.
pub(super) fn positive_pivots(
    held: impl ExactSizeIterator<Item = (usize, f64)> + Clone,
    entry: impl Fn(usize, usize) -> f64,
    pivots: &mut Vec<f64>,
    work: &mut Vec<f64>,
) -> Option<usize> {
    let n = held.len();
    pivots.clear();
    for (i, (cable, gives)) in held.clone().enumerate() {
        for (j, (other, _)) in held.clone().enumerate() {
            pivots.push(entry(cable, other) + if i == j { gives } else { 0.0 });
        }
    }
    negative_pivots(n, pivots, work).map(|negative| n - negative)
}
