//! Tables as Apache Parquet.

use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use super::NonFinite;
use super::csv::{Cell, CsvTable};

impl CsvTable {
    /// The table as the bytes of a Parquet file, compressed by Snappy: columns of numbers are DOUBLE, of whole numbers INT64, all others
    /// texts; what is empty is null.
    ///
    /// # Errors
    /// [`NonFinite`] with row (from 1) and column of a number that is not finite.
    pub fn to_parquet(&self) -> Result<Vec<u8>, NonFinite> {
        for (i, row) in self.rows().iter().enumerate() {
            for (cell, name) in row.iter().zip(self.columns()) {
                if let Cell::Number(value) = cell
                    && !value.is_finite()
                {
                    let path = format!("row {}, column {name}", i + 1);
                    return Err(NonFinite { path, value: *value });
                }
            }
        }
        // Written to memory from columns of one length each, nothing can fail.
        Ok(write(self).unwrap_or_default())
    }

    /// What a column holds.
    fn kind(&self, column: usize) -> Physical {
        let mut kinds = self.rows().iter().filter_map(|row| match row[column] {
            Cell::Number(_) => Some(Physical::DOUBLE),
            Cell::Integer(_) => Some(Physical::INT64),
            Cell::Text(_) => Some(Physical::BYTE_ARRAY),
            Cell::Empty => None,
        });
        let Some(first) = kinds.next() else { return Physical::DOUBLE };
        kinds.fold(first, |kind, other| match (kind, other) {
            (a, b) if a == b => a,
            (Physical::BYTE_ARRAY, _) | (_, Physical::BYTE_ARRAY) => Physical::BYTE_ARRAY,
            _ => Physical::DOUBLE,
        })
    }
}

fn write(table: &CsvTable) -> Result<Vec<u8>, ParquetError> {
    let kinds: Vec<Physical> = (0..table.columns().len()).map(|k| table.kind(k)).collect();
    let column = |(name, kind): (&String, &Physical)| {
        let text = (*kind == Physical::BYTE_ARRAY).then_some(LogicalType::String);
        let of = Type::primitive_type_builder(name, *kind)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(text);
        of.build().map(Arc::new)
    };
    let fields = table.columns().iter().zip(&kinds).map(column).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("table").with_fields(fields).build()?);
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (k, kind) in kinds.iter().enumerate() {
        write_column(table, k, *kind, &mut group)?;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

fn write_column<W: std::io::Write + Send>(
    table: &CsvTable,
    column: usize,
    kind: Physical,
    group: &mut SerializedRowGroupWriter<'_, W>,
) -> Result<(), ParquetError> {
    let cells = || table.rows().iter().map(|row| &row[column]);
    let levels: Vec<i16> = cells().map(|cell| i16::from(*cell != Cell::Empty)).collect();
    let Some(mut writer) = group.next_column()? else { return Ok(()) };
    match kind {
        Physical::INT64 => {
            let value = |cell: &Cell| match cell {
                Cell::Integer(value) => Some(*value),
                _ => None,
            };
            let values: Vec<i64> = cells().filter_map(value).collect();
            writer.typed::<Int64Type>().write_batch(&values, Some(&levels), None)?;
        }
        Physical::DOUBLE => {
            let value = |cell: &Cell| match cell {
                Cell::Number(value) => Some(*value),
                Cell::Integer(value) => Some(*value as f64),
                Cell::Text(_) | Cell::Empty => None,
            };
            let values: Vec<f64> = cells().filter_map(value).collect();
            writer.typed::<DoubleType>().write_batch(&values, Some(&levels), None)?;
        }
        _ => {
            let value = |cell: &Cell| match cell {
                Cell::Text(text) => Some(ByteArray::from(text.as_str())),
                Cell::Number(value) => Some(ByteArray::from(format!("{value:?}").as_str())),
                Cell::Integer(value) => Some(ByteArray::from(value.to_string().as_str())),
                Cell::Empty => None,
            };
            let values: Vec<ByteArray> = cells().filter_map(value).collect();
            writer.typed::<ByteArrayType>().write_batch(&values, Some(&levels), None)?;
        }
    }
    writer.close()
}
