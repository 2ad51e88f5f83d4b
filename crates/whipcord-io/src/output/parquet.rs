//! Tables as Apache Parquet.

use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type};

use super::NonFinite;
use super::csv::{Cell, CsvTable};

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its values, one for each row.
    pub values: Values,
}

/// The values of a [`Column`].
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers; what is not finite is null.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Integers(Vec<Option<i64>>),
    /// Truth values.
    Flags(Vec<Option<bool>>),
    /// Texts.
    Texts(Vec<Option<String>>),
}

impl Values {
    const fn kind(&self) -> Physical {
        match self {
            Self::Numbers(_) => Physical::DOUBLE,
            Self::Integers(_) => Physical::INT64,
            Self::Flags(_) => Physical::BOOLEAN,
            Self::Texts(_) => Physical::BYTE_ARRAY,
        }
    }
}

impl Values {
    /// Whether a dictionary of the values makes the column smaller, as far as the first of them tell.
    fn recur(&self) -> bool {
        const FIRST: usize = 256;
        match self {
            Self::Numbers(values) => {
                let mut first: Vec<u64> =
                    values.iter().take(FIRST).map(|value| value.to_bits()).collect();
                let count = first.len();
                first.sort_unstable();
                first.dedup();
                2 * first.len() <= count
            }
            Self::Integers(_) | Self::Flags(_) => false,
            Self::Texts(_) => true,
        }
    }
}

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
        let columns = self.columns().iter().enumerate();
        let columns: Vec<Column> = columns
            .map(|(k, name)| Column { name: name.clone(), values: self.values(k) })
            .collect();
        Ok(columns_to_parquet(&columns))
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

    fn values(&self, column: usize) -> Values {
        let cells = self.rows().iter().map(|row| &row[column]);
        match self.kind(column) {
            Physical::INT64 => {
                let value = |cell: &Cell| match cell {
                    Cell::Integer(value) => Some(*value),
                    _ => None,
                };
                Values::Integers(cells.map(value).collect())
            }
            Physical::DOUBLE => {
                let value = |cell: &Cell| match cell {
                    Cell::Number(value) => *value,
                    Cell::Integer(value) => *value as f64,
                    Cell::Text(_) | Cell::Empty => f64::NAN,
                };
                Values::Numbers(cells.map(value).collect())
            }
            _ => {
                let value = |cell: &Cell| match cell {
                    Cell::Text(text) => Some(text.clone()),
                    Cell::Number(value) => Some(format!("{value:?}")),
                    Cell::Integer(value) => Some(value.to_string()),
                    Cell::Empty => None,
                };
                Values::Texts(cells.map(value).collect())
            }
        }
    }
}

/// A table as the bytes of a Parquet file, compressed by Snappy. All columns have as many values.
#[must_use]
pub fn columns_to_parquet(columns: &[Column]) -> Vec<u8> {
    // Written to memory from columns of one length each, nothing can fail.
    write(columns).unwrap_or_default()
}

fn write(columns: &[Column]) -> Result<Vec<u8>, ParquetError> {
    let column = |Column { name, values }: &Column| {
        let kind = values.kind();
        let text = (kind == Physical::BYTE_ARRAY).then_some(LogicalType::String);
        let of = Type::primitive_type_builder(name, kind)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(text);
        of.build().map(Arc::new)
    };
    let fields = columns.iter().map(column).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("table").with_fields(fields).build()?);
    let mut properties = WriterProperties::builder().set_compression(Compression::SNAPPY);
    for Column { name, values } in columns {
        let path = ColumnPath::from(name.as_str());
        properties = properties.set_column_dictionary_enabled(path, values.recur());
    }
    let properties = properties.build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for column in columns {
        write_column(&column.values, &mut group)?;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

/// The values that are there, and of each row whether it has one.
fn present<T: Copy>(values: &[Option<T>]) -> (Vec<T>, Vec<i16>) {
    let levels = values.iter().map(|value| i16::from(value.is_some())).collect();
    (values.iter().filter_map(|value| *value).collect(), levels)
}

fn write_column<W: std::io::Write + Send>(
    values: &Values,
    group: &mut SerializedRowGroupWriter<'_, W>,
) -> Result<(), ParquetError> {
    let Some(mut writer) = group.next_column()? else { return Ok(()) };
    match values {
        Values::Integers(values) => {
            let (values, levels) = present(values);
            writer.typed::<Int64Type>().write_batch(&values, Some(&levels), None)?;
        }
        Values::Numbers(values) => {
            let levels: Vec<i16> =
                values.iter().map(|value| i16::from(value.is_finite())).collect();
            let finite: Vec<f64>;
            let values = match levels.contains(&0) {
                true => {
                    finite = values.iter().copied().filter(|value| value.is_finite()).collect();
                    &finite
                }
                false => values,
            };
            writer.typed::<DoubleType>().write_batch(values, Some(&levels), None)?;
        }
        Values::Flags(values) => {
            let (values, levels) = present(values);
            writer.typed::<BoolType>().write_batch(&values, Some(&levels), None)?;
        }
        Values::Texts(values) => {
            let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
            let texts = values.iter().flatten();
            let values: Vec<ByteArray> = texts.map(|text| ByteArray::from(text.as_str())).collect();
            writer.typed::<ByteArrayType>().write_batch(&values, Some(&levels), None)?;
        }
    }
    writer.close()
}
