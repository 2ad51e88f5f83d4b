//! Apache Parquet, as programs save tables of data. What is read is shown in messages as the lines that it would have as
//! comma-separated values: the names of the columns in the first, row k in line k + 1.

use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use parquet::column::reader::ColumnReader;
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use super::grid::{Cell, Grid, Row, Value, too_large};
use super::thrift::{Item, Reader};
use crate::files;
use crate::source::{Span, quoted};

/// What a Parquet file begins and ends with.
const MAGIC: &[u8] = b"PAR1";
/// Bytes of the footer, which lists what is in the file: a table of many pieces takes some hundred thousand.
const LONGEST_FOOTER: usize = 1 << 22;
/// Entries of the schema, and parts of one; a table has one for each column.
const LARGEST_SCHEMA: usize = 210;
/// What a table must have.
const HEADER: &str = "a table has named columns and a row for each line of values";
/// Pages in all, and bytes of all of them when they are unpacked: twice as many as of the largest file.
const MOST_PAGES: usize = 100_000;
const MOST_UNPACKED: u64 = 2 * files::LARGEST_TABLE as u64;
/// In this encoding a value may repeat the one before it: a few bytes make any number of long texts.
const DELTA_BYTE_ARRAY: i64 = 7;

/// Whether a file is one.
pub(super) fn is_parquet(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Why there is no table, and what to do.
type Refusal = (String, &'static str);

/// The table, of file number `file`, and its text.
pub(super) fn grid(bytes: Vec<u8>, file: usize) -> Result<(Grid, String), Refusal> {
    without_panic(|| read(bytes, file))
}

/// The crate checks most of what a damaged file may say, but asserts some.
fn without_panic<T>(read: impl FnOnce() -> Result<T, Refusal>) -> Result<T, Refusal> {
    catch_unwind(AssertUnwindSafe(read))
        .unwrap_or_else(|_| Err(damaged("its parts contradict one another")))
}

/// A file whose footer lists no more elements than that.
fn open(bytes: Bytes, most: usize) -> Result<SerializedFileReader<Bytes>, Refusal> {
    check_footer(&bytes, most)?;
    SerializedFileReader::new(bytes).map_err(unreadable)
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

/// A column without missing values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TableColumn {
    /// Numbers.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Integers(Vec<i64>),
}

/// The columns of numbers and of whole numbers of a table without missing values, and no others.
pub(crate) fn columns(bytes: Vec<u8>, most: usize) -> Result<Vec<(String, TableColumn)>, String> {
    if !is_parquet(&bytes) {
        return Err("it is not a Parquet file".to_owned());
    }
    without_panic(|| read_columns(bytes, most)).map_err(|(message, _)| message)
}

fn read_columns(bytes: Vec<u8>, most: usize) -> Result<Vec<(String, TableColumn)>, Refusal> {
    let bytes = Bytes::from(bytes);
    let reader = open(bytes.clone(), most + 1)?;
    let metadata = reader.metadata();
    check_pages(&bytes, metadata.row_groups().iter().flat_map(|group| group.columns()))?;
    let fields = metadata.file_metadata().schema().get_fields();
    let mut columns = Vec::new();
    for (number, field) in fields.iter().enumerate() {
        let (mut numbers, mut integers) = (Vec::new(), Vec::new());
        for group in 0..reader.num_row_groups() {
            let group = reader.get_row_group(group).map_err(unreadable)?;
            let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
            let read = match group.get_column_reader(number).map_err(unreadable)? {
                ColumnReader::DoubleColumnReader(mut column) => {
                    column.read_records(rows, Some(&mut Vec::new()), None, &mut numbers)
                }
                ColumnReader::Int64ColumnReader(mut column) => {
                    column.read_records(rows, Some(&mut Vec::new()), None, &mut integers)
                }
                _ => continue,
            };
            let (_, values, _) = read.map_err(unreadable)?;
            if values != rows {
                return Err(damaged("values are missing"));
            }
        }
        let values = match (numbers.is_empty(), integers.is_empty()) {
            (false, true) => TableColumn::Numbers(numbers),
            (true, false) => TableColumn::Integers(integers),
            _ => continue,
        };
        columns.push((field.name().to_owned(), values));
    }
    Ok(columns)
}

fn read(bytes: Vec<u8>, file: usize) -> Result<(Grid, String), Refusal> {
    let bytes = Bytes::from(bytes);
    let reader = open(bytes.clone(), LARGEST_SCHEMA)?;
    let about = reader.metadata().file_metadata();
    let rows =
        usize::try_from(about.num_rows()).map_err(|_| damaged("it has no number of rows"))?;
    let fields = about.schema().get_fields();
    if let Some(message) = too_large(rows, fields.len()) {
        return Err((message, HEADER));
    }
    if rows == 0 || fields.is_empty() {
        return Err(("the file has no rows".to_owned(), HEADER));
    }
    if let Some(nested) = fields.iter().find(|field| !field.is_primitive()) {
        let message = format!("the column `{}` holds lists or tables", quoted(nested.name()));
        return Err((message, "a column holds one number, or one name, in each row"));
    }
    let chunks = || reader.metadata().row_groups().iter().flat_map(|group| group.columns());
    check_pages(&bytes, chunks())?;
    let mut lines = Lines { file, text: String::new(), kept: 0 };
    let names = fields.iter().map(|field| Value::of(field.name()));
    let Row { cells: columns, span: header } = lines.row(names);
    let mut table = Vec::new();
    for row in reader.get_row_iter(None).map_err(unreadable)?.take(rows) {
        let row = row.map_err(unreadable)?;
        table.push(lines.row(row.get_column_iter().map(|(_, field)| value(field))));
        if lines.kept > files::LARGEST_TABLE {
            let most = files::LARGEST_TABLE;
            let message = format!("the texts of the table have more than {most} bytes");
            return Err((message, "a column holds one number, or one name, in each row"));
        }
    }
    if table.len() < rows {
        return Err(damaged("rows are missing"));
    }
    Ok((Grid { columns, rows: table, header }, lines.text))
}

/// Refuses a file whose footer says that it has more parts than a table has: the crate makes room for all before it
/// looks for them, and follows parts of parts without end.
fn check_footer(bytes: &[u8], most: usize) -> Result<(), Refusal> {
    let too_early = || damaged("it ends too early");
    let tail = bytes.len().checked_sub(8).ok_or_else(too_early)?;
    let length = bytes[tail..tail + 4].try_into().map_err(|_| too_early())?;
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST_FOOTER {
        return Err(damaged("its footer is too long"));
    }
    let start = tail.checked_sub(length).ok_or_else(too_early)?;
    let mut largest = 0;
    let read = Reader::new(&bytes[start..tail]).read_struct(&mut |path, item| match (path, item) {
        // The elements of the schema, and the number of parts that one of them says it has.
        ([2], Item::Length(count)) => largest = largest.max(count),
        ([2, 5], Item::Number(count)) => {
            largest = largest.max(usize::try_from(count).unwrap_or(usize::MAX));
        }
        _ => {}
    });
    read.ok_or_else(|| damaged("its footer is broken"))?;
    if largest > most {
        return Err(too_large(0, largest - 1).map_or_else(too_early, |message| (message, HEADER)));
    }
    Ok(())
}

/// Refuses pages beyond the end of the file, and pages that a few bytes say become many.
fn check_pages<'a>(
    bytes: &[u8],
    chunks: impl Iterator<Item = &'a ColumnChunkMetaData>,
) -> Result<(), Refusal> {
    let (mut pages, mut unpacked) = (0, 0_u64);
    for chunk in chunks {
        let start = chunk.dictionary_page_offset().unwrap_or(chunk.data_page_offset());
        let place = usize::try_from(start).ok().zip(usize::try_from(chunk.compressed_size()).ok());
        let content = place.and_then(|(start, size)| bytes.get(start..start.checked_add(size)?));
        let content = content.ok_or_else(|| damaged("it names places beyond its end"))?;
        let mut reader = Reader::new(content);
        while reader.position() < content.len() {
            let (mut packed, mut is_delta) = (0, false);
            let header = reader.read_struct(&mut |path, item| match (path, item) {
                ([2], Item::Number(size)) => {
                    unpacked = unpacked.saturating_add(size.unsigned_abs());
                }
                ([3], Item::Number(size)) => packed = size,
                ([5, 2] | [8, 4], Item::Number(encoding)) => {
                    is_delta |= encoding == DELTA_BYTE_ARRAY;
                }
                _ => {}
            });
            let packed = header.and_then(|()| usize::try_from(packed).ok());
            let passed = packed.and_then(|packed| reader.pass(packed));
            passed.ok_or_else(|| damaged("a page is broken"))?;
            pages += 1;
            if is_delta {
                let message = "the Parquet file has texts in the encoding DELTA_BYTE_ARRAY, which is not read";
                return Err((message.to_owned(), "write it with the usual encodings, or as CSV"));
            }
            if pages > MOST_PAGES || unpacked > MOST_UNPACKED {
                let message = format!(
                    "the Parquet file unpacks to more than {MOST_UNPACKED} bytes or {MOST_PAGES} pages"
                );
                return Err((message, "is this the file you meant? A table of markers is smaller"));
            }
        }
    }
    Ok(())
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
    /// Bytes of the texts in all cells.
    kept: usize,
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
            self.kept += value.text().map_or(0, str::len);
            self.text.push_str(&value.text().map(quoted).unwrap_or_default());
            cells.push(Cell { value, span: Span::new(self.file, begin, self.text.len()) });
        }
        let span = Span::new(self.file, start, self.text.len());
        self.text.push('\n');
        Row { cells, span }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use parquet::data_type::{ByteArray, ByteArrayType};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    use parquet::schema::types::{SchemaDescPtr, SchemaDescriptor};

    use super::*;

    const TEXTS: &str = "message table { required binary name (UTF8); }";

    fn descriptor(schema: &str) -> SchemaDescPtr {
        Arc::new(SchemaDescriptor::new(Arc::new(parse_message_type(schema).unwrap())))
    }

    /// A table of one text, so many times.
    fn repeated(text: &str, rows: usize) -> Vec<u8> {
        let schema = Arc::new(parse_message_type(TEXTS).unwrap());
        let properties =
            Arc::new(WriterProperties::builder().set_dictionary_page_size_limit(1 << 30).build());
        let mut writer = SerializedFileWriter::new(Vec::new(), schema, properties).unwrap();
        let mut group = writer.next_row_group().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        let values = vec![ByteArray::from(text); rows];
        column.typed::<ByteArrayType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
        writer.into_inner().unwrap()
    }

    #[test]
    fn a_text_that_is_said_once_and_meant_many_times_is_refused() {
        assert_eq!(grid(repeated("a name", 400), 0).unwrap().0.rows.len(), 400);
        let bytes = repeated(&"x".repeat(1 << 19), 400);
        assert!(bytes.len() < 1 << 21, "{} bytes mean 200 million", bytes.len());
        let (message, _) = grid(bytes, 0).unwrap_err();
        assert_eq!(message, "the texts of the table have more than 67108864 bytes");
    }

    /// A page that unpacks to so many bytes, if its header is right.
    fn page(unpacked: u32, encoding: u8) -> Vec<u8> {
        let mut size = Vec::new();
        let mut rest = u64::from(unpacked) * 2;
        while rest > 127 {
            size.push(rest as u8 | 128);
            rest >>= 7;
        }
        size.push(rest as u8);
        // Fields 1: kind 0, 2: unpacked, 3: packed, 4, 5: the struct of a data page with 8 values in an encoding.
        let head = [&[0x15, 0, 0x15][..], &size, &[0x15, 8]].concat();
        [&head[..], &[0x2c, 0x15, 16, 0x15, 2 * encoding, 0, 0], b"data"].concat()
    }

    #[test]
    fn pages_are_measured_before_they_are_unpacked() {
        let schema = descriptor(TEXTS);
        let check = |pages: &[Vec<u8>], length: Option<i64>| {
            let bytes = [MAGIC, &pages.concat()].concat();
            let chunk = ColumnChunkMetaData::builder(schema.column(0))
                .set_data_page_offset(4)
                .set_total_compressed_size(length.unwrap_or(bytes.len() as i64 - 4))
                .build()
                .unwrap();
            check_pages(&bytes, [&chunk].into_iter()).map_err(|(message, _)| message)
        };
        assert_eq!(check(&[page(100, 0), page(7_000_000, 8)], None), Ok(()));
        let half = page(70_000_000, 0);
        let message = "the Parquet file unpacks to more than 134217728 bytes or 100000 pages";
        assert_eq!(check(&[half.clone(), half.clone()], None), Err(message.to_owned()));
        let message = check(&[page(100, 7)], None).unwrap_err();
        assert!(message.contains("DELTA_BYTE_ARRAY"), "{message}");
        for (pages, length) in [(&[half.clone()][..], Some(10)), (&[half], Some(1 << 40))] {
            assert!(check(pages, length).unwrap_err().contains("cannot be read"));
        }
    }

    /// A file with nothing but this footer.
    fn with_footer(footer: &[u8]) -> String {
        let length = u32::try_from(footer.len()).unwrap().to_le_bytes();
        grid([MAGIC, footer, &length, MAGIC].concat(), 0).unwrap_err().0
    }

    /// Schemas are trees that the crate follows by calls within calls, with room made for as many parts as they say.
    #[test]
    fn footers_are_measured_before_they_are_read() {
        let element = |parts: &[u8]| [&[0x48, 1, b'n', 0x15][..], parts, &[0]].concat();
        // Field 2: a list of structs of name and number of parts.
        let of = |count: u8, element: &[u8]| {
            let head = [0x29, 0xfc, count | 128, 1];
            [&head[..], &element.repeat(128 + usize::from(count)), &[0]].concat()
        };
        let deep = with_footer(&of(100, &element(&[2])));
        assert_eq!(deep, "the table has 227 columns; up to 200 are read");
        let wide = with_footer(
            &[&[0x29, 0x1c][..], &element(&[0xfe, 0xff, 0xff, 0xff, 0x0f]), &[0]].concat(),
        );
        assert_eq!(wide, "the table has 2147483646 columns; up to 200 are read");
        assert!(with_footer(&[0x1c; 100]).contains("its footer is broken"));
        assert!(with_footer(&vec![0; LONGEST_FOOTER + 1]).contains("its footer is too long"));
    }
}
