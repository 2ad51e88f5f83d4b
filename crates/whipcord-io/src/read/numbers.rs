//! Tables of numbers whose columns are named by whoever asks.

use std::path::Path;

use super::table::{self, problem, split_unit};
use crate::error::{FileError, Problems};
use crate::source::{Sources, quoted};

/// A table of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NumberTable {
    /// Of each column its name, and its unit where the header gives one in brackets.
    pub columns: Vec<(String, Option<String>)>,
    /// Rows × columns, in these units.
    pub values: Vec<f64>,
}

const HEADER: &str =
    "the first line names the columns, such as cables.a.tension [N],cables.b.tension [N]";
const NUMBERS: &str = "give a number in each cell, with its unit in the name of the column, as in cables.a.tension [N]";

/// The numbers in a file of comma-separated values or in a Parquet file.
///
/// # Errors
/// [`FileError`] with all that is wrong with it.
pub fn load_numbers(path: &Path) -> Result<NumberTable, FileError> {
    let (mut sources, mut problems) = (Sources::default(), Problems::default());
    match numbers(path, &mut sources, &mut problems) {
        Some(found) if problems.is_empty() => Ok(found),
        _ => Err(problems.into_error(sources)),
    }
}

fn numbers(path: &Path, sources: &mut Sources, problems: &mut Problems) -> Option<NumberTable> {
    let grid = table::read(path, None, HEADER, sources, problems)?;
    let mut found = NumberTable::default();
    for cell in &grid.columns {
        let name = cell.value.text().unwrap_or_default();
        let (name, unit) = split_unit(name);
        if name.is_empty() {
            problems.push(cell.span, || problem("a column has no name", HEADER));
        }
        found.columns.push((name.to_owned(), unit.map(str::to_owned)));
    }
    for row in &grid.rows {
        if problems.is_full() {
            return None;
        }
        for cell in &row.cells {
            let text = cell.value.text();
            let number = text.and_then(|text| text.trim().parse::<f64>().ok());
            match number.filter(|number| number.is_finite()) {
                Some(number) => found.values.push(number),
                None => problems.push(cell.span, || {
                    let message = match text {
                        None => "a value is missing".to_owned(),
                        Some(text) => format!("`{}` is no finite number", quoted(text)),
                    };
                    problem(message, NUMBERS)
                }),
            }
        }
    }
    Some(found)
}
