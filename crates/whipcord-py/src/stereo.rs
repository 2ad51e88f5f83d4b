//! Two cameras: their relative pose, and points in space.

use numpy::{PyArray1, PyArray2, PyArray3, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord::Vec3;
use whipcord_estimation::camera::{self, Lens, Pinhole};
use whipcord_vision::PointsInSpace;
use whipcord_vision::boards::stereo;
use whipcord_vision::detect::Mark;

use crate::calibration::{Board, Seen};
use crate::camera::{Camera, Sure, sightings, sure};
use crate::convert::array;
use crate::errors;
use crate::wait::interruptible;

/// Cameras, residuals of each, RMS of each, the next best first camera with its RMS, whether it is as good, and how sure the first is.
type LocatedPair<'py> =
    ([Camera; 2], [Bound<'py, PyArray2<f64>>; 2], [f64; 2], Option<(Camera, f64)>, bool, Sure<'py>);

/// Two cameras that keep their pose relative to one another, in the place that (n, 3) points at (n, 2) pixels of each say.
#[pyfunction]
#[pyo3(signature = (cameras, points, pixels, view = None, pixel_deviation = None))]
pub fn locate_pair<'py>(
    py: Python<'py>,
    cameras: [PyRef<'_, Camera>; 2],
    points: [PyReadonlyArray2<'py, f64>; 2],
    pixels: [PyReadonlyArray2<'py, f64>; 2],
    view: Option<[f64; 3]>,
    pixel_deviation: Option<f64>,
) -> PyResult<LocatedPair<'py>> {
    let seen = [0, 1].map(|i| sightings(&points[i], &pixels[i]));
    let both = [&cameras[0].inner, &cameras[1].inner];
    let found = camera::locate_rig(both, [&seen[0], &seen[1]], view.map(Vec3::from));
    let found = found.map_err(|error| errors::input(py, "points", error.to_string()))?;
    let ambiguous = found.is_ambiguous();
    let residuals = |i: usize| {
        let of = &found.residuals[i];
        array(py, of.concat(), [of.len(), 2])
    };
    let residuals = [residuals(0)?, residuals(1)?];
    let other = found.other.map(|other| (Camera::of(other.camera), other.rms));
    let sure = sure(py, &found.uncertainty, pixel_deviation, None)?;
    let [first, second] = found.cameras;
    let placed = [(first, &cameras[0]), (second, &cameras[1])]
        .map(|(inner, lens)| Camera { inner, lens_covariance: lens.lens_covariance.clone() });
    Ok((placed, residuals, found.rms, other, ambiguous, sure))
}

/// The pose of the second camera relative to the first, from what both show of a board at each time. Without a board, the points of
/// each photograph are given, in one numbering. Cameras whose lenses were calibrated have the covariances of them.
#[pyfunction]
#[pyo3(signature = (cameras, seen, board = None))]
pub fn calibrate_two<'py>(
    py: Python<'py>,
    cameras: [PyRef<'_, Camera>; 2],
    seen: [Vec<PyRef<'_, Seen>>; 2],
    board: Option<&Board>,
) -> PyResult<([Camera; 2], Bound<'py, PyDict>)> {
    let mut lenses: Vec<Pinhole> = Vec::with_capacity(2);
    for camera in &cameras {
        let Lens::Pinhole(lens) = *camera.inner.lens() else {
            let message = "an orthographic camera cannot be calibrated by a board";
            return Err(errors::input(py, "lenses", message.to_owned()));
        };
        lenses.push(lens);
    }
    let found =
        seen.each_ref().map(|of| of.iter().map(|seen| seen.inner.clone()).collect::<Vec<_>>());
    let size = |i: usize| {
        let photographs = found[i].iter().flatten().next().map(|board| board.size);
        cameras[i].inner.size().or(photographs)
    };
    let first = cameras[0].inner.pose();
    let board = board.map(|board| board.inner);
    let sizes = [size(0), size(1)].map(Option::unwrap_or_default);
    let found = interruptible(py, move || {
        stereo(board.as_ref(), [&found[0], &found[1]], [&lenses[0], &lenses[1]], sizes)
    })?;
    let found = found.map_err(|error| errors::stereo(py, &error))?;
    let covariances = cameras.each_ref().map(|camera| camera.lens_covariance.as_deref());
    let of = found.calibrated.with_lens_covariances(covariances);
    let relative = of.cameras[1].pose();
    let values = PyDict::new(py);
    values.set_item("rms", of.rms)?;
    values.set_item("epipolar", of.epipolar)?;
    values.set_item("position", relative.position.to_array())?;
    values.set_item("rotation", relative.rotation.log().to_array())?;
    values.set_item("covariance", array(py, of.covariance.concat(), [6, 6])?)?;
    values.set_item("baseline", of.baseline[0])?;
    values.set_item("baseline_deviation", of.baseline[1])?;
    values.set_item("pixel_deviation", of.pixel)?;
    let pairs: Vec<_> = of
        .pairs
        .iter()
        .map(|pair| (pair.number, pair.common, pair.rms, pair.epipolar, pair.renumbered))
        .collect();
    values.set_item("pairs", pairs)?;
    let refused: Vec<(usize, String)> =
        found.refused.iter().map(|(number, why)| (*number, why.to_string())).collect();
    values.set_item("refused", refused)?;
    let placed = of.cameras.map(|camera| camera.at(first * camera.pose()));
    let [first, second] = placed;
    let refused = |error: camera::CameraError| errors::input(py, "lenses", error.to_string());
    let placed = [first.map_err(refused)?, second.map_err(refused)?];
    let [a, b] = cameras.map(|camera| camera.lens_covariance.clone());
    let [first, second] = placed;
    let first = Camera { inner: first, lens_covariance: a };
    Ok(([first, Camera { inner: second, lens_covariance: b }], values))
}

/// Points, covariances, residuals, epipolar distances and angles.
type Points<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray3<f64>>,
    Bound<'py, PyArray3<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

fn points<'py>(
    py: Python<'py>,
    found: impl ExactSizeIterator<Item = camera::Triangulated>,
) -> PyResult<Points<'py>> {
    let count = found.len();
    let (mut at, mut covariances, mut residuals) = (Vec::new(), Vec::new(), Vec::new());
    let (mut epipolar, mut angles) = (Vec::new(), Vec::new());
    for point in found {
        at.extend(point.point.to_array());
        covariances.extend(point.covariance.rows.iter().flat_map(|row| row.to_array()));
        residuals.extend(point.residuals.concat());
        epipolar.push(point.epipolar);
        angles.push(point.angle);
    }
    Ok((
        array(py, at, [count, 3])?,
        array(py, covariances, [count, 3, 3])?,
        array(py, residuals, [count, 2, 2])?,
        array(py, epipolar, [count])?,
        array(py, angles, [count])?,
    ))
}

/// Points that two cameras see at (n, 2) pixels each.
#[pyfunction]
pub fn triangulate<'py>(
    py: Python<'py>,
    cameras: [PyRef<'_, Camera>; 2],
    pixels: [PyReadonlyArray2<'py, f64>; 2],
    deviation: f64,
) -> PyResult<Points<'py>> {
    let pixels = pixels.each_ref().map(PyReadonlyArray2::as_array);
    let rows = pixels[0].rows().into_iter().zip(pixels[1].rows()).enumerate();
    let found = rows.map(|(i, (first, second))| {
        let pixels = [[first[0], first[1]], [second[0], second[1]]];
        let found = camera::triangulate([&cameras[0].inner, &cameras[1].inner], pixels, deviation);
        found.map_err(|error| {
            let path = format!("pixels[{i}]");
            errors::input(py, &path, format!("{path}: {error}"))
        })
    });
    let found: Vec<camera::Triangulated> = found.collect::<PyResult<_>>()?;
    points(py, found.into_iter())
}

/// A mark: the number of its disk and its pixel, radius, axis and confidence.
type Found = (usize, [f64; 2], f64, [f64; 2], f64);
/// A pair that is left out: its numbers, its epipolar distance, and why.
type LeftOut = ([usize; 2], Option<f64>, String);

/// Numbers and points of what both photographs show, what is left out, and what one alone shows.
type InSpace<'py> = (Vec<usize>, Points<'py>, Vec<LeftOut>, [Vec<usize>; 2]);

/// Numbers and points of what both photographs show, what is left out, and what one alone shows.
#[pyfunction]
pub fn in_space<'py>(
    py: Python<'py>,
    cameras: [PyRef<'_, Camera>; 2],
    marks: [Vec<Found>; 2],
    has_numbers: bool,
    limit: f64,
    deviation: f64,
) -> PyResult<InSpace<'py>> {
    let mark = |(number, pixel, radius, axis, confidence): Found| {
        (number, Mark { pixel, radius, axis, confidence })
    };
    let marks = marks.map(|of| of.into_iter().map(mark).collect::<Vec<_>>());
    let found = PointsInSpace::of(
        [&cameras[0].inner, &cameras[1].inner],
        [&marks[0], &marks[1]],
        has_numbers,
        limit,
        deviation,
    );
    let found = found.map_err(|error| errors::not_in_space(py, &error))?;
    let numbers = found.used.iter().map(|point| point.disk).collect();
    let at = points(py, found.used.iter().map(|point| point.found))?;
    let left_out = found.left_out.into_iter().map(|out| (out.disks, out.epipolar, out.why));
    Ok((numbers, at, left_out.collect(), found.single))
}

/// The text of a CSV file with points in space, as `[measured]` takes it.
#[pyfunction]
pub fn points_csv(
    py: Python<'_>,
    step: Option<usize>,
    points: Vec<(usize, [f64; 3], [f64; 3], f64)>,
) -> PyResult<String> {
    let rows = points.into_iter().map(|(disk, position, deviations, epipolar)| {
        let (position, deviations) = (position.into(), deviations.into());
        whipcord_io::SpacePoint { disk, position, deviations, epipolar }
    });
    let text = whipcord_io::points_csv(step, rows).to_csv();
    text.map_err(|error| errors::input(py, "points", error.to_string()))
}
