//! Tables in files: comma-separated values or Parquet.

mod csv;
mod grid;
mod parquet;
mod thrift;
mod unit;

use std::borrow::Cow;
use std::path::Path;

use crate::error::{FileProblem, Problems};
use crate::files;
use crate::source::{Sources, Span};

pub(crate) use grid::{Cell, Grid, Row};
pub(crate) use parquet::{TableColumn, columns};
pub(crate) use unit::Unit;

/// What is wrong with a table, and what to do.
pub(crate) fn problem(
    message: impl Into<String>,
    help: impl Into<Cow<'static, str>>,
) -> FileProblem {
    FileProblem::Measured { message: message.into(), help: help.into() }
}

/// The table in a file, comma-separated values or Parquet, which another file may name at `named`. `header` says what its first
/// line must be.
pub(crate) fn read(
    path: &Path,
    named: Option<Span>,
    header: &'static str,
    sources: &mut Sources,
    problems: &mut Problems,
) -> Option<Grid> {
    let bytes = files::read_content(path, files::LARGEST_TABLE, named, sources, problems)?;
    if !parquet::is_parquet(&bytes) {
        let (file, text) = files::as_text(path, bytes, named, sources, problems)?;
        return csv::grid(&text, file, header, problems);
    }
    let file = sources.files().len();
    let read = parquet::grid(bytes, file);
    let (grid, text) = match read {
        Ok((grid, text)) => (Some(grid), Some(text)),
        Err((message, help)) => {
            problems.push(Span::new(file, 0, 0), || problem(message, help));
            (None, None)
        }
    };
    sources.add(path, text);
    grid
}

/// A name of a column without the unit that follows it in brackets, and that unit.
pub(crate) fn split_unit(name: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let Some((bare, unit)) = name.strip_suffix(close).and_then(|name| name.rsplit_once(open))
        else {
            continue;
        };
        return (bare.trim(), Some(unit.trim()));
    }
    (name, None)
}

/// Whether two paths name one file.
pub(crate) fn same_file(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    a == b || real(a).is_some_and(|a| real(b) == Some(a))
}
