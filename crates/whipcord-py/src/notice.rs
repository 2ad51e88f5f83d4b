//! Warnings as Python has them.

use whipcord::Warning;
use whipcord_io::{CaseFile, FileWarning};

/// A warning as Python has it.
#[derive(Clone)]
pub struct Notice {
    pub code: &'static str,
    pub message: String,
    pub help: String,
    /// Path, line and column.
    pub place: Option<(String, usize, usize)>,
}

impl Notice {
    pub fn of(warning: &Warning) -> Self {
        let (message, help) = (warning.to_string(), warning.help());
        Self { code: warning.code(), message, help, place: None }
    }

    /// What its exception class is made with.
    pub fn row(&self) -> (&'static str, &str, &str, Option<(&str, usize, usize)>) {
        let place = self.place.as_ref().map(|(path, line, column)| (path.as_str(), *line, *column));
        (self.code, &self.message, &self.help, place)
    }
}

/// The warnings about a file, whose numbers have their units where `has_units`.
pub fn notices(file: &CaseFile, has_units: bool) -> Vec<Notice> {
    let warnings = if has_units { file.warnings() } else { file.warnings_in_si() };
    let notice = |warning: FileWarning| Notice {
        place: warning.place(file).map(|(path, at)| (path, at.line, at.column)),
        ..Notice::of(&warning.warning)
    };
    warnings.into_iter().map(notice).collect()
}
