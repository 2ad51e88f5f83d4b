//! Inverse problems of a robot as Python asks them.

use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use whipcord::{Case, Robot};
use whipcord_inverse::{
    Actuator, CommandedBy, InverseError, InverseSolver, Limits, ReachOptions, Tolerance,
};
use whipcord_io::{AtlasFileError, Goal, start_from_atlas};

use crate::errors;
use crate::setup::Setup;

/// How a target is to be reached, as Python gives it.
#[derive(FromPyObject)]
pub struct Asked {
    /// Which commands are sought; `None` for those of the case.
    #[pyo3(item)]
    by: Option<String>,
    #[pyo3(item)]
    starts: usize,
    #[pyo3(item)]
    prove: bool,
    #[pyo3(item)]
    atlas: Option<PathBuf>,
    #[pyo3(item)]
    tolerance: Option<f64>,
    #[pyo3(item)]
    tolerance_angle: Option<f64>,
}

/// Boxes of tensions that a proof may look at.
const BOXES: usize = 1_000_000;

/// What a thread needs to make a solver.
pub struct Task {
    pub model: whipcord::Model,
    pub robot: Robot,
    pub case: Arc<Case>,
    goal: Goal,
    pub by: CommandedBy,
    pub options: ReachOptions,
    /// Where the shapes to start from are kept.
    atlas: Option<PathBuf>,
}

/// Why there is no answer.
pub enum Failure {
    Inverse(InverseError),
    Rate(String),
    /// Of the file with the shapes to start from.
    Atlas(String),
}

impl From<InverseError> for Failure {
    fn from(error: InverseError) -> Self {
        Self::Inverse(error)
    }
}

impl Task {
    pub fn new(
        py: Python<'_>,
        setup: &Setup,
        model: whipcord::Model,
        asked: &Asked,
    ) -> PyResult<Self> {
        let by = match asked.by.as_deref() {
            None => CommandedBy::Case,
            Some("tensions") => CommandedBy::Tensions,
            Some("lengths") => CommandedBy::Shortenings,
            Some("motors") => CommandedBy::Motors,
            Some(other) => {
                let message = format!(
                    "nothing is commanded by `{other}`: choose tensions, lengths or motors"
                );
                return Err(errors::input(py, "by", message));
            }
        };
        let mut goal = setup.file_data.goal.clone();
        goal.tolerance = asked.tolerance.or(goal.tolerance);
        goal.tolerance_angle = asked.tolerance_angle.or(goal.tolerance_angle);
        let length = setup.robot.backbone().length;
        let options = ReachOptions {
            tolerance: Some(goal.tolerance(length).unwrap_or_else(|| Tolerance::of_length(length))),
            prefer: goal.preference.unwrap_or_default(),
            clearance: goal.least_clearance(),
            starts: asked.starts.min(20_000),
            proof: asked.prove.then_some(BOXES),
            ..ReachOptions::default()
        };
        Ok(Self {
            model,
            robot: setup.robot.clone(),
            case: Arc::clone(&setup.case),
            goal,
            by,
            options,
            atlas: asked.atlas.clone(),
        })
    }

    /// The limits of the cables, for what is commanded.
    pub fn limits(&self) -> Result<Limits, Failure> {
        let (robot, case) = (&self.robot, &*self.case);
        let actuators = Actuator::of(robot, case, self.model.kind(), self.by)?;
        let limits = self.goal.limits(robot, &actuators);
        limits.map_err(|mismatch| Failure::Rate(mismatch.words(robot)))
    }

    pub fn solver(&self) -> Result<InverseSolver, Failure> {
        let limits = self.limits()?;
        let (model, robot, case) = (&self.model, &self.robot, &self.case);
        let mut solver = InverseSolver::new(model, robot, case, &limits, self.by)?;
        if let Some(path) = &self.atlas {
            start_from_atlas(&mut solver, path).map_err(|error| match error {
                AtlasFileError::Shapes(error) => Failure::Inverse(error),
                error => Failure::Atlas(error.to_string()),
            })?;
        }
        Ok(solver)
    }
}

pub fn raised(py: Python<'_>, failure: Failure) -> PyErr {
    match failure {
        Failure::Inverse(InverseError::Solve(error) | InverseError::NoStart(error)) => {
            errors::solve(py, &error)
        }
        Failure::Inverse(error @ InverseError::Target(_)) => {
            errors::input(py, "target", error.to_string())
        }
        Failure::Inverse(error @ InverseError::Voxel { .. }) => {
            errors::input(py, "voxel", error.to_string())
        }
        Failure::Inverse(error @ InverseError::ControlOptions) => {
            errors::input(py, "controller", error.to_string())
        }
        Failure::Inverse(error @ InverseError::NoDerivatives) => {
            errors::input(py, "model", error.to_string())
        }
        Failure::Inverse(error @ InverseError::NoMotors) => {
            errors::input(py, "by", error.to_string())
        }
        Failure::Inverse(error) => errors::input(py, "limits", error.to_string()),
        Failure::Rate(message) => errors::input(py, "limits", message),
        Failure::Atlas(message) => errors::input(py, "atlas", message),
    }
}

/// The kind of each command and the name of its cable or motor.
pub fn names(robot: &Robot, actuators: &[Actuator]) -> Vec<(&'static str, String)> {
    let of = |actuator: &Actuator| match *actuator {
        Actuator::Tension(cable) => ("tension", robot.cables()[cable].name.clone()),
        Actuator::Shortening(cable) => ("shortening", robot.cables()[cable].name.clone()),
        Actuator::Motor(motor) => ("motor", robot.motors()[motor].name.clone()),
    };
    actuators.iter().map(of).collect()
}
