//! Cameras.

use std::path::PathBuf;

use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use whipcord::{Pose, UnitQuaternion, Vec3};
use whipcord_estimation::camera::{
    self, CameraError, Distortion, Lens, LocateError, Orthographic, Pinhole, Sighting, ViewError,
};
use whipcord_io::{CalibratedCamera, CameraFormat};

use crate::convert::array;
use crate::errors;

/// A lens in its place.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Camera {
    pub inner: camera::Camera,
    /// How sure its lens is; `None` where it is taken as it is.
    pub lens_covariance: Option<Vec<Vec<f64>>>,
}

/// Position and quaternion (w, x, y, z).
type Place = ([f64; 3], [f64; 4]);

/// Covariance of position and rotation, and the standard deviation of a column or row.
pub type Sure<'py> = (Option<Bound<'py, PyArray2<f64>>>, Option<f64>);

/// Camera, residuals, RMS, the next best camera with its RMS, whether it is as good, how sure the pose is, and how sure the scale is.
type Located<'py> =
    (Camera, Bound<'py, PyArray2<f64>>, f64, Option<(Camera, f64)>, bool, Sure<'py>, Option<f64>);

#[pymethods]
impl Camera {
    #[staticmethod]
    fn pinhole(
        py: Python<'_>,
        focal: [f64; 2],
        centre: [f64; 2],
        distortion: Vec<f64>,
        place: Place,
        size: Option<[u32; 2]>,
    ) -> PyResult<Self> {
        let lens = Distortion::new(&distortion)
            .and_then(|distortion| Pinhole::new(focal, centre, distortion));
        Self::new(py, lens.map(Lens::Pinhole), place, size)
    }

    #[staticmethod]
    fn orthographic(
        py: Python<'_>,
        scale: f64,
        centre: [f64; 2],
        place: Place,
        size: Option<[u32; 2]>,
    ) -> PyResult<Self> {
        Self::new(py, Orthographic::new(scale, centre).map(Lens::Orthographic), place, size)
    }

    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        whipcord_io::load_calibrated_camera(&path)
            .map(|CalibratedCamera { camera, lens_covariance }| Self {
                inner: camera,
                lens_covariance,
            })
            .map_err(|error| errors::file(py, &error, &path.display().to_string()))
    }

    /// The text of a camera file of this name.
    fn text(&self, py: Python<'_>, path: PathBuf) -> PyResult<String> {
        let format = CameraFormat::of(&path).ok_or_else(|| {
            let message = format!(
                "camera files are written as YAML or JSON: `{}` should end in .yml, .yaml or .json",
                path.display()
            );
            errors::input(py, "path", message)
        })?;
        let lens_covariance = self.lens_covariance.clone();
        let written = CalibratedCamera { camera: self.inner, lens_covariance };
        Ok(whipcord_io::calibrated_camera_text(&written, format))
    }

    /// The same camera whose lens has this covariance.
    fn with_lens_covariance(&self, rows: Option<Vec<Vec<f64>>>) -> Self {
        Self { lens_covariance: rows, ..Self::of(self.inner) }
    }

    /// Covariance of the lens, by rows.
    #[getter]
    fn lens_covariance(&self) -> Option<Vec<Vec<f64>>> {
        self.lens_covariance.clone()
    }

    /// Focal lengths and distortion coefficients of a pinhole.
    #[getter]
    fn lens(&self) -> Option<([f64; 2], Vec<f64>)> {
        match self.inner.lens() {
            Lens::Pinhole(lens) => Some((lens.focal(), lens.distortion().coefficients().to_vec())),
            Lens::Orthographic(_) => None,
        }
    }

    /// Pixels per metre of an orthographic camera.
    #[getter]
    fn scale(&self) -> Option<f64> {
        match self.inner.lens() {
            Lens::Pinhole(_) => None,
            Lens::Orthographic(lens) => Some(lens.scale()),
        }
    }

    #[getter]
    fn centre(&self) -> [f64; 2] {
        match self.inner.lens() {
            Lens::Pinhole(lens) => lens.centre(),
            Lens::Orthographic(lens) => lens.centre(),
        }
    }

    #[getter]
    fn place(&self) -> Place {
        let Pose { position, rotation } = self.inner.pose();
        (position.to_array(), rotation.wxyz())
    }

    /// OpenCV's `rvec` and `tvec`.
    #[getter]
    fn extrinsics(&self) -> ([f64; 3], [f64; 3]) {
        let Pose { position, rotation } = self.inner.pose().inverse();
        (rotation.log().to_array(), position.to_array())
    }

    #[getter]
    fn size(&self) -> Option<[u32; 2]> {
        self.inner.size()
    }

    /// (n, 2) pixels of (n, 3) points.
    fn project<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &points, "points", |point| self.inner.project(point.into()))
    }

    /// (n, 2) ideal images of (n, 2) pixels.
    fn undistort<'py>(
        &self,
        py: Python<'py>,
        pixels: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &pixels, "pixels", |pixel| self.inner.undistort(pixel))
    }

    /// (n, 6) origins and directions of the rays through (n, 2) pixels.
    fn rays<'py>(
        &self,
        py: Python<'py>,
        pixels: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &pixels, "pixels", |pixel| {
            let camera::Ray { origin, direction } = self.inner.ray(pixel)?;
            let ([a, b, c], [d, e, f]) = (origin.to_array(), direction.to_array());
            Ok([a, b, c, d, e, f])
        })
    }

    /// The same lens in the place that (n, 3) points at (n, 2) pixels say.
    #[pyo3(signature = (points, pixels, view = None, pixel_deviation = None))]
    fn locate<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        pixels: PyReadonlyArray2<'py, f64>,
        view: Option<[f64; 3]>,
        pixel_deviation: Option<f64>,
    ) -> PyResult<Located<'py>> {
        let seen = sightings(&points, &pixels);
        let (size, view) = (self.inner.size(), view.map(Vec3::from));
        let found = match self.inner.lens() {
            Lens::Pinhole(lens) => camera::locate(lens, size, &seen, view),
            Lens::Orthographic(_) => camera::locate_orthographic(size, &seen, view),
        };
        located(py, found, pixel_deviation, self.lens_covariance.clone())
    }
}

/// An orthographic camera, from (n, 3) points at (n, 2) pixels.
#[pyfunction]
#[pyo3(signature = (points, pixels, size = None, view = None, pixel_deviation = None))]
pub fn locate_orthographic<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    pixels: PyReadonlyArray2<'py, f64>,
    size: Option<[u32; 2]>,
    view: Option<[f64; 3]>,
    pixel_deviation: Option<f64>,
) -> PyResult<Located<'py>> {
    let seen = sightings(&points, &pixels);
    let found = camera::locate_orthographic(size, &seen, view.map(Vec3::from));
    located(py, found, pixel_deviation, None)
}

fn located<'py>(
    py: Python<'py>,
    found: Result<camera::Located, LocateError>,
    pixel: Option<f64>,
    lens_covariance: Option<Vec<Vec<f64>>>,
) -> PyResult<Located<'py>> {
    let found = found.map_err(|error| errors::input(py, "points", error.to_string()))?;
    let ambiguous = found.is_ambiguous();
    let other = found.other.map(|other| (Camera::of(other.camera), other.rms));
    let count = found.residuals.len();
    let residuals = array(py, found.residuals.concat(), [count, 2])?;
    let sure = sure(py, &found.uncertainty, pixel, lens_covariance.as_deref())?;
    let scale = found.uncertainty.relative_scale_deviation(pixel);
    let camera = Camera { inner: found.camera, lens_covariance };
    Ok((camera, residuals, found.rms, other, ambiguous, sure, scale))
}

/// How sure the pose of a camera is, by pixels with this deviation or as the residuals tell it, and by the lens.
pub fn sure<'py>(
    py: Python<'py>,
    of: &camera::PoseUncertainty,
    pixel: Option<f64>,
    lens_covariance: Option<&[Vec<f64>]>,
) -> PyResult<Sure<'py>> {
    let covariance = of.covariance(pixel, lens_covariance);
    let covariance = covariance.map(|of| array(py, of.concat(), [6, 6])).transpose()?;
    Ok((covariance, pixel.or(of.pixel)))
}

/// (n, 3) points at (n, 2) pixels.
pub fn sightings(
    points: &PyReadonlyArray2<'_, f64>,
    pixels: &PyReadonlyArray2<'_, f64>,
) -> Vec<Sighting> {
    let (points, pixels) = (points.as_array(), pixels.as_array());
    let rows = points.rows().into_iter().zip(pixels.rows());
    rows.map(|(point, pixel)| Sighting {
        point: Vec3::new(point[0], point[1], point[2]),
        pixel: [pixel[0], pixel[1]],
    })
    .collect()
}

/// What becomes of each row; the first that is refused is named.
fn rows<'py, const N: usize, const M: usize>(
    py: Python<'py>,
    given: &PyReadonlyArray2<'py, f64>,
    name: &str,
    each: impl Fn([f64; N]) -> Result<[f64; M], ViewError>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let given = given.as_array();
    let mut values = Vec::with_capacity(M * given.nrows());
    for (i, row) in given.rows().into_iter().enumerate() {
        let row = core::array::from_fn(|j| row[j]);
        let found = each(row).map_err(|error| {
            let path = format!("{name}[{i}]");
            errors::input(py, &path, format!("{path}: {error}"))
        })?;
        values.extend(found);
    }
    array(py, values, [given.nrows(), M])
}

impl Camera {
    pub const fn of(inner: camera::Camera) -> Self {
        Self { inner, lens_covariance: None }
    }

    fn new(
        py: Python<'_>,
        lens: Result<Lens, CameraError>,
        (position, orientation): Place,
        size: Option<[u32; 2]>,
    ) -> PyResult<Self> {
        let [w, x, y, z] = orientation;
        let rotation = UnitQuaternion { w, v: Vec3::new(x, y, z) };
        let pose = Pose { position: position.into(), rotation };
        lens.and_then(|lens| camera::Camera::new(lens, pose, size))
            .map(Self::of)
            .map_err(|error| errors::input(py, "camera", error.to_string()))
    }
}
