//! A camera: a lens in its place, and what it sees.

use whipcord_numerics::{Pose, UnitQuaternion, Vec3};

use super::error::{CameraError, ViewError};
use super::lens::Lens;
use whipcord::robot::Problem;
use whipcord::robot::limits::{COORDINATE, IMAGE_SIZE};

/// Coordinates beyond this are not computed with, in m and in pixels.
const FARTHEST: f64 = 1e9;

/// A lens, where it is in the world, and how large its images are.
///
/// ```
/// use whipcord_estimation::camera::{Camera, Distortion, Lens, Pinhole};
/// use whipcord::{Pose, Vec3};
///
/// let distortion = Distortion::new(&[-0.2, 0.05, 0.0, 0.0])?;
/// let lens = Lens::Pinhole(Pinhole::new([800.0, 800.0], [319.5, 239.5], distortion)?);
/// let camera = Camera::new(lens, Pose::IDENTITY, Some([640, 480]))?;
/// let pixel = camera.project(Vec3::new(0.05, -0.02, 0.5))?;
/// let ray = camera.ray(pixel)?;
/// assert!(ray.direction.cross(Vec3::new(0.05, -0.02, 0.5)).norm() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    lens: Lens,
    pose: Pose,
    size: Option<[u32; 2]>,
}

/// Where a point is seen, and how that changes with the point and with the camera's pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Column and row.
    pub pixel: [f64; 2],
    /// Derivatives of column and row by the point in the world, in pixels per metre.
    pub by_point: [Vec3; 2],
    /// Derivatives by the position of the camera in the world, in pixels per metre.
    pub by_shift: [Vec3; 2],
    /// Derivatives by a turn φ of the camera about its own origin, δR = φ̂ R, about the axes of the
    /// world, in pixels per radian.
    pub by_turn: [Vec3; 2],
}

/// A half-line in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, in m: the centre of projection, or where the orthographic camera's image
    /// plane is met.
    pub origin: Vec3,
    /// Unit vector along it, away from the camera.
    pub direction: Vec3,
}

impl Camera {
    /// A camera with this lens, pose in the world, and number of columns and rows of its images,
    /// where that is known.
    ///
    /// # Errors
    /// [`CameraError`] for a pose or a size out of range.
    pub fn new(lens: Lens, pose: Pose, size: Option<[u32; 2]>) -> Result<Self, CameraError> {
        for i in 0..3 {
            CameraError::check(COORDINATE, "position", pose.position[i])?;
        }
        let norm = UnitQuaternion::from_wxyz(pose.rotation.wxyz());
        let [w, x, y, z] = pose.rotation.wxyz();
        let length = (w * w + x * x + y * y + z * z).sqrt();
        let rotation =
            norm.filter(|_| (length - 1.0).abs() < 1e-6).ok_or(CameraError::Quantity {
                what: "rotation",
                problem: Problem::NotUnit { norm: length },
            })?;
        for pixels in size.into_iter().flatten() {
            CameraError::check(IMAGE_SIZE, "image size", f64::from(pixels))?;
        }
        Ok(Self { lens, pose: Pose { rotation, ..pose }, size })
    }

    /// The lens.
    #[must_use]
    pub const fn lens(&self) -> &Lens {
        &self.lens
    }

    /// The camera's frame in the world.
    #[must_use]
    pub const fn pose(&self) -> Pose {
        self.pose
    }

    /// Columns and rows of its images, where known.
    #[must_use]
    pub const fn size(&self) -> Option<[u32; 2]> {
        self.size
    }

    /// The same camera elsewhere.
    ///
    /// # Errors
    /// [`CameraError`] for a pose out of range.
    pub fn at(&self, pose: Pose) -> Result<Self, CameraError> {
        Self::new(self.lens, pose, self.size)
    }

    /// A point of the world in the camera's frame, in m: its z is the depth.
    #[must_use]
    pub fn in_view(&self, point: Vec3) -> Vec3 {
        self.pose.rotation.conjugate().rotate(point - self.pose.position)
    }

    /// The pixel at which a point of the world, in m, is seen, (c1) to (c4). It may lie outside the image.
    ///
    /// # Errors
    /// [`ViewError`] where the camera does not see the point.
    pub fn project(&self, point: Vec3) -> Result<[f64; 2], ViewError> {
        Ok(self.project_with_gradient(point)?.pixel)
    }

    /// The pixel and its derivatives, (c6).
    ///
    /// # Errors
    /// [`ViewError`] where the camera does not see the point.
    pub fn project_with_gradient(&self, point: Vec3) -> Result<Projection, ViewError> {
        check_range(&point.to_array())?;
        let (pixel, in_camera) = self.lens.project(self.in_view(point))?;
        let arm = point - self.pose.position;
        let by_point = in_camera.map(|row| self.pose.rotation.rotate(row));
        Ok(Projection {
            pixel,
            by_point,
            by_shift: by_point.map(|row| -row),
            by_turn: by_point.map(|row| row.cross(arm)),
        })
    }

    /// The ideal image of a pixel, free of the lens: the tangents (x, y) = (X/Z, Y/Z) of a pinhole, as
    /// `cv::undistortPoints` gives them, or X and Y in m of an orthographic lens, in the camera's
    /// frame.
    ///
    /// # Errors
    /// [`ViewError::NoRay`] where the distortion has no inverse.
    pub fn undistort(&self, pixel: [f64; 2]) -> Result<[f64; 2], ViewError> {
        check_range(&pixel)?;
        self.lens.undistort(pixel)
    }

    /// All points of the world that are seen at a pixel.
    ///
    /// # Errors
    /// [`ViewError::NoRay`] where the distortion has no inverse.
    pub fn ray(&self, pixel: [f64; 2]) -> Result<Ray, ViewError> {
        let [x, y] = self.undistort(pixel)?;
        let turn = |v: Vec3| self.pose.rotation.rotate(v);
        Ok(match self.lens {
            Lens::Pinhole(_) => {
                let ideal = Vec3::new(x, y, 1.0);
                Ray { origin: self.pose.position, direction: turn(ideal / ideal.norm()) }
            }
            Lens::Orthographic(_) => Ray {
                origin: self.pose.position + turn(Vec3::new(x, y, 0.0)),
                direction: turn(Vec3::Z),
            },
        })
    }
}

pub(super) fn check_range(coordinates: &[f64]) -> Result<(), ViewError> {
    // Written so that a NaN is refused as well.
    match coordinates.iter().find(|c| c.is_nan() || c.abs() > FARTHEST) {
        Some(&value) => Err(ViewError::OutOfRange { value }),
        None => Ok(()),
    }
}
