//! Measurements of a robot: as values of Python and back, and how far answers are from them.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use whipcord::{Pose, Vec3};
use whipcord_estimation::observation::{self, Distances};
use whipcord_estimation::registration::Alignment;
use whipcord_estimation::{Observation, Place, Seen};
use whipcord_io::{Measured, MeasuringCamera};

use crate::camera::Camera;
use crate::convert::{array, flat};
use crate::errors;
use crate::setup::Setup;
use crate::solution::Solution;

/// An observation: step from 0, disk from 0, arc length in m, offset in m, position in m, number of the camera,
/// pixel, and deviation.
type Seeing = (
    usize,
    Option<usize>,
    Option<f64>,
    [f64; 3],
    Option<[f64; 3]>,
    Option<usize>,
    Option<[f64; 2]>,
    Option<f64>,
);

/// What was measured: numbers of the disks, from 1, their (k, 3) positions in m, all that was seen, and what the
/// table says beside it.
pub fn measured<'py>(py: Python<'py>, measured: &Measured) -> PyResult<Bound<'py, PyDict>> {
    let disks = &measured.disks;
    let numbers: Vec<usize> = disks.iter().map(|disk| disk.disk).collect();
    let positions = flat(disks.iter().map(|disk| disk.position));
    let cameras: Vec<(&str, &PathBuf)> =
        measured.cameras.iter().map(|camera| (camera.name.as_str(), &camera.path)).collect();
    let views: Vec<Camera> =
        measured.cameras.iter().map(|camera| Camera::of(camera.camera)).collect();
    let seen: Vec<Seeing> = measured.observations.iter().map(seeing).collect();
    let values = PyDict::new(py);
    values.set_item("disks", numbers)?;
    values.set_item("position", array(py, positions, [disks.len(), 3])?)?;
    values.set_item("path", &measured.path)?;
    values.set_item("unit", measured.unit)?;
    values.set_item("deviation", measured.deviation)?;
    values.set_item("pixel_deviation", measured.pixel_deviation)?;
    values.set_item("registration", measured.alignment.name())?;
    values.set_item("is_of_commands", measured.is_of_commands)?;
    values.set_item("cameras", cameras)?;
    values.set_item("views", PyList::new(py, views)?)?;
    values.set_item("observations", seen)?;
    Ok(values)
}

/// The measurement of such values, which come from [`measured`].
pub fn measured_of(values: &Bound<'_, PyDict>) -> PyResult<Measured> {
    let py = values.py();
    let get = |key: &str| {
        let missing = || errors::input(py, "measured", format!("it has no {key}"));
        values.get_item(key)?.ok_or_else(missing)
    };
    let seen: Vec<Seeing> = get("observations")?.extract()?;
    let observations: Vec<Observation> = seen.into_iter().map(observation).collect();
    let views: Vec<PyRef<'_, Camera>> = get("views")?.extract()?;
    let cameras: Vec<(String, PathBuf)> = get("cameras")?.extract()?;
    let cameras = cameras.into_iter().zip(&views);
    let cameras =
        cameras.map(|((name, path), of)| MeasuringCamera { name, camera: of.inner, path });
    let (unit, asked) = (get("unit")?.extract::<String>()?, get("registration")?);
    let asked = asked.extract::<String>()?;
    let named = |name: &&&str| **name == unit;
    let alignment = Alignment::ALL.into_iter().find(|way| way.name() == asked);
    let numbers: Vec<usize> = get("disks")?.extract()?;
    let positions: numpy::PyReadonlyArray2<'_, f64> = get("position")?.extract()?;
    let rows = positions.as_array();
    let disks = numbers.into_iter().zip(rows.rows()).map(|(disk, row)| whipcord_io::MeasuredDisk {
        disk,
        position: Vec3::new(row[0], row[1], row[2]),
    });
    Ok(Measured {
        observations,
        disks: disks.collect(),
        cameras: cameras.collect(),
        alignment: alignment.unwrap_or_default(),
        unit: whipcord_io::LENGTH_UNITS.iter().find(named).unwrap_or(&"m"),
        deviation: get("deviation")?.extract()?,
        pixel_deviation: get("pixel_deviation")?.extract()?,
        path: get("path")?.extract()?,
        is_of_commands: get("is_of_commands")?.extract()?,
        ..Measured::default()
    })
}

fn seeing(of: &Observation) -> Seeing {
    let (disk, arc_length) = match of.place {
        Place::Disk(disk) => (Some(disk), None),
        Place::ArcLength(s) => (None, Some(s)),
    };
    let (position, camera, pixel) = match of.seen {
        Seen::Position(position) => (Some(position.to_array()), None, None),
        Seen::Pixel { camera, pixel } => (None, Some(camera), Some(pixel)),
        // Orientations are kept beside what was seen.
        Seen::Rotation { .. } => (None, None, None),
    };
    (of.step, disk, arc_length, of.offset.to_array(), position, camera, pixel, of.deviation)
}

fn observation(of: Seeing) -> Observation {
    let (step, disk, arc_length, offset, position, camera, pixel, deviation) = of;
    let place = disk.map_or_else(|| Place::ArcLength(arc_length.unwrap_or(0.0)), Place::Disk);
    let seen = match (position, pixel) {
        (None, Some(pixel)) => Seen::Pixel { camera: camera.unwrap_or(0), pixel },
        (position, _) => Seen::Position(position.unwrap_or_default().into()),
    };
    Observation { step, place, offset: offset.into(), seen, deviation }
}

/// RMS distance in m; for each marker the number of its disk, from 1, whether it is at the base, its step, from 1, and
/// its arc length in m; its (k, 3) places as measured and moved, and of the answers; the motion; numbers of the markers that count less in it.
type Apart<'py> = (
    Option<f64>,
    Vec<(Option<usize>, bool, usize, f64)>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Option<([f64; 3], [f64; 4])>,
    Vec<usize>,
);

/// How far the answers to all steps are from what was measured in space; None where nothing was.
#[pyfunction]
pub fn distances<'py>(
    py: Python<'py>,
    setup: &Setup,
    answers: Vec<PyRef<'py, Solution>>,
) -> PyResult<Option<Apart<'py>>> {
    let Some(measured) = &setup.file_data.measured else { return Ok(None) };
    let (robot, case) = (&setup.robot, &setup.case);
    let answers: Vec<_> = answers.iter().map(|answer| Arc::clone(&answer.inner)).collect();
    let Some(kind) = answers.first().map(|answer| answer.model) else { return Ok(None) };
    let found = py.detach(|| {
        let Measured { observations, alignment, .. } = &**measured;
        let answers: Vec<_> = answers.iter().map(|answer| &**answer).collect();
        observation::distances(kind, robot, case, &answers, observations, *alignment)
    });
    let found = found.map_err(|error| errors::input(py, "measured", error.to_string()))?;
    let Some(found) = found else { return Ok(None) };
    let Distances { markers, motion, lowered } = &found;
    let kinds = markers
        .iter()
        .map(|marker| (marker.disk, marker.at_base, marker.step + 1, marker.arc_length))
        .collect();
    let seen = array(py, flat(markers.iter().map(|marker| marker.measured)), [markers.len(), 3])?;
    let there = array(py, flat(markers.iter().map(|marker| marker.model)), [markers.len(), 3])?;
    let motion = motion.map(|Pose { position, rotation }| (position.to_array(), rotation.wxyz()));
    Ok(Some((found.rms(), kinds, seen, there, motion, lowered.clone())))
}
