//! `whipcord camera`: lenses, and where cameras are.

mod calibrate;
mod locate;
mod stereo;

use std::path::Path;

use clap::{Args, Subcommand};
use whipcord_io::CameraFormat;

use whipcord_study::failure::Failure;
use whipcord_study::style::Style;

/// Calibrate and locate the cameras that photograph the robot
#[derive(Debug, Args)]
pub struct CameraArgs {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    Calibrate(calibrate::CalibrateArgs),
    Locate(locate::LocateArgs),
}

/// What was done, in words.
pub fn run(args: &CameraArgs, style: Style) -> Result<String, Failure> {
    match &args.task {
        Task::Calibrate(args) if args.stereo.is_empty() => calibrate::run(args, style),
        Task::Calibrate(args) => stereo::run(args, style),
        Task::Locate(args) => locate::run(args, style),
    }
}

fn format_of(path: &Path) -> Result<CameraFormat, Failure> {
    CameraFormat::of(path).ok_or_else(|| {
        let path = path.display();
        Failure::Input(format!("error: {path}: a camera file ends in .yml, .yaml or .json"))
    })
}
