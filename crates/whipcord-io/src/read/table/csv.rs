//! Comma-separated values. The crates for them do not tell where in the text a cell stands, which is
//! what a message points at.

use super::grid::{Cell, Grid, Row, Value, too_large};
use super::problem;
use crate::error::Problems;
use crate::source::Span;

/// What stands between the cells of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Separator {
    Comma,
    Semicolon,
    Tab,
}

impl Separator {
    /// That of a file with this first line. Spreadsheets write semicolons where the comma is the decimal sign.
    fn of(header: &str) -> Self {
        match header {
            _ if header.contains(',') => Self::Comma,
            _ if header.contains(';') => Self::Semicolon,
            _ if header.trim().contains('\t') => Self::Tab,
            _ => Self::Comma,
        }
    }

    const fn character(self) -> char {
        match self {
            Self::Comma => ',',
            Self::Semicolon => ';',
            Self::Tab => '\t',
        }
    }
}

/// Reads a text, whose first line is as `header` says; `None` when it has no rows, too many, or some that are too short or too long.
pub(super) fn grid(
    text: &str,
    file: usize,
    header: &'static str,
    problems: &mut Problems,
) -> Option<Grid> {
    let mut columns: Option<(Vec<Cell>, Span, Separator)> = None;
    let mut rows = Vec::new();
    let mut ragged = false;
    if let Some((span, message)) = too_much(text, file) {
        problems.push(span, || problem(message, header));
        return None;
    }
    if let Some((span, message)) = other_separator(text, file) {
        problems.push(span, || problem(message, SEPARATORS));
        return None;
    }
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        if let Some(content) = content(line) {
            let separator = columns.as_ref().map_or_else(|| Separator::of(content), |(.., s)| *s);
            let Row { cells, span } = row(line, content, start, file, separator);
            match &columns {
                None => columns = Some((cells, span, separator)),
                Some((columns, ..)) if columns.len() != cells.len() => {
                    let (given, expected) = (cells.len(), columns.len());
                    let message = format!("this line has {given} values, not {expected}");
                    let help = match separator {
                        Separator::Comma if given > expected => DECIMAL_COMMAS,
                        _ => header,
                    };
                    problems.push(span, || problem(message, help));
                    ragged = true;
                }
                Some(_) => rows.push(Row { cells, span }),
            }
        }
        start += line.len();
    }
    let complete = columns.filter(|_| !rows.is_empty());
    if complete.is_none() && !ragged {
        problems.push(Span::new(file, 0, 0), || problem("the file has no rows", header));
    }
    let (columns, line, separator) = complete.filter(|_| !ragged)?;
    if separator != Separator::Comma && !decimal_points(&mut rows, problems) {
        return None;
    }
    Some(Grid { columns, rows, header: line })
}

const SEPARATORS: &str = "save the table with commas, semicolons or tabs between the columns";

/// Where and by what the columns of a table are separated that is none of the separators that are read: the first line of values has
/// several by it, and one alone by those.
fn other_separator(text: &str, file: usize) -> Option<(Span, String)> {
    let mut start = 0;
    let lines = text.split_inclusive('\n').map(|line| {
        let at = start;
        start += line.len();
        (at, line)
    });
    let mut lines = lines.filter_map(|(at, line)| Some((at, line, content(line)?)));
    let ((at, line, names), (.., values)) = (lines.next()?, lines.next()?);
    if values.contains([',', ';', '\t']) || names.contains([',', ';', '\t']) {
        return None;
    }
    let separator = match values {
        _ if values.contains('|') && names.contains('|') => "bars (`|`)",
        _ if values.split_whitespace().count() > 1 => "spaces",
        _ => return None,
    };
    let span = Span::new(file, at, at + line.trim_end().len());
    Some((span, format!("the columns are separated by {separator}")))
}

const DECIMAL_COMMAS: &str = "give each line one value for each column of the first line; write decimals with a point, or separate the columns by semicolons where decimals have commas";

/// Writes the numbers of a file whose separator is no comma with decimal points. Whether a comma is the decimal sign
/// can be told only where no number has a point.
fn decimal_points(rows: &mut [Row], problems: &mut Problems) -> bool {
    let is_number = |text: &str, sign: char| {
        text.matches(sign).count() == 1
            && text.replace(sign, ".").parse::<f64>().is_ok_and(f64::is_finite)
    };
    let numbers = |sign: char| {
        let cells = rows.iter().flat_map(|row| &row.cells);
        let mut with = cells.filter(move |cell| {
            cell.value.text().is_some_and(|text| text.contains(sign) && is_number(text, sign))
        });
        with.next().map(|cell| cell.span)
    };
    if let (Some(comma), Some(point)) = (numbers(','), numbers('.')) {
        let related = Some((point, "this number has a decimal point"));
        let message = "this number has a comma, and others of the file have a decimal point";
        problems.push_related(comma, related, || {
            problem(message, "write all numbers with a decimal point, and none of thousands")
        });
        return false;
    }
    for cell in rows.iter_mut().flat_map(|row| &mut row.cells) {
        let Value::Text(text) = &mut cell.value else { continue };
        if is_number(text, ',') {
            *text = text.replace(',', ".");
        }
    }
    true
}

/// A line of more values than this is not split, whatever table it is in.
const MOST_SPLIT: usize = 1000;

/// Where and why a table has more rows or columns than are read. The cells take many times the memory of the text.
fn too_much(text: &str, file: usize) -> Option<(Span, String)> {
    let mut header: Option<(Span, usize, Separator)> = None;
    let (mut rows, mut start) = (0, 0);
    for line in text.split_inclusive('\n') {
        if let Some(content) = content(line) {
            let span = Span::new(file, start, start + line.trim_end().len());
            let cells = |separator: Separator| content.matches(separator.character()).count() + 1;
            if let Some((_, expected, separator)) = header {
                rows += 1;
                let given = cells(separator);
                if given > MOST_SPLIT {
                    return Some((span, format!("this line has {given} values, not {expected}")));
                }
            } else {
                let separator = Separator::of(content);
                header = Some((span, cells(separator), separator));
            }
        }
        start += line.len();
    }
    let (span, columns, _) = header?;
    too_large(rows, columns).map(|message| (span, message))
}

/// What a line says; `None` for a comment or an empty line.
fn content(line: &str) -> Option<&str> {
    let content = line.trim_end_matches(['\r', '\n', ' ']).trim_start_matches('\u{feff}');
    let says = !content.trim().is_empty() && !content.trim_start().starts_with('#');
    says.then_some(content)
}

/// The cells of a line that begins at byte `start`.
fn row(line: &str, content: &str, start: usize, file: usize, separator: Separator) -> Row {
    let mut at = start + line.find(content).unwrap_or(0);
    let mut cells = Vec::new();
    for cell in content.split(separator.character()) {
        let text = cell.trim();
        let begin = at + (cell.len() - cell.trim_start().len());
        cells.push(Cell {
            value: Value::of(text),
            span: Span::new(file, begin, begin + text.len()),
        });
        at += cell.len() + 1;
    }
    Row { cells, span: Span::new(file, start, start + line.trim_end().len()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> Option<String> {
        let mut problems = Problems::default();
        assert!(grid(text, 0, "", &mut problems).is_none() || problems.is_empty());
        let error = problems.into_error(crate::source::Sources::default());
        error.problems.first().map(|diagnostic| diagnostic.problem.to_string())
    }

    #[test]
    fn tables_of_any_size_take_bounded_memory() {
        assert_eq!(refused(&format!("disk,x,y,z\n{}", "1,0,0,0\n".repeat(500_000))), None);
        let long = refused(&format!("# made up\n\ndisk,x\n{}", "1,0\n".repeat(500_001)));
        let message = "the table has 500001 rows of 2 columns; up to 500000 of them are read";
        assert_eq!(long.as_deref(), Some(message));
        let row = format!("{}\n", ["1"; 20].join(","));
        let message = "the table has 250001 rows of 20 columns; up to 250000 of them are read";
        assert_eq!(refused(&row.repeat(250_002)).as_deref(), Some(message));
        let wide = refused(&",".repeat(60_000_000));
        let message = "the table has 60000001 columns; up to 200 are read";
        assert_eq!(wide.as_deref(), Some(message));
        let ragged = refused(&format!("disk;x\n1;0\n{}\n", ";".repeat(60_000_000)));
        assert_eq!(ragged.as_deref(), Some("this line has 60000001 values, not 2"));
    }
}
