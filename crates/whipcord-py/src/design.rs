//! Robots for target shapes.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use whipcord::batch::BatchOptions;
use whipcord::{SolveError, Stations, Vec3};
use whipcord_design::{DesignError, Vary, design as solve_design, spread};
use whipcord_io::{DesignShape, DesignTarget, design_json, designed_case, parse_curve};

use crate::convert::{array, flat};
use crate::errors;
use crate::model::Model;
use crate::setup::Setup;
use crate::wait::within;

/// A target shape; one of nothing is that which was measured.
#[derive(FromPyObject)]
pub struct Wanted {
    #[pyo3(item)]
    curve: Option<String>,
    /// Numbers of disks, from 0, and their places in m.
    #[pyo3(item)]
    points: Option<Vec<(usize, [f64; 3])>>,
    /// Places of the tip in m.
    #[pyo3(item)]
    path: Option<Vec<[f64; 3]>>,
    /// Of each cable in N.
    #[pyo3(item)]
    tension: Option<Vec<f64>>,
    #[pyo3(item)]
    weight: Option<f64>,
}

impl Wanted {
    fn target(self) -> Result<DesignTarget, String> {
        if let Some(places) = self.path {
            let places = places.into_iter().map(Vec3::from).collect();
            let shape = DesignShape::Path(places, PathBuf::new());
            return Ok(DesignTarget { shape, tension: self.tension, weight: self.weight });
        }
        let shape = match (self.curve, self.points) {
            (Some(text), _) => DesignShape::Curve(parse_curve(&text)?),
            (None, Some(points)) => {
                let points = points.into_iter().map(|(disk, point)| (disk, point.into()));
                DesignShape::Points(points.collect(), PathBuf::new())
            }
            (None, None) => DesignShape::Measured,
        };
        Ok(DesignTarget { shape, tension: self.tension, weight: self.weight })
    }
}

/// What a design is answered, and the robot as a setup.
#[pyfunction]
#[pyo3(signature = (setup, model, targets, chosen, samples))]
pub fn design<'py>(
    py: Python<'py>,
    setup: &Setup,
    model: &Model,
    targets: Vec<Wanted>,
    chosen: bool,
    samples: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let data = &setup.file_data;
    let mut table = data.goal.design.clone();
    if !targets.is_empty() {
        let targets: Result<_, String> = targets.into_iter().map(Wanted::target).collect();
        table.targets = targets.map_err(|message| errors::input(py, "target", message))?;
    }
    let measured = data.measured.as_deref();
    let problem = table.problem(&setup.robot, &setup.case, &data.goal, measured);
    let mut problem = problem.map_err(|error| errors::input(py, "target", error.to_string()))?;
    let (given, limit, stop) = model.begin_search();
    problem.options.stop = stop;
    // Where no model was chosen, what is varied decides.
    let given = match chosen {
        true => given,
        false => whipcord::Model::new(
            Vary::usual_model(&problem.vary),
            Stations::Disks,
            whipcord::Actuation::Natural,
        )
        .cancelled_by(&limit.cancel),
    };
    let (robot, title) = (setup.robot.clone(), setup.title.clone());
    let found = within(py, &limit, move || -> Result<_, DesignError> {
        let found = solve_design(&given, &robot, &problem.goals, &problem.vary, &problem.options)?;
        let sampled = match samples {
            true => {
                let of = &problem.tolerances;
                Some(found.sample_tolerances(&given, of, &BatchOptions::default())?)
            }
            false => None,
        };
        Ok((found, sampled))
    })?;
    let (found, sampled) = found.map_err(|error| match error {
        // Whichever part of the search noticed it first.
        _ if limit.cancel.is_cancelled() => {
            errors::solve(py, &SolveError::Cancelled { last_load: None })
        }
        DesignError::Solve(error) => errors::solve(py, &error),
        // What has to be done before there is any robot took the whole time.
        DesignError::Ended => errors::solve(py, &SolveError::Cancelled { last_load: None }),
        error @ DesignError::Criterion { .. } => errors::input(py, "criteria", error.to_string()),
        error => errors::input(py, "vary", error.to_string()),
    })?;
    let json = design_json(&title, &found, sampled.as_ref());
    let json = json.map_err(|error| errors::input(py, "design", error.to_string()))?;
    let cases: Vec<_> = found.goals.iter().map(|goal| goal.case.clone()).collect();
    let case = designed_case(&found.robot, &setup.case, &cases);
    let values = PyDict::new(py);
    let new = Setup::new(title, found.robot.clone(), Arc::new(case));
    values.set_item("setup", new)?;
    values.set_item("json", json.to_string())?;
    let mut targets = Vec::new();
    for goal in &found.goals {
        let of = PyDict::new(py);
        let count = goal.points.len();
        let disks: Vec<i64> =
            goal.points.iter().map(|(disk, _)| i64::try_from(*disk).unwrap_or(i64::MAX)).collect();
        of.set_item("disk", array(py, disks, [count])?)?;
        let wanted = flat(goal.points.iter().map(|(_, point)| *point));
        of.set_item("wanted", array(py, wanted, [count, 3])?)?;
        let poses = &goal.solution.disks.poses;
        let at = |(disk, _): &(usize, Vec3)| poses[*disk].position;
        of.set_item("position", array(py, flat(goal.points.iter().map(at)), [count, 3])?)?;
        of.set_item("distance", array(py, goal.distances.clone(), [count])?)?;
        let check = goal.check.as_ref().and_then(|check| check.as_ref().ok());
        let check = check.filter(|distances| !distances.is_empty());
        of.set_item("check", check.map(|distances| spread(distances)[1]))?;
        targets.push(of);
    }
    values.set_item("targets", targets)?;
    Ok(values)
}
