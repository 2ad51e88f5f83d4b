//! Apache Parquet, as programs save tables of data. What is read is shown in messages as the lines that it would have as
//! comma-separated values: the names of the columns in the first, row k in line k + 1.

use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use super::grid::{Cell, Grid, Row, Value};
use super::rows::HEADER;
use crate::source::{Span, quoted};

/// What a Parquet file begins and ends with.
const MAGIC: &[u8] = b"PAR1";
/// Rows and columns of a table that is read.
const MOST: [usize; 2] = [500_000, 20];

/// Whether a file is one.
pub(super) fn is_parquet(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Why there is no table, and what to do.
type Refusal = (String, &'static str);

/// The table, of file number `file`, and its text.
pub(super) fn grid(bytes: Vec<u8>, file: usize) -> Result<(Grid, String), Refusal> {
    // The crate checks most of what a damaged file may say, but asserts some.
    catch_unwind(AssertUnwindSafe(|| read(bytes, file)))
        .unwrap_or_else(|_| Err(damaged("its parts contradict one another")))
}

fn damaged(why: &str) -> Refusal {
    let message = format!("the Parquet file cannot be read: {}", quoted(why));
    (message, "write it again, whole, say with pandas or pyarrow")
}

fn unreadable(error: ParquetError) -> Refusal {
    let text = error.to_string();
    if ["Disabled feature", "ompression"].iter().any(|part| text.contains(part)) {
        let message = "the Parquet file is compressed in a way that is not read";
        let help = "write it with compression=\"snappy\" or without, or as CSV";
        return (message.to_owned(), help);
    }
    damaged(text.trim_start_matches("Parquet error: "))
}

fn read(bytes: Vec<u8>, file: usize) -> Result<(Grid, String), Refusal> {
    let length = bytes.len() as u64;
    let reader = SerializedFileReader::new(Bytes::from(bytes)).map_err(unreadable)?;
    let about = reader.metadata().file_metadata();
    let rows =
        usize::try_from(about.num_rows()).map_err(|_| damaged("it has no number of rows"))?;
    let fields = about.schema().get_fields();
    if rows > MOST[0] || fields.len() > MOST[1] {
        let message = format!(
            "the table has {rows} rows of {} columns; up to {} of {} are read",
            fields.len(),
            MOST[0],
            MOST[1]
        );
        return Err((message, HEADER));
    }
    if rows == 0 || fields.is_empty() {
        return Err(("the file has no rows".to_owned(), HEADER));
    }
    if let Some(nested) = fields.iter().find(|field| !field.is_primitive()) {
        let message = format!("the column `{}` holds lists or tables", quoted(nested.name()));
        return Err((message, "a column holds one number, or one name, in each row"));
    }
    let within = |value: i64| u64::try_from(value).is_ok_and(|value| value <= length);
    let chunks = || reader.metadata().row_groups().iter().flat_map(|group| group.columns());
    let places = |chunk: &ColumnChunkMetaData| {
        let first = chunk.dictionary_page_offset();
        [chunk.data_page_offset(), chunk.compressed_size(), first.unwrap_or(0)]
    };
    if !chunks().flat_map(places).all(within) {
        return Err(damaged("it names places beyond its end"));
    }
    let mut lines = Lines { file, text: String::new() };
    let names = fields.iter().map(|field| Value::of(field.name()));
    let Row { cells: columns, span: header } = lines.row(names);
    let mut table = Vec::new();
    for row in reader.get_row_iter(None).map_err(unreadable)?.take(rows) {
        let row = row.map_err(unreadable)?;
        table.push(lines.row(row.get_column_iter().map(|(_, field)| value(field))));
    }
    if table.len() < rows {
        return Err(damaged("rows are missing"));
    }
    Ok((Grid { columns, rows: table, header }, lines.text))
}

/// Numbers as the shortest decimals that give them again.
fn value(field: &Field) -> Value {
    let number = |value: f64, text: String| match value.is_nan() {
        true => Value::Missing,
        false => Value::Text(text),
    };
    match field {
        Field::Null => Value::Missing,
        Field::Double(value) => number(*value, value.to_string()),
        Field::Float(value) => number(f64::from(*value), value.to_string()),
        Field::Float16(value) => number(f64::from(*value), value.to_string()),
        Field::Str(text) => Value::of(text),
        other => Value::Text(other.to_string()),
    }
}

/// The lines that have been shown.
struct Lines {
    file: usize,
    text: String,
}

impl Lines {
    fn row(&mut self, values: impl Iterator<Item = Value>) -> Row {
        let start = self.text.len();
        let mut cells = Vec::new();
        for value in values {
            if !cells.is_empty() {
                self.text.push(',');
            }
            let begin = self.text.len();
            self.text.push_str(&value.text().map(quoted).unwrap_or_default());
            cells.push(Cell { value, span: Span::new(self.file, begin, self.text.len()) });
        }
        let span = Span::new(self.file, start, self.text.len());
        self.text.push('\n');
        Row { cells, span }
    }
}
