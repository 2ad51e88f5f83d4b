//! How sure the place of a camera is, eq. (l8) and (l9).

use whipcord_numerics::Vec3;

use super::sighting::Sighting;
use crate::camera::error::ViewError;
use crate::camera::lens::{LENS_PARAMETERS, Lens};
use crate::camera::pose_uncertainty::{PoseByLens, PoseCovariance, add_lens, by_lens, covariance};
use crate::camera::view::Camera;

/// How sure the position and the rotation of a located camera are, by the errors of the pixels and of its lens.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseUncertainty {
    /// Covariance of position and rotation where columns and rows have a standard deviation of one pixel; `None` where the points do not
    /// determine the pose.
    by_pixels: Option<PoseCovariance>,
    /// How they follow the lens; zero of an orthographic camera.
    by_lens: PoseByLens,
    /// Standard deviation of the logarithm of the scale of an orthographic camera by one pixel.
    scale: Option<f64>,
    /// Standard deviation of a column or row in pixels, as the residuals tell; `None` where there are no more of them than unknowns.
    pub pixel: Option<f64>,
    /// By how many the columns and rows that were seen exceed the unknowns.
    pub freedom: usize,
}

/// A way in which the camera may move: rates of its position and rotation in the world, and of the logarithm of its scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) shift: Vec3,
    pub(super) turn: Vec3,
    pub(super) scale: f64,
}

impl Motion {
    pub(super) const fn shift(along: Vec3) -> Self {
        Self { shift: along, turn: Vec3::ZERO, scale: 0.0 }
    }

    /// A turn about an axis through a point.
    pub(super) fn turn(axis: Vec3, camera: &Camera, pivot: Vec3) -> Self {
        Self { shift: axis.cross(camera.pose().position - pivot), turn: axis, scale: 0.0 }
    }

    pub(super) const SCALE: Self = Self { shift: Vec3::ZERO, turn: Vec3::ZERO, scale: 1.0 };
}

impl PoseUncertainty {
    /// Eq. (l8): of cameras at the minimum, with what each has seen. The first may move in these ways, and the others with it; the residuals
    /// have this sum of squares. Of several cameras the lenses are taken as they are.
    pub(super) fn of(
        images: &[(&Camera, &[Sighting])],
        motions: &[Motion],
        squares: f64,
    ) -> Result<Self, ViewError> {
        let n = motions.len();
        let (mut jacobian, mut with_lens) = (Vec::new(), Vec::new());
        let first = images.first().map_or(Vec3::ZERO, |(camera, _)| camera.pose().position);
        let all = images.iter().flat_map(|(camera, seen)| seen.iter().map(move |at| (*camera, at)));
        for (camera, at) in all.clone() {
            let projection = camera.project_with_gradient(at.point)?;
            let arm = camera.pose().position - first;
            let columns = match camera.lens() {
                Lens::Pinhole(lens) if images.len() == 1 => {
                    lens.by_parameters(camera.in_view(at.point))
                }
                _ => [[0.0; 2]; LENS_PARAMETERS],
            };
            for i in 0..2 {
                let from_centre = match camera.lens() {
                    Lens::Orthographic(lens) => projection.pixel[i] - lens.centre()[i],
                    Lens::Pinhole(_) => 0.0,
                };
                let row = motions.iter().map(|motion| {
                    projection.by_shift[i].dot(motion.shift + motion.turn.cross(arm))
                        + projection.by_turn[i].dot(motion.turn)
                        + from_centre * motion.scale
                });
                let row: Vec<f64> = row.collect();
                jacobian.extend_from_slice(&row);
                with_lens.extend_from_slice(&row);
                with_lens.extend(columns.iter().map(|column| column[i]));
            }
        }
        let rates: Vec<[f64; 6]> = motions
            .iter()
            .map(|Motion { shift, turn, .. }| [shift.x, shift.y, shift.z, turn.x, turn.y, turn.z])
            .collect();
        let unknowns = covariance(n, &jacobian, 1.0);
        let in_world = |of: &Vec<Vec<f64>>| -> PoseCovariance {
            core::array::from_fn(|i| {
                core::array::from_fn(|j| {
                    let pairs = (0..n).flat_map(|a| (0..n).map(move |b| (a, b)));
                    pairs.map(|(a, b)| rates[a][i] * of[a][b] * rates[b][j]).sum()
                })
            })
        };
        let by_lens = by_lens(n, &with_lens).map_or([[0.0; LENS_PARAMETERS]; 6], |by_lens| {
            core::array::from_fn(|i| {
                core::array::from_fn(|k| (0..n).map(|a| rates[a][i] * by_lens[a][k]).sum())
            })
        });
        let scale = motions.iter().position(|motion| motion.scale > 0.0);
        let freedom = (2 * all.count()).saturating_sub(n);
        Ok(Self {
            by_pixels: unknowns.as_ref().map(in_world),
            by_lens,
            scale: scale.zip(unknowns.as_ref()).map(|(k, of)| of[k][k].max(0.0).sqrt()),
            pixel: (freedom > 0).then(|| (squares / freedom as f64).sqrt()),
            freedom,
        })
    }

    /// Eq. (l8) and (l9): covariance of the position (m) and the rotation (rad) of the camera along and about the axes of the world, by the
    /// errors of columns and rows with this standard deviation in pixels, or as the residuals tell, and by those of a lens with this
    /// [covariance](crate::camera::LensDeviations::covariance). `None` where neither tells the errors of pixels, and where the points do not
    /// determine the pose.
    #[must_use]
    pub fn covariance(
        &self,
        pixel: Option<f64>,
        lens: Option<&[Vec<f64>]>,
    ) -> Option<PoseCovariance> {
        let variance = pixel.or(self.pixel)?.powi(2);
        let mut covariance = self.by_pixels?.map(|row| row.map(|entry| variance * entry));
        if let Some(lens) = lens {
            add_lens(&mut covariance, &self.by_lens, lens);
        }
        Some(covariance)
    }

    /// Standard deviation of the scale of an orthographic camera relative to it.
    #[must_use]
    pub fn relative_scale_deviation(&self, pixel: Option<f64>) -> Option<f64> {
        Some(pixel.or(self.pixel)? * self.scale?)
    }
}

/// Standard deviations of position (m) and rotation (rad).
#[must_use]
pub fn pose_deviations(covariance: &PoseCovariance) -> [Vec3; 2] {
    [0, 3].map(|first| {
        Vec3::from([0, 1, 2].map(|i| covariance[first + i][first + i].max(0.0).sqrt()))
    })
}
