//! Why a verb did not do its work, and the exit status that says so.

use std::io;
use std::path::Path;

use thiserror::Error;
use whipcord::SolveError;
use whipcord_io::{CaseFile, FileError, render};

use crate::style::Style;

/// Why a verb did not do its work. The message is what standard error shows.
#[derive(Debug, Error)]
pub enum Failure {
    /// Bad input or usage.
    #[error("{0}")]
    Input(String),
    /// A solve failed.
    #[error("{0}")]
    Solve(String),
    /// Some of several inputs are bad; what the others gave still counts.
    #[error("{message}")]
    Partial {
        /// For standard output.
        text: String,
        /// What is wrong with the others.
        message: String,
    },
}

impl Failure {
    /// 1 where a solve failed, 2 for bad input or usage.
    pub const fn exit_status(&self) -> u8 {
        match self {
            Self::Solve(_) => 1,
            Self::Input(_) | Self::Partial { .. } => 2,
        }
    }

    /// A file or folder that cannot be read or written.
    pub fn path(what: &str, path: &Path, error: &io::Error) -> Self {
        Self::Input(format!("error: cannot {what} {}: {error}", path.display()))
    }

    /// What a model said about step number `step` of the case in `file`, from 0.
    pub fn from_step(file: &CaseFile, error: &SolveError, step: usize) -> Self {
        match (Self::from_solve(file, error), file.case.before.len() + 1) {
            (Self::Solve(_), of) if of > 1 => {
                let (path, step) = (file.path.display(), step + 1);
                Self::Solve(format!("error: {path}: step {step} of {of}: {error}"))
            }
            (failure, _) => failure,
        }
    }

    /// What a model said about the case in `file`: with its place there when the model refuses it.
    pub fn from_solve(file: &CaseFile, error: &SolveError) -> Self {
        if let Some(located) = file.locate(error) {
            return Self::Input(message(&located));
        }
        let message = format!("error: {}: {error}", file.path.display());
        if refuses(error) { Self::Input(message) } else { Self::Solve(message) }
    }
}

/// Whether the model does not take the case at all, in contrast to a solve that failed.
pub const fn refuses(error: &SolveError) -> bool {
    matches!(
        error,
        SolveError::Invalid(_) | SolveError::Missing { .. } | SolveError::Unsupported { .. }
    )
}

/// A file's error as standard error shows it.
pub fn message(error: &FileError) -> String {
    render(error, Style::for_stderr().is_enabled()).trim_end().to_owned()
}
