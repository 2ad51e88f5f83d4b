//! Parquet tables that differ in their values, types and pieces: of a file that another program has written hardly any byte can
//! change without breaking it, so that what is read after the footer would not be reached.

use std::sync::Arc;

use parquet::basic::Compression;
use parquet::column::writer::ColumnWriter;
use parquet::errors::ParquetError;
use parquet::file::properties::{WriterProperties, WriterVersion};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use crate::random::Random;

/// A column: its name, its type, and its values, of which some may be missing where it is optional.
struct Column {
    name: &'static str,
    kind: &'static str,
    optional: bool,
    values: Vec<Option<f64>>,
}

/// Markers on the second and third disk in two steps of actuation, mostly as they may be.
pub fn parquet(random: &mut Random) -> Vec<u8> {
    let mut columns = columns(random);
    if random.chance(15) {
        let odd = *random.pick(&[f64::NAN, f64::INFINITY, -1.0, 0.0, 9.0, 1e300]);
        let column = random.below(columns.len());
        let row = random.below(columns[column].values.len());
        columns[column].values[row] = Some(odd);
    }
    written(&columns, random).expect("the table can be written")
}

fn columns(random: &mut Random) -> Vec<Column> {
    let mut places: Vec<[f64; 2]> = vec![[1.0, 2.0], [1.0, 3.0], [2.0, 2.0], [2.0, 3.0]];
    places.truncate(1 + random.below(4));
    let whole = *random.pick(&["int32", "int64", "int64", "double"]);
    let real = *random.pick(&["double", "double", "float"]);
    let of = |name, kind, optional, values| Column { name, kind, optional, values };
    let mut columns: Vec<Column> = ["step", "disk"]
        .into_iter()
        .enumerate()
        .map(|(k, name)| of(name, whole, false, places.iter().map(|at| Some(at[k])).collect()))
        .collect();
    for name in ["x", "y", "z"] {
        let values = places.iter().map(|_| Some(200.0 * random.unit() - 100.0)).collect();
        columns.push(of(name, real, false, values));
    }
    for (name, scale) in [("deviation", 0.5), ("confidence", 1.0)] {
        if random.chance(50) {
            let optional = random.chance(50);
            let value = |random: &mut Random| {
                (!optional || random.chance(70)).then(|| scale * (0.1 + 0.9 * random.unit()))
            };
            let values = places.iter().map(|_| value(random)).collect();
            columns.push(of(name, real, optional, values));
        }
    }
    columns
}

fn written(columns: &[Column], random: &mut Random) -> Result<Vec<u8>, ParquetError> {
    let line = |column: &Column| {
        let repetition = if column.optional { "optional" } else { "required" };
        format!("{repetition} {} {};", column.kind, column.name)
    };
    let lines: Vec<String> = columns.iter().map(line).collect();
    let schema = parse_message_type(&format!("message table {{ {} }}", lines.join(" ")))?;
    let versions = [WriterVersion::PARQUET_1_0, WriterVersion::PARQUET_2_0];
    let properties = WriterProperties::builder()
        .set_writer_version(*random.pick(&versions))
        .set_dictionary_enabled(random.chance(50))
        .set_compression(*random.pick(&[Compression::UNCOMPRESSED, Compression::SNAPPY]))
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let rows = columns[0].values.len();
    let split = if random.chance(30) { random.below(rows) } else { 0 };
    for range in [0..split, split..rows] {
        if range.is_empty() {
            continue;
        }
        let mut group = writer.next_row_group()?;
        for column in columns {
            let Some(mut chunk) = group.next_column()? else { break };
            let all = &column.values[range.clone()];
            let values = || all.iter().copied().flatten();
            let levels: Vec<i16> = all.iter().map(|value| i16::from(value.is_some())).collect();
            let levels = column.optional.then_some(&levels[..]);
            match chunk.untyped() {
                ColumnWriter::Int32ColumnWriter(to) => {
                    to.write_batch(&values().map(|v| v as i32).collect::<Vec<_>>(), levels, None)?
                }
                ColumnWriter::Int64ColumnWriter(to) => {
                    to.write_batch(&values().map(|v| v as i64).collect::<Vec<_>>(), levels, None)?
                }
                ColumnWriter::FloatColumnWriter(to) => {
                    to.write_batch(&values().map(|v| v as f32).collect::<Vec<_>>(), levels, None)?
                }
                ColumnWriter::DoubleColumnWriter(to) => {
                    to.write_batch(&values().collect::<Vec<_>>(), levels, None)?
                }
                _ => 0,
            };
            chunk.close()?;
        }
        group.close()?;
    }
    writer.into_inner()
}
