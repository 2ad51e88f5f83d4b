//! Comma-separated values. The crates for them do not tell where in the text a cell stands, which is
//! what a message points at.

use super::grid::{Cell, Grid, Row, Value};
use super::rows::{HEADER, problem};
use crate::error::Problems;
use crate::source::Span;

/// Reads a text; `None` when it has no rows or some are too short or too long.
pub(super) fn grid(text: &str, file: usize, problems: &mut Problems) -> Option<Grid> {
    let mut columns: Option<(Vec<Cell>, Span)> = None;
    let mut rows = Vec::new();
    let mut ragged = false;
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        if let Some(Row { cells, span }) = row(line, start, file) {
            match &columns {
                None => columns = Some((cells, span)),
                Some((columns, _)) if columns.len() != cells.len() => {
                    let (given, expected) = (cells.len(), columns.len());
                    let message = format!("this line has {given} values, not {expected}");
                    problems.push(span, || problem(message, HEADER));
                    ragged = true;
                }
                Some(_) => rows.push(Row { cells, span }),
            }
        }
        start += line.len();
    }
    let complete = columns.filter(|_| !rows.is_empty());
    if complete.is_none() && !ragged {
        problems.push(Span::new(file, 0, 0), || problem("the file has no rows", HEADER));
    }
    let (columns, header) = complete.filter(|_| !ragged)?;
    Some(Grid { columns, rows, header })
}

/// The cells of a line that begins at byte `start`; `None` for a comment or an empty line.
fn row(line: &str, start: usize, file: usize) -> Option<Row> {
    let content = line.trim_end().trim_start_matches('\u{feff}');
    if content.trim().is_empty() || content.trim_start().starts_with('#') {
        return None;
    }
    let mut at = start + line.find(content).unwrap_or(0);
    let mut cells = Vec::new();
    for cell in content.split(',') {
        let text = cell.trim();
        let begin = at + (cell.len() - cell.trim_start().len());
        cells.push(Cell {
            value: Value::of(text),
            span: Span::new(file, begin, begin + text.len()),
        });
        at += cell.len() + 1;
    }
    Some(Row { cells, span: Span::new(file, start, start + line.trim_end().len()) })
}
