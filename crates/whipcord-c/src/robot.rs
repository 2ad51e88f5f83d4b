//! A robot with what is asked of it, from a robot file.

use std::ffi::CString;
use std::path::Path;
use std::sync::Arc;

use whipcord::robot::limits::TENSION;
use whipcord::{ModelKind, Pose, Robot, SolveError};
use whipcord_io::{CaseFile, FileError, load, parse};
use whipcord_motion::MotionError;

use crate::status::{Failure, Status, c_text};

/// A robot file.
pub struct RobotFile {
    pub(crate) file: Arc<CaseFile>,
    pub(crate) title: CString,
    pub(crate) cables: Vec<CString>,
    pub(crate) motors: Vec<CString>,
}

impl RobotFile {
    pub(crate) fn load(path: &str) -> Result<Self, Failure> {
        Self::of(load(Path::new(path)))
    }

    /// From a text; `name` stands for it in messages, and files that it names are in the folder of `name`.
    pub(crate) fn parse(text: &str, name: &str) -> Result<Self, Failure> {
        Self::of(parse(text, Path::new(name)))
    }

    fn of(read: Result<CaseFile, FileError>) -> Result<Self, Failure> {
        let file = read.map_err(|error| Failure::new(Status::File, error.to_string()))?;
        Ok(Self {
            title: c_text(&file.title),
            cables: file.robot.cables().iter().map(|cable| c_text(&cable.name)).collect(),
            motors: file.robot.motors().iter().map(|motor| c_text(&motor.name)).collect(),
            file: Arc::new(file),
        })
    }
}

/// The model of a name.
pub(crate) fn model_kind(name: &str) -> Result<ModelKind, Failure> {
    name.parse().map_err(|error: whipcord::kind::UnknownModel| {
        Failure::new(Status::InvalidArgument, error.to_string())
    })
}

/// What a solve of a robot of this file fails with: with the place in the file where that is at fault.
pub(crate) fn solve_failure(file: &CaseFile, error: &SolveError) -> Failure {
    let words = file.locate(error).map_or_else(|| error.to_string(), |located| located.to_string());
    Failure::of_solve(error, words)
}

/// The same of a motion.
pub(crate) fn motion_failure(file: &CaseFile, error: &MotionError) -> Failure {
    let located = file.locate_motion(error);
    Failure::of_motion(error, located.map_or_else(|| error.to_string(), |of| of.to_string()))
}

/// Numbers of a pose.
pub(crate) const POSE: usize = 7;

/// Position in m and quaternion (w, x, y, z).
pub(crate) fn pose_values(pose: Pose) -> [f64; POSE] {
    let [x, y, z] = pose.position.to_array();
    let [w, a, b, c] = pose.rotation.wxyz();
    [x, y, z, w, a, b, c]
}

/// The numbers of several poses one after the other.
pub(crate) fn poses_values(poses: &[Pose]) -> impl ExactSizeIterator<Item = f64> + '_ {
    (0..POSE * poses.len()).map(|i| pose_values(poses[i / POSE])[i % POSE])
}

/// Refuses tensions that no cable has.
pub(crate) fn check_tensions(tensions: &[f64]) -> Result<(), Failure> {
    for (i, &tension) in tensions.iter().enumerate() {
        check_tension(tension, || (format!("tensions[{i}] is"), String::new()))?;
    }
    Ok(())
}

/// Refuses commands of which those that are tensions, by the flags, are none that a cable has.
pub(crate) fn check_commands(commands: &[f64], by_shortening: &[u8]) -> Result<(), Failure> {
    for (i, &command) in commands.iter().enumerate().filter(|(i, _)| by_shortening[*i] == 0) {
        let words = || {
            let remedy = format!(", or set by_shortening[{i}] to 1");
            (format!("commands[{i}] is a tension of"), remedy)
        };
        check_tension(command, words)?;
    }
    Ok(())
}

/// Refuses a tension that no cable has, with words before the number and behind the remedy.
fn check_tension(tension: f64, words: impl FnOnce() -> (String, String)) -> Result<(), Failure> {
    let greatest = TENSION.greatest;
    if (0.0..=greatest).contains(&tension) {
        return Ok(());
    }
    let (what, or) = words();
    let why = match tension < 0.0 {
        true => "a cable cannot push, give 0 or more".to_owned(),
        false => format!("give {greatest:e} N or less"),
    };
    Err(Failure::new(Status::InvalidArgument, format!("{what} {tension} N: {why}{or}")))
}

/// Refuses commands that the motors of a robot cannot have.
pub(crate) fn check_motors(robot: &Robot, commands: &[f64]) -> Result<(), Failure> {
    for (i, (motor, &command)) in robot.motors().iter().zip(commands).enumerate() {
        motor.check_command(command).map_err(|problem| {
            Failure::new(Status::InvalidArgument, format!("commands[{i}]: {problem}"))
        })?;
    }
    Ok(())
}
