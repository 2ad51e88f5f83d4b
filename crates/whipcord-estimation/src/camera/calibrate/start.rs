use whipcord_numerics::Vec3;

use super::error::CalibrateError;
use crate::camera::distortion::Distortion;
use crate::camera::lens::Pinhole;
use crate::camera::locate::{Cloud, Sighting, plane_columns};

/// Eq. (k1): the focal lengths from the homographies of the boards, with the principal point at the
/// centre of the image; none where they say nothing of it.
pub(super) fn first_lens(
    size: [u32; 2],
    views: &[Vec<Sighting>],
) -> Result<Option<Pinhole>, CalibrateError> {
    let centre = size.map(|n| 0.5 * (f64::from(n) - 1.0));
    let unit = f64::from(size[0].max(size[1]));
    // Normal equations of a 2×2 system for 1/fx² and 1/fy².
    let (mut matrix, mut right) = ([[0.0; 2]; 2], [0.0; 2]);
    for (view, seen) in views.iter().enumerate() {
        let cloud = Cloud::of(seen);
        let columns = (seen.len() >= 4 && cloud.is_plane() && !cloud.is_line())
            .then(|| {
                let image: Vec<[f64; 2]> = seen
                    .iter()
                    .map(|at| [0, 1].map(|i| (at.pixel[i] - centre[i]) / unit))
                    .collect();
                plane_columns(&cloud, seen, &image)
            })
            .ok_or(CalibrateError::NoBoard { view, points: seen.len() })?;
        let [a, b, _] = columns;
        let (a, b) = (a / (a.norm() + b.norm()), b / (a.norm() + b.norm()));
        let product = |p: Vec3, q: Vec3| [p.x * q.x, p.y * q.y, p.z * q.z];
        let ([ax, ay, az], [bx, by, bz]) = (product(a, a), product(b, b));
        for [x, y, z] in [product(a, b), [ax - bx, ay - by, az - bz]] {
            matrix[0][0] += x * x;
            matrix[0][1] += x * y;
            matrix[1][1] += y * y;
            right[0] -= x * z;
            right[1] -= y * z;
        }
    }
    let [[xx, xy], [_, yy]] = matrix;
    let determinant = xx * yy - xy * xy;
    // Written so that a NaN is refused as well.
    if determinant.is_nan() || determinant <= 1e-12 * xx * yy {
        return Ok(None);
    }
    let inverse_squares = [
        (yy * right[0] - xy * right[1]) / determinant,
        (xx * right[1] - xy * right[0]) / determinant,
    ];
    // Shorter than a twentieth or longer than fifty times the image no lens of a camera is.
    if inverse_squares.iter().any(|w| w.is_nan() || !(4e-4..400.0).contains(w)) {
        return Ok(None);
    }
    let focal = inverse_squares.map(|w| unit / w.sqrt());
    Ok(Some(Pinhole::new(focal, centre, Distortion::NONE)?))
}
