//! The point that two cameras see.

use whipcord_numerics::least_squares::{NoResiduals, Options, Residuals, Workspace, minimise};
use whipcord_numerics::{Mat3, Vec3};

use super::error::TriangulateError;
use crate::camera::lens::Lens;
use crate::camera::view::{Camera, Ray};

/// Lines of sight with a smaller angle between them, in rad, are parallel: errors of a pixel are larger.
const PARALLEL: f64 = 1e-3;
/// Cameras nearer to one another than this, in m, are in one place.
const ONE_PLACE: f64 = 1e-6;

/// A point that two cameras see, and how sure it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangulated {
    /// The point in the world, in m.
    pub point: Vec3,
    /// Its covariance in m², eq. (s3), by the errors of the pixels alone: those of the cameras' poses and lenses are not part
    /// of it.
    pub covariance: Mat3,
    /// By how many columns and rows each camera sees it beside where it has the point.
    pub residuals: [[f64; 2]; 2],
    /// Distance of the two pixels from the nearest two that have lines of sight which meet, in pixels, eq. (s4).
    pub epipolar: f64,
    /// Angle between the lines of sight, in rad.
    pub angle: f64,
}

impl Triangulated {
    /// Standard deviations of the coordinates in m.
    #[must_use]
    pub fn deviations(&self) -> Vec3 {
        let variance = |i: usize| self.covariance.rows[i][i].max(0.0).sqrt();
        Vec3::new(variance(0), variance(1), variance(2))
    }

    /// One standard deviation for all three coordinates, in m: the root of the mean of their variances.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        self.deviations().norm() / 3.0_f64.sqrt()
    }
}

/// The point that two cameras with known poses see at these pixels, such that the squares of the distances in both images
/// are least, eq. (s2); and its covariance, where columns and rows have this standard deviation in pixels.
///
/// ```
/// use whipcord_estimation::camera::{Camera, Distortion, Lens, Pinhole, triangulate};
/// use whipcord::{Pose, UnitQuaternion, Vec3};
///
/// let lens = Lens::Pinhole(Pinhole::new([800.0, 800.0], [319.5, 239.5], Distortion::NONE)?);
/// let left = Camera::new(lens, Pose::IDENTITY, Some([640, 480]))?;
/// let rotation = UnitQuaternion::exp(Vec3::new(0.0, -0.5, 0.0));
/// let right = left.at(Pose { position: Vec3::new(0.25, 0.0, 0.05), rotation })?;
/// let point = Vec3::new(0.02, -0.01, 0.5);
/// let pixels = [left.project(point)?, right.project(point)?];
/// let found = triangulate([&left, &right], pixels, 0.3)?;
/// assert!((found.point - point).norm() < 1e-9 && found.epipolar < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`TriangulateError`] where the cameras do not determine the point.
pub fn triangulate(
    cameras: [&Camera; 2],
    pixels: [[f64; 2]; 2],
    pixel_deviation: f64,
) -> Result<Triangulated, TriangulateError> {
    if !(pixel_deviation > 0.0 && pixel_deviation.is_finite()) {
        return Err(TriangulateError::Deviation { given: pixel_deviation });
    }
    refuse_one_place(cameras)?;
    let ray = |camera: usize| {
        let found = cameras[camera].ray(pixels[camera]);
        found.map_err(|error| TriangulateError::Unseen { camera, error })
    };
    let rays = [ray(0)?, ray(1)?];
    let (start, angle) = nearest_to_both(rays)?;
    let mut problem = InBoth { cameras, pixels };
    let mut unknowns = start.to_array();
    let options = Options::default();
    let outcome = minimise(&mut problem, &mut unknowns, &options, &mut Workspace::default());
    let outcome = outcome.map_err(|error| match error {
        NoResiduals::Refused(error) => error,
        NoResiduals::NotFinite => TriangulateError::NoParallax { angle },
    })?;
    let epipolar = (2.0 * outcome.cost).sqrt();
    let point = Vec3::from(unknowns);
    let (residuals, gradients) = problem.at(point)?;
    let (mut normal, mut slope) = (Mat3::default(), Vec3::ZERO);
    let rows = gradients.into_iter().flatten().zip(residuals.into_iter().flatten());
    for (gradient, residual) in rows {
        slope += residual * gradient;
        let dyad = Mat3::outer(gradient, gradient);
        for i in 0..3 {
            normal.rows[i] += dyad.rows[i];
        }
    }
    let inverse = normal.inverse().ok_or(TriangulateError::NoParallax { angle })?;
    // What a further step would change in the images, in pixels: where that is rounding, a step may lower nothing.
    let change = slope.dot(inverse * slope).max(0.0).sqrt();
    if !outcome.status.is_converged() && change > 1e-4 {
        return Err(TriangulateError::NotConverged { distance: epipolar });
    }
    let covariance = inverse * (pixel_deviation * pixel_deviation);
    Ok(Triangulated { point, covariance, residuals, epipolar, angle })
}

/// Two pinholes in one place see the same of every point.
pub(super) fn refuse_one_place(cameras: [&Camera; 2]) -> Result<(), TriangulateError> {
    let pinholes = cameras.iter().all(|camera| matches!(camera.lens(), Lens::Pinhole(_)));
    let baseline = (cameras[0].pose().position - cameras[1].pose().position).norm();
    if pinholes && baseline < ONE_PLACE {
        return Err(TriangulateError::NoBaseline { baseline });
    }
    Ok(())
}

/// Eq. (s1): the middle of the shortest line between two rays, and the angle between them in rad.
fn nearest_to_both([a, b]: [Ray; 2]) -> Result<(Vec3, f64), TriangulateError> {
    let cross = a.direction.cross(b.direction);
    let cosine = a.direction.dot(b.direction);
    let angle = cross.norm().atan2(cosine);
    // Against one another the lines of sight meet nowhere but on the line between the cameras.
    if cross.norm() < PARALLEL {
        return Err(TriangulateError::NoParallax { angle });
    }
    let between = b.origin - a.origin;
    let square = cross.dot(cross);
    let along_a = between.cross(b.direction).dot(cross) / square;
    let along_b = between.cross(a.direction).dot(cross) / square;
    let point = 0.5 * ((a.origin + along_a * a.direction) + (b.origin + along_b * b.direction));
    Ok((point, angle))
}

/// Columns and rows by which each camera sees something beside a point.
type Off = [[f64; 2]; 2];
/// Their derivatives by the point, with the opposite sign.
type Gradients = [[Vec3; 2]; 2];

/// What is made small: the distances in both images.
struct InBoth<'a> {
    cameras: [&'a Camera; 2],
    pixels: [[f64; 2]; 2],
}

impl InBoth<'_> {
    /// By how much each camera sees the pixels beside the point, and how the point's pixels change with it.
    fn at(&self, point: Vec3) -> Result<(Off, Gradients), TriangulateError> {
        let seen = |camera: usize| {
            let found = self.cameras[camera].project_with_gradient(point);
            found.map_err(|error| TriangulateError::Unseen { camera, error })
        };
        let both = [seen(0)?, seen(1)?];
        let residuals = [0, 1].map(|c| [0, 1].map(|i| self.pixels[c][i] - both[c].pixel[i]));
        Ok((residuals, both.map(|seen| seen.by_point)))
    }
}

impl Residuals for InBoth<'_> {
    type Refusal = TriangulateError;

    fn count(&self) -> usize {
        4
    }

    fn residuals(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), TriangulateError> {
        let (residuals, _) = self.at(Vec3::new(unknowns[0], unknowns[1], unknowns[2]))?;
        for (entry, value) in into.iter_mut().zip(residuals.into_iter().flatten()) {
            *entry = -value;
        }
        Ok(())
    }

    fn jacobian(&mut self, unknowns: &[f64], into: &mut [f64]) -> Result<(), TriangulateError> {
        let (_, gradients) = self.at(Vec3::new(unknowns[0], unknowns[1], unknowns[2]))?;
        for (row, gradient) in into.chunks_exact_mut(3).zip(gradients.into_iter().flatten()) {
            row.copy_from_slice(&gradient.to_array());
        }
        Ok(())
    }
}
