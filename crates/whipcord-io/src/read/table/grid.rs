//! A table as it was read: names of columns, and cells that remember their place.

use crate::source::Span;

/// Columns of a table that is read; some of them may be of no concern here.
const MOST_COLUMNS: usize = 200;
/// Rows of a table that is read,
const MOST_ROWS: usize = 500_000;
/// and values in all of them, which take about a hundred bytes each.
const MOST_VALUES: usize = 5_000_000;

/// What is wrong with the size of a table, if anything.
pub(crate) fn too_large(rows: usize, columns: usize) -> Option<String> {
    if columns > MOST_COLUMNS {
        return Some(format!("the table has {columns} columns; up to {MOST_COLUMNS} are read"));
    }
    let most = MOST_ROWS.min(MOST_VALUES / columns.max(1));
    (rows > most).then(|| {
        format!("the table has {rows} rows of {columns} columns; up to {most} of them are read")
    })
}

/// Columns and rows.
#[derive(Debug)]
pub(crate) struct Grid {
    pub columns: Vec<Cell>,
    /// Each with as many cells as there are columns.
    pub rows: Vec<Row>,
    /// Where the names of the columns stand.
    pub header: Span,
}

/// A row.
#[derive(Debug)]
pub(crate) struct Row {
    pub cells: Vec<Cell>,
    pub span: Span,
}

/// A value and its place.
#[derive(Debug)]
pub(crate) struct Cell {
    pub value: Value,
    pub span: Span,
}

/// What stands in a cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// Nothing, as programs write it: an empty cell or a word for it.
    Missing,
    Text(String),
}

impl Value {
    /// As a text says it.
    pub fn of(text: &str) -> Self {
        const MISSING: [&str; 6] = ["", "nan", "na", "n/a", "null", "none"];
        let bare = text.strip_prefix('"').and_then(|t| t.strip_suffix('"')).unwrap_or(text).trim();
        if MISSING.iter().any(|word| word.eq_ignore_ascii_case(bare)) {
            Self::Missing
        } else {
            Self::Text(bare.to_owned())
        }
    }

    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Missing => None,
            Self::Text(text) => Some(text),
        }
    }
}
