//! Problems and warnings as JSON.

use serde_json::{Value, json};

use crate::case_file::CaseFile;
use crate::error::FileError;
use crate::source::Position;
use crate::warnings::FileWarning;

/// The warnings as JSON: `code`, `message`, `help`, and `place` with `file`, `line` and `column`, or null.
#[must_use]
pub fn warnings_json(file: &CaseFile, warnings: &[FileWarning]) -> Value {
    let object = |warning: &FileWarning| {
        json!({
            "code": warning.warning.code(),
            "message": warning.message(),
            "help": warning.warning.help(),
            "place": warning.place(file).map(|(path, position)| place(&path, position)),
        })
    };
    warnings.iter().map(object).collect()
}

/// What is wrong with a file as JSON: `message`, `help`, and `place` with `file`, `line` and `column` of each problem.
#[must_use]
pub fn problems_json(error: &FileError) -> Value {
    let object = |diagnostic: &crate::error::Diagnostic| {
        let source = error.sources.get(diagnostic.span.file);
        json!({
            "message": diagnostic.problem.to_string(),
            "help": diagnostic.problem.help(),
            "place": source.map(|source| place(&source.name(), source.position(diagnostic.span.start))),
        })
    };
    error.problems.iter().map(object).collect()
}

fn place(file: &str, Position { line, column }: Position) -> Value {
    json!({ "file": file, "line": line, "column": column })
}
