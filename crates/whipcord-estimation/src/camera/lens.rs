use whipcord_numerics::Vec3;

use super::distortion::Distortion;
use super::error::{CameraError, ViewError};
use whipcord::robot::limits::{FOCAL_LENGTH, IMAGE_SCALE, PIXEL};

/// What is nearer to the centre of projection than 1 nm is at it.
const NEAREST: f64 = 1e-9;

/// Focal lengths, principal point and twelve distortion coefficients.
pub const LENS_PARAMETERS: usize = 16;

/// How points in the camera's frame are seen.
#[expect(clippy::large_enum_variant, reason = "there are as many lenses as cameras: a few")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Central projection.
    Pinhole(Pinhole),
    /// Parallel projection.
    Orthographic(Orthographic),
}

/// A pinhole camera with distortion, eq. (c1): u = c + f · (x‴, y‴).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    focal: [f64; 2],
    centre: [f64; 2],
    distortion: Distortion,
}

/// A scaled orthographic camera: u = c + s (X, Y) of a point (X, Y, Z) in the camera's frame. What a
/// camera with a long lens sees of a robot that is shallow compared with its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthographic {
    scale: f64,
    centre: [f64; 2],
}

impl Pinhole {
    /// With the focal lengths (fx, fy) in pixels, the principal point (cx, cy) in pixels, and the
    /// distortion.
    ///
    /// # Errors
    /// [`CameraError`] for a number out of its range.
    pub fn new(
        focal: [f64; 2],
        centre: [f64; 2],
        distortion: Distortion,
    ) -> Result<Self, CameraError> {
        for value in focal {
            CameraError::check(FOCAL_LENGTH, "focal length", value)?;
        }
        check_centre(centre)?;
        Ok(Self { focal, centre, distortion })
    }

    /// Focal lengths (fx, fy) in pixels.
    #[must_use]
    pub const fn focal(&self) -> [f64; 2] {
        self.focal
    }

    /// Principal point (cx, cy) in pixels.
    #[must_use]
    pub const fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// How the lens bends the image.
    #[must_use]
    pub const fn distortion(&self) -> &Distortion {
        &self.distortion
    }
}

impl Orthographic {
    /// With the scale in pixels per metre, and the pixel (cx, cy) of the camera's axis.
    ///
    /// # Errors
    /// [`CameraError`] for a number out of its range.
    pub fn new(scale: f64, centre: [f64; 2]) -> Result<Self, CameraError> {
        CameraError::check(IMAGE_SCALE, "scale", scale)?;
        check_centre(centre)?;
        Ok(Self { scale, centre })
    }

    /// Pixels per metre.
    #[must_use]
    pub const fn scale(&self) -> f64 {
        self.scale
    }

    /// The pixel (cx, cy) of the camera's axis.
    #[must_use]
    pub const fn centre(&self) -> [f64; 2] {
        self.centre
    }
}

fn check_centre(centre: [f64; 2]) -> Result<(), CameraError> {
    centre.iter().try_for_each(|&value| CameraError::check(PIXEL, "principal point", value))
}

impl Lens {
    /// Where a point in the camera's frame is seen, and the derivatives of column and row by it.
    pub(super) fn project(&self, point: Vec3) -> Result<([f64; 2], [Vec3; 2]), ViewError> {
        match self {
            Self::Pinhole(lens) => lens.project(point),
            Self::Orthographic(Orthographic { scale, centre }) => Ok((
                [centre[0] + scale * point.x, centre[1] + scale * point.y],
                [*scale * Vec3::X, *scale * Vec3::Y],
            )),
        }
    }

    /// The ideal image of a pixel.
    pub(super) fn undistort(&self, pixel: [f64; 2]) -> Result<[f64; 2], ViewError> {
        match self {
            Self::Pinhole(Pinhole { focal, centre, distortion }) => {
                let seen = [(pixel[0] - centre[0]) / focal[0], (pixel[1] - centre[1]) / focal[1]];
                distortion.straighten(seen).ok_or(ViewError::NoRay { pixel })
            }
            Self::Orthographic(Orthographic { scale, centre }) => {
                Ok([(pixel[0] - centre[0]) / scale, (pixel[1] - centre[1]) / scale])
            }
        }
    }
}

impl Pinhole {
    fn project(&self, point: Vec3) -> Result<([f64; 2], [Vec3; 2]), ViewError> {
        let depth = point.z;
        if depth < NEAREST {
            return Err(ViewError::Behind { depth });
        }
        let [x, y] = [point.x / depth, point.y / depth];
        let bent = self.distortion.bend([x, y]).ok_or_else(|| ViewError::BeyondLens {
            angle: x.hypot(y).atan(),
            reach: self.distortion.reach(),
        })?;
        let pixel = |i: usize| self.centre[i] + self.focal[i] * bent.at[i];
        let row = |i: usize| {
            let [by_x, by_y] = bent.gradient[i];
            Vec3::new(by_x, by_y, -(by_x * x + by_y * y)) * (self.focal[i] / depth)
        };
        Ok(([pixel(0), pixel(1)], [row(0), row(1)]))
    }

    /// Derivatives of the pixel of a point in the camera's frame, which it sees, by the focal
    /// lengths, the principal point and the first twelve coefficients of a lens without tilt.
    pub(super) fn by_parameters(&self, point: Vec3) -> [[f64; 2]; LENS_PARAMETERS] {
        let ideal = [point.x / point.z, point.y / point.z];
        let [fx, fy] = self.focal;
        let mut all = [[0.0; 2]; LENS_PARAMETERS];
        if let Some(bent) = self.distortion.bend(ideal) {
            all[0] = [bent.at[0], 0.0];
            all[1] = [0.0, bent.at[1]];
        }
        all[2] = [1.0, 0.0];
        all[3] = [0.0, 1.0];
        for (entry, [x, y]) in all[4..].iter_mut().zip(self.distortion.by_coefficients(ideal)) {
            *entry = [fx * x, fy * y];
        }
        all
    }
}
