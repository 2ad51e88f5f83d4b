//! Lenses, calibrated by photographs of boards.

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use whipcord::Pose;
use whipcord_estimation::camera::{self, FreeParameters, Lens};
use whipcord_vision::boards::{self, Corner, SeenBoard, Unseen, calibration};

use crate::camera::{Camera, sightings};
use crate::errors;
use crate::photo::Photo;
use crate::wait::interruptible;

/// A board that cameras are calibrated with.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Board {
    pub inner: boards::Board,
}

/// What a photograph shows of a board, or why nothing of it can be used.
#[pyclass(frozen, module = "whipcord._core")]
pub struct Seen {
    pub inner: Result<SeenBoard, Unseen>,
}

/// Focal lengths, principal point, distortion coefficients and pixels: the standard deviations of them.
type Deviations = ([f64; 2], [f64; 2], Vec<Option<f64>>, f64, Vec<Vec<f64>>);
/// Camera; deviations; RMS, those of the photographs, and tilt; photographs that were used, and those that were not and why;
/// warnings.
type Calibrated =
    (Camera, Deviations, (f64, Vec<f64>, f64), Vec<usize>, Vec<(usize, String)>, Vec<String>);

#[pymethods]
impl Board {
    /// As `chessboard:9x6` or `charuco:8x6` says, with sides in m.
    #[new]
    #[pyo3(signature = (layout, square, marker, dictionary))]
    fn new(
        py: Python<'_>,
        layout: &str,
        square: f64,
        marker: Option<f64>,
        dictionary: Option<&str>,
    ) -> PyResult<Self> {
        boards::Board::described(layout, square, marker, dictionary)
            .map(|inner| Self { inner })
            .map_err(|error| errors::input(py, "board", error.to_string()))
    }

    /// What a photograph shows of it.
    fn find(&self, py: Python<'_>, photo: &Bound<'_, Photo>) -> PyResult<Seen> {
        let (board, photo) = (self.inner, photo.clone().unbind());
        let inner = interruptible(py, move || boards::find(&photo.get().inner, &board))?;
        Ok(Seen { inner })
    }
}

#[pymethods]
impl Seen {
    /// What others have found: (n, 3) points of a flat board in m at (n, 2) pixels of an image of this size.
    #[new]
    fn new(
        size: [u32; 2],
        points: PyReadonlyArray2<'_, f64>,
        pixels: PyReadonlyArray2<'_, f64>,
    ) -> Self {
        let sightings = sightings(&points, &pixels).into_iter().enumerate();
        let corners = sightings.map(|(number, seen)| Corner { number, seen }).collect();
        Self { inner: Ok(SeenBoard { size, corners }) }
    }

    /// Numbers of the corners, and where they are on the board and in the photograph.
    #[getter]
    fn corners(&self) -> Vec<(usize, [f64; 3], [f64; 2])> {
        let corners = self.inner.iter().flat_map(|seen| &seen.corners);
        corners.map(|c| (c.number, c.seen.point.to_array(), c.seen.pixel)).collect()
    }
}

/// The lens by what photographs show of a board, with the distortion coefficients of this name.
#[pyfunction]
pub fn calibrate(
    py: Python<'_>,
    seen: Vec<PyRef<'_, Seen>>,
    distortion: &str,
) -> PyResult<Calibrated> {
    let free_parameters = FreeParameters::ALL
        .into_iter()
        .find(|free_parameters| free_parameters.name() == distortion);
    let free_parameters = free_parameters.ok_or_else(|| {
        let names = FreeParameters::ALL.map(FreeParameters::name).join(", ");
        let message = format!("distortion must be one of {names}, but is {distortion}");
        errors::input(py, "distortion", message)
    })?;
    let seen: Vec<_> = seen.iter().map(|seen| seen.inner.clone()).collect();
    let found = interruptible(py, move || calibration(&seen, free_parameters))?;
    let found = found.map_err(|error| errors::calibration(py, &error))?;
    let camera =
        camera::Camera::new(Lens::Pinhole(found.calibrated.lens), Pose::IDENTITY, Some(found.size))
            .map_err(|error| errors::input(py, "photos", error.to_string()))?;
    let camera::Calibrated { deviations: sure, rms, view_rms, tilt, .. } = found.calibrated;
    Ok((
        Camera { inner: camera, lens_covariance: Some(sure.covariance.clone()) },
        (sure.focal, sure.centre, sure.distortion, sure.pixel, sure.covariance),
        (rms, view_rms, tilt),
        found.used,
        found.refused.into_iter().map(|(number, why)| (number, why.to_string())).collect(),
        found.warnings.iter().map(ToString::to_string).collect(),
    ))
}
