//! How sure the pose of a camera is: by the errors of pixels and of lenses, eq. (l8), (l9), (s8), (s9) and (s10) of `docs/theory/cameras.md`.

use whipcord_numerics::DenseLu;

use super::lens::LENS_PARAMETERS;
use crate::uncertainty::Spread;

/// Covariance of position (m) and rotation (rad).
pub type PoseCovariance = [[f64; 6]; 6];

/// How position and rotation follow the focal lengths, the principal point and the first twelve distortion coefficients of a lens.
pub type PoseByLens = [[f64; LENS_PARAMETERS]; 6];

/// Eq. (s8): the covariance of unknowns, from the Jacobian by rows of pixels whose columns and rows have this variance. `None` where the
/// pixels do not determine them.
pub(super) fn covariance(
    unknowns: usize,
    jacobian: &[f64],
    variance: f64,
) -> Option<Vec<Vec<f64>>> {
    let spread = Spread::of(jacobian, &vec![true; unknowns], variance, false);
    (!spread.deviations.iter().any(Option::is_none)).then(|| spread.covariance())
}

/// Eq. (s9): how unknowns follow the parameters of a lens, of the Jacobian by rows whose columns are those of the unknowns and of the
/// lens. One row for each unknown; `None` where the pixels do not determine them.
pub(super) fn by_lens(unknowns: usize, jacobian: &[f64]) -> Option<Vec<[f64; LENS_PARAMETERS]>> {
    let width = unknowns + LENS_PARAMETERS;
    let product =
        |i: usize, j: usize| jacobian.chunks_exact(width).map(|row| row[i] * row[j]).sum();
    // Metres and radians are of one size then.
    let sizes: Vec<f64> = (0..unknowns).map(|i| f64::sqrt(product(i, i))).collect();
    if sizes.contains(&0.0) {
        return None;
    }
    let normal: Vec<f64> = (0..unknowns * unknowns)
        .map(|at| (at / unknowns, at % unknowns))
        .map(|(i, j)| product(i, j) / (sizes[i] * sizes[j]))
        .collect();
    let mut factors = DenseLu::default();
    factors.factor(unknowns, &normal).ok()?;
    let mut by_lens = vec![[0.0; LENS_PARAMETERS]; unknowns];
    for parameter in 0..LENS_PARAMETERS {
        let mut column: Vec<f64> =
            (0..unknowns).map(|i| -product(i, unknowns + parameter) / sizes[i]).collect();
        factors.solve(&mut column);
        for (row, (value, size)) in by_lens.iter_mut().zip(column.iter().zip(&sizes)) {
            row[parameter] = value / size;
        }
    }
    Some(by_lens)
}

/// Eq. (s10): adds what the errors of a lens with this covariance of its first parameters contribute.
pub(super) fn add_lens(covariance: &mut PoseCovariance, by_lens: &PoseByLens, lens: &[Vec<f64>]) {
    for (i, row) in covariance.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            for (of_lens, a) in lens.iter().zip(by_lens[i]) {
                for (own, b) in of_lens.iter().zip(by_lens[j]) {
                    *entry += a * own * b;
                }
            }
        }
    }
}
