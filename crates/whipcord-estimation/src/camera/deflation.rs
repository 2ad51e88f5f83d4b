//! What photographs tell of the unknowns that all of them share: eq. (k4) of `docs/theory/cameras.md`.

/// Eq. (k4): the first `own` columns of a Jacobian by rows of this width, less what the place of the board in each photograph
/// can make up for. Each photograph has so many rows, one after the other, and six unknowns behind the first `own`.
pub(super) fn without_places(
    mut jacobian: Vec<f64>,
    width: usize,
    own: usize,
    rows_of_photographs: impl IntoIterator<Item = usize>,
) -> Vec<f64> {
    let norms: Vec<f64> = (0..own).map(|column| norm(&jacobian, width, column)).collect();
    let mut rows = &mut jacobian[..];
    for (view, count) in rows_of_photographs.into_iter().enumerate() {
        let (block, after) = rows.split_at_mut(count * width);
        rows = after;
        let first = own + 6 * view;
        for place in first..first + 6 {
            // Those of the places among one another as well: Gram and Schmidt's, modified.
            for column in (0..own).chain(place + 1..first + 6) {
                deflate(block, width, place, column);
            }
        }
    }
    // What then is rounding says nothing.
    for (column, whole) in norms.into_iter().enumerate() {
        if norm(&jacobian, width, column) <= 1e-9 * whole {
            jacobian.iter_mut().skip(column).step_by(width).for_each(|entry| *entry = 0.0);
        }
    }
    jacobian.chunks_exact(width).flat_map(|row| &row[..own]).copied().collect()
}

/// Of a column of a matrix by rows.
fn norm(matrix: &[f64], width: usize, column: usize) -> f64 {
    matrix.iter().skip(column).step_by(width).map(|entry| entry * entry).sum::<f64>().sqrt()
}

/// Takes from one column of a matrix by rows what is along another one.
fn deflate(matrix: &mut [f64], width: usize, along: usize, column: usize) {
    let (mut product, mut square) = (0.0, 0.0);
    for row in matrix.chunks_exact(width) {
        product += row[along] * row[column];
        square += row[along] * row[along];
    }
    if square > 0.0 {
        for row in matrix.chunks_exact_mut(width) {
            row[column] -= product / square * row[along];
        }
    }
}
