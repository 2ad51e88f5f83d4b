//! Inverse problems of the robot of a file, for the verbs that ask them.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use whipcord::{Model, ModelKind};
use whipcord_inverse::{Actuator, CommandedBy, InverseError, InverseSolver};
use whipcord_io::{AtlasFileError, CaseFile, start_from_atlas};
use whipcord_study::failure::Failure;

use crate::inputs::Settings;
use crate::model_arguments::{FourBarArguments, model_parser};
use crate::warnings::Warnings;

/// The robot of an inverse problem, its model, and what is commanded.
#[derive(Debug, Args)]
pub struct RobotArguments {
    /// Robot file, or - for standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub settings: Settings,
    /// Model
    #[arg(long = "model", value_name = "NAME", default_value = "cosserat", value_parser = model_parser())]
    pub kind: ModelKind,
    #[command(flatten)]
    pub four_bar: FourBarArguments,
    /// Which commands vary; by default those that the file gives: the motors where there are some, else
    /// tensions or lengths
    #[arg(long, value_name = "WHAT")]
    pub by: Option<By>,
    #[command(flatten)]
    pub warnings: Warnings,
}

/// Which commands are sought.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum By {
    /// Tensions of all cables
    Tensions,
    /// Shortenings of all cables
    Lengths,
    /// Motors, and cables without a motor as the file commands them
    Motors,
}

/// For the robot of a file and its limits.
pub fn solver(by: Option<By>, file: &CaseFile, model: &Model) -> Result<InverseSolver, Failure> {
    let by = match by {
        None => CommandedBy::Case,
        Some(By::Tensions) => CommandedBy::Tensions,
        Some(By::Lengths) => CommandedBy::Shortenings,
        Some(By::Motors) => CommandedBy::Motors,
    };
    let CaseFile { robot, case, .. } = file;
    let fail = |error: InverseError| failure(file, &error);
    let actuators = Actuator::of(robot, case, model.kind(), by).map_err(fail)?;
    let limits = file.goal.limits(robot, &actuators).map_err(|mismatch| {
        Failure::Input(format!("error: {}: {}", file.path.display(), mismatch.words(robot)))
    })?;
    InverseSolver::new(model, robot, case, &limits, by).map_err(fail)
}

/// Starts from the shapes of a file, or computes them and keeps them there.
pub fn keep_atlas(file: &CaseFile, solver: &mut InverseSolver, path: &Path) -> Result<(), Failure> {
    start_from_atlas(solver, path).map_err(|error| match error {
        AtlasFileError::Shapes(error) => failure(file, &error),
        error => Failure::Input(format!("error: {error}")),
    })
}

/// What an inverse problem fails with.
pub fn failure(file: &CaseFile, error: &InverseError) -> Failure {
    let message = format!("error: {}: {error}", file.path.display());
    match error {
        InverseError::Solve(error) | InverseError::NoStart(error) => {
            Failure::from_solve(file, error)
        }
        InverseError::NoSolves | InverseError::Atlas(_) => Failure::Solve(message),
        _ => Failure::Input(message),
    }
}
