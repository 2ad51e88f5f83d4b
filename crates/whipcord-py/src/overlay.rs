//! The models over a photograph.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::PyArray2;
use pyo3::prelude::*;
use whipcord::{Actuation, Case, Model, ModelKind, SolveError, Stations, Vec3};
use whipcord_estimation::observation::{self, InImage, Overlaid, Rms, in_image};
use whipcord_estimation::{Observation, Place, Seen};
use whipcord_plot::{
    FINE_STATIONS, OverlayOptions, Photograph, PlotError, RobotView, overlay_figure,
};

use crate::camera::Camera;
use crate::convert::array;
use crate::errors;
use crate::model;
use crate::photo::Photo;
use crate::setup::Setup;
use crate::solution::Solution;
use crate::wait::{Limit, within};

/// A marker that was seen: number of its disk from 1, arc length in m, offset in m, and pixel.
type Marker = (Option<usize>, f64, [f64; 3], [f64; 2]);
/// A model: its name, its answer, for each marker (k, 4) column and row where it has it, distance in pixels and in m,
/// NaN where the camera does not see it there, and their root mean squares; or why there is no answer.
type Run<'py> = (
    &'static str,
    Option<Solution>,
    Bound<'py, PyArray2<f64>>,
    Option<[f64; 2]>,
    Option<Bound<'py, PyAny>>,
);

/// Solves a step, from 0, of the case by each of these models and draws them as the camera sees them; `seen_by` is
/// its number among those of `[measured]`, `marks` what was found in the photograph instead, or a `table` of it. Without an answer,
/// there is no picture.
#[pyfunction]
#[pyo3(signature = (photo, setup, camera, seen_by, marks, table, step, models, title, width, timeout = None))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub fn overlay<'py>(
    py: Python<'py>,
    photo: &Photo,
    setup: &Bound<'py, Setup>,
    camera: &Camera,
    seen_by: Option<usize>,
    marks: Option<Vec<(usize, [f64; 2])>>,
    table: Option<PathBuf>,
    step: usize,
    models: Vec<String>,
    title: String,
    width: f64,
    timeout: Option<f64>,
) -> PyResult<(Option<String>, Vec<Marker>, Vec<Run<'py>>)> {
    let (handle, setup, camera) = (setup.clone().unbind(), setup.get(), camera.inner);
    let case = setup.case.step(step).ok_or_else(|| {
        let (step, count) = (step + 1, setup.case.before.len() + 1);
        errors::input(
            py,
            "step",
            format!("there is no step {step}: the case has steps 1 to {count}"),
        )
    })?;
    let taken = [photo.inner.width(), photo.inner.height()].map(|n| u32::try_from(n).unwrap_or(0));
    if let Some([w, h]) = camera.size().filter(|size| *size != taken) {
        let [columns, rows] = taken;
        let message = format!(
            "the camera is of pictures of {w}×{h} pixels, but the photograph has {columns}×{rows}"
        );
        return Err(errors::input(py, "camera", message));
    }
    let markers: Vec<InImage> = match (marks, table, &setup.file_data.measured, seen_by) {
        (Some(marks), ..) => {
            marks.into_iter().map(|mark| marker(py, setup, mark, step)).collect::<PyResult<_>>()?
        }
        (None, Some(table), ..) => {
            let seen = py.detach(|| whipcord_io::load_markers(&table, &setup.robot));
            let name = table.display().to_string();
            let seen = seen.map_err(|error| errors::file(py, &error, &name))?;
            in_image(&setup.robot, &seen, 0, 0)
        }
        (None, None, Some(measured), Some(number)) => {
            in_image(&setup.robot, &measured.observations, number, step)
        }
        _ => Vec::new(),
    };
    let kinds: Vec<ModelKind> =
        models.iter().map(|name| name.parse()).collect::<Result<_, _>>().map_err(
            |error: <ModelKind as core::str::FromStr>::Err| {
                errors::input(py, "models", error.to_string())
            },
        )?;
    let (of, seen) = (case.clone(), markers.clone());
    let timeout = timeout.map(|seconds| model::timeout(py, seconds)).transpose()?;
    let limit = Limit::starting_now(timeout);
    let cancel = limit.cancel.clone();
    let runs: Vec<(ModelKind, Result<Overlaid, SolveError>)> = within(py, &limit, move || {
        let robot = &handle.get().robot;
        let run = |kind| {
            let model = Model::new(kind, Stations::Disks, Actuation::Natural).cancelled_by(&cancel);
            observation::overlay(&model, robot, &of, &camera, &seen, FINE_STATIONS)
        };
        kinds.into_iter().map(|kind| (kind, run(kind))).collect()
    })?;
    if limit.cancel.is_cancelled() {
        return Err(errors::timed_out(py, "not all models were solved".to_owned(), None));
    }
    let length = setup.robot.backbone().length;
    let views: Vec<RobotView> = runs
        .iter()
        .filter_map(|(_, run)| Some(RobotView::overlaid(run.as_ref().ok()?, &markers, length)))
        .collect();
    let svg = if views.is_empty() {
        None
    } else {
        let measured = markers.iter().map(|marker| marker.pixel).collect();
        let options = OverlayOptions { title, measured, width };
        let bytes = photo.stored();
        let bytes = bytes.map_err(|error| errors::input(py, "photo", error.to_string()))?;
        let stored = Photograph { bytes: &bytes, size: taken };
        let svg = py.detach(|| overlay_figure(&setup.robot, &camera, stored, &views, &options));
        let refused = |error: PlotError| {
            let path = if matches!(error, PlotError::Size { .. }) { "width" } else { "camera" };
            errors::input(py, path, error.to_string())
        };
        Some(svg.map_err(refused)?)
    };
    let case = Arc::new(case);
    let runs = runs.into_iter().map(|(kind, run)| told(py, kind, run, &markers, &case));
    let runs = runs.collect::<PyResult<_>>()?;
    let told = |m: &InImage| (m.disk(), m.arc_length, m.seen.offset.to_array(), m.pixel);
    Ok((svg, markers.iter().map(told).collect(), runs))
}

fn told<'py>(
    py: Python<'py>,
    kind: ModelKind,
    run: Result<Overlaid, SolveError>,
    markers: &[InImage],
    case: &Arc<Case>,
) -> PyResult<Run<'py>> {
    let (answer, values, rms, error) = match run {
        Ok(found) => {
            let values: Vec<f64> = found
                .residuals
                .iter()
                .flat_map(|miss| match miss {
                    Some(miss) => [miss.pixel[0], miss.pixel[1], miss.pixels, miss.distance],
                    // Python's word for what there is not.
                    None => [f64::NAN; 4],
                })
                .collect();
            let rms = found.rms(markers).map(|Rms { pixels, distance }| [pixels, distance]);
            (Some(Solution::new(found.solution, case)), values, rms, None)
        }
        Err(error) => {
            let error = errors::solve(py, &error).into_value(py).into_bound(py).into_any();
            (None, Vec::new(), None, Some(error))
        }
    };
    let rows = values.len() / 4;
    Ok((kind.name(), answer, array(py, values, [rows, 4])?, rms, error))
}

/// The centre of a disk at a pixel.
fn marker(
    py: Python<'_>,
    setup: &Setup,
    (number, pixel): (usize, [f64; 2]),
    step: usize,
) -> PyResult<InImage> {
    let disks = setup.robot.disks();
    if !disks.are_present {
        let message = "a robot without disks takes no marks: give a table with arc lengths";
        return Err(errors::input(py, "marks", message.to_owned()));
    }
    let disks = &disks.arc_lengths;
    let disk = number.checked_sub(1).filter(|disk| *disk < disks.len());
    let disk = disk.ok_or_else(|| {
        let message =
            format!("there is no disk {number}: the robot has disks 1 to {}", disks.len());
        errors::input(py, "marks", message)
    })?;
    let seen = Observation {
        step,
        place: Place::Disk(disk),
        offset: Vec3::ZERO,
        seen: Seen::Pixel { camera: 0, pixel },
        deviation: None,
    };
    Ok(InImage { seen, arc_length: disks[disk], pixel })
}
