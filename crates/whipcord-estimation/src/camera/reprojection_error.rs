//! How far a point is from where a camera saw it.

use whipcord_numerics::Vec3;

use super::error::ViewError;
use super::view::{Camera, Ray};

/// How far a point is from where it was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReprojectionError {
    /// Where the camera sees the point: column and row.
    pub pixel: [f64; 2],
    /// Distance in the image in pixels.
    pub pixels: f64,
    /// Distance in m of the point from the ray through the pixel at which it was seen, (c7): what an image
    /// can tell of the distance in space, which is never less.
    pub distance: f64,
}

impl Ray {
    /// Distance in m of a point from the ray.
    #[must_use]
    pub fn distance(&self, point: Vec3) -> f64 {
        self.direction.cross(point - self.origin).norm()
    }
}

impl Camera {
    /// How far a point of the world, in m, is from the pixel at which it was seen.
    ///
    /// ```
    /// use whipcord_estimation::camera::{Camera, Lens, Orthographic};
    /// use whipcord::{Pose, Vec3};
    ///
    /// let lens = Lens::Orthographic(Orthographic::new(4000.0, [320.0, 240.0])?);
    /// let camera = Camera::new(lens, Pose::IDENTITY, None)?;
    /// let error = camera.reprojection_error(Vec3::new(0.01, 0.0, 0.5), [363.0, 244.0])?;
    /// assert_eq!((error.pixel, error.pixels), ([360.0, 240.0], 5.0));
    /// assert!((error.distance - 0.00125).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ViewError`] where the camera does not see the point, or nothing through the pixel.
    pub fn reprojection_error(
        &self,
        point: Vec3,
        seen: [f64; 2],
    ) -> Result<ReprojectionError, ViewError> {
        let pixel = self.project(point)?;
        let pixels = (pixel[0] - seen[0]).hypot(pixel[1] - seen[1]);
        Ok(ReprojectionError { pixel, pixels, distance: self.ray(seen)?.distance(point) })
    }
}

#[cfg(test)]
mod tests {
    use whipcord_numerics::Pose;

    use super::super::{Distortion, Lens, Pinhole};
    use super::*;

    #[test]
    fn a_point_moved_across_the_view_misses_by_as_much() -> Result<(), Box<dyn core::error::Error>>
    {
        let distortion = Distortion::new(&[-0.2, 0.05, 1e-3, -2e-3, 0.01])?;
        let pinhole = Pinhole::new([800.0, 780.0], [310.0, 250.0], distortion)?;
        let camera = Camera::new(Lens::Pinhole(pinhole), Pose::IDENTITY, None)?;
        let point = Vec3::new(0.04, -0.03, 0.5);
        let across = point.cross(Vec3::X);
        let across = across * (2e-3 / across.norm());
        let miss = camera.reprojection_error(point + across, camera.project(point)?)?;
        assert!((miss.distance - 2e-3).abs() < 1e-12, "{}", miss.distance);
        // Some 800 px at a distance of 0.5 m, less what the lens bends.
        assert!((2.8..3.3).contains(&miss.pixels), "{}", miss.pixels);
        assert!(camera.reprojection_error(point, camera.project(point)?)?.distance < 1e-12);
        Ok(())
    }
}
