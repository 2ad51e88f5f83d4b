//! Pictures of robots and answers.

use pyo3::prelude::*;
use whipcord::{Shape, Stations};
use whipcord_plot::{Acting, FigureOptions, RobotView, robot_figure};

use crate::errors;
use crate::setup::Setup;
use crate::solution::Solution;

/// An SVG of the robot: before actuation, and as these answers have it, each by its name.
#[pyfunction]
#[pyo3(signature = (setup, solutions, width, title = None))]
pub fn svg(
    py: Python<'_>,
    setup: &Setup,
    solutions: Vec<(String, PyRef<'_, Solution>)>,
    width: f64,
    title: Option<String>,
) -> PyResult<String> {
    let mut views = vec![RobotView::at_rest(&setup.robot, setup.case.base)];
    let named = solutions.iter();
    views.extend(named.map(|(name, solution)| RobotView::model(name.clone(), &solution.inner)));
    let rest = Shape::straight(&Stations::Disks.arc_lengths(&setup.robot)).moved(setup.case.base);
    let loaded = solutions.last().map_or(&rest, |(_, solution)| &solution.inner.shape);
    let options = FigureOptions {
        title: title.unwrap_or_else(|| setup.title.clone()),
        loads: Acting::on(&setup.case, loaded),
        width,
        ..FigureOptions::default()
    }
    .among(&setup.case.obstacles, solutions.last().map(|(_, of)| &*of.inner));
    let svg = robot_figure(&setup.robot, &views, &options);
    svg.map_err(|error| errors::input(py, "solution", error.to_string()))
}
