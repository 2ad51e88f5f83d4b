//! Where the tip of a robot can go.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord_inverse::WorkspaceOptions;

use crate::convert::{array, flat};
use crate::inverse::{Asked, Failure, Task, names, raised};
use crate::model::Model;
use crate::setup::Setup;
use crate::wait::within;

/// A workspace: arrays by their names, with a row for each voxel or for each point of the boundary.
#[pyfunction]
#[pyo3(signature = (setup, model, asked, voxel, has_stiffness, budget))]
pub fn workspace<'py>(
    py: Python<'py>,
    setup: &Setup,
    model: &Model,
    asked: Asked,
    voxel: Option<f64>,
    has_stiffness: bool,
    budget: Option<[usize; 2]>,
) -> PyResult<Bound<'py, PyDict>> {
    let (method, limit) = model.begin();
    let task = Task::new(py, setup, method, &asked)?;
    let usual = WorkspaceOptions::default();
    let [shapes, solves] = budget.unwrap_or([usual.shapes, usual.solves]);
    let clearance = task.options.clearance;
    let options = WorkspaceOptions { voxel, shapes, solves, has_stiffness, clearance };
    let found = within(py, &limit, move || -> Result<_, Failure> {
        let mut solver = task.solver()?;
        let found = solver.workspace(&options)?;
        Ok((found, solver.actuators().to_vec(), task))
    })?;
    let (found, actuators, task) = found.map_err(|failure| raised(py, failure))?;
    let (cells, boundary, width) = (&found.cells, &found.boundary, actuators.len());
    let (count, points) = (cells.len(), boundary.len());
    let none = f64::NAN;
    let values = PyDict::new(py);
    let index: Vec<i64> = cells.iter().flat_map(|of| of.index.map(i64::from)).collect();
    values.set_item("index", array(py, index, [count, 3])?)?;
    values.set_item("tip", array(py, flat(cells.iter().map(|of| of.tip)), [count, 3])?)?;
    values.set_item("axis", array(py, flat(cells.iter().map(|of| of.axis)), [count, 3])?)?;
    let command: Vec<f64> = cells.iter().flat_map(|of| of.commands.iter().copied()).collect();
    values.set_item("command", array(py, command, [count, width])?)?;
    let full: Vec<bool> = cells.iter().map(|of| of.is_full).collect();
    values.set_item("full", array(py, full, [count])?)?;
    #[expect(clippy::cast_possible_wrap, reason = "at most 3")]
    let directions = cells.iter().map(|of| of.dexterity.directions as i64).collect();
    values.set_item("directions", array::<i64, _>(py, directions, [count])?)?;
    let condition = cells.iter().map(|of| of.dexterity.condition.unwrap_or(none)).collect();
    values.set_item("condition", array::<f64, _>(py, condition, [count])?)?;
    let motion = cells.iter().map(|of| of.dexterity);
    let motion = motion.flat_map(|of| [of.least_motion(), of.singular[0].0]).collect();
    values.set_item("motion", array::<f64, _>(py, motion, [count, 2])?)?;
    let stiffness = cells.iter().flat_map(|of| of.stiffness.unwrap_or([none; 2])).collect();
    values.set_item("stiffness", array::<f64, _>(py, stiffness, [count, 2])?)?;
    let tips = flat(boundary.iter().map(|of| of.tip));
    values.set_item("boundary_tip", array(py, tips, [points, 3])?)?;
    let normals = flat(boundary.iter().map(|of| of.normal));
    values.set_item("boundary_normal", array(py, normals, [points, 3])?)?;
    let words = boundary.iter().map(|of| -> Vec<String> {
        of.limits.iter().map(|limit| limit.words(&task.robot, &actuators)).collect()
    });
    values.set_item("boundary_limits", words.collect::<Vec<_>>())?;
    values.set_item("voxel", found.voxel)?;
    values.set_item("dimension", found.dimension)?;
    values.set_item("measure", found.measure)?;
    values.set_item("extent", array(py, flat(found.extent.into_iter()), [2, 3])?)?;
    values.set_item("complete", found.is_complete)?;
    values.set_item("solves", found.solves)?;
    values.set_item("actuators", names(&task.robot, &actuators))?;
    Ok(values)
}
