//! Rows of a Parquet file by their number, of flat columns of numbers and texts.

use std::fs::File;
use std::ops::Range;

use parquet::basic::{ConvertedType, LogicalType, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;
use serde_json::Value;

use super::column::TableColumn;
use crate::study_table::{guarded, words};

/// Rows that are checked at a time.
const BATCH: u64 = 1 << 14;

/// A Parquet file whose rows have been checked.
#[derive(Debug, Clone)]
pub(super) struct ParquetRows {
    rows: u64,
    /// Places of the inputs among the columns.
    places: Vec<usize>,
}

impl ParquetRows {
    /// Reads the columns of the inputs once.
    pub(super) fn check(file: File, columns: &[TableColumn]) -> Result<Self, String> {
        guarded(|| Self::read_all(file, columns))
    }

    fn read_all(file: File, columns: &[TableColumn]) -> Result<Self, String> {
        let reader = SerializedFileReader::new(file).map_err(words)?;
        let metadata = reader.metadata();
        let schema = metadata.file_metadata().schema_descr();
        let names: Vec<String> =
            schema.columns().iter().map(|column| column.path().parts().join(".")).collect();
        let places: Vec<usize> =
            columns.iter().map(|one| one.place(&names)).collect::<Result<_, _>>()?;
        for (one, &place) in columns.iter().zip(&places) {
            check_type(one, schema.column(place).as_ref())?;
        }
        let groups = (0..metadata.num_row_groups()).map(|group| metadata.row_group(group));
        let sizes = groups.map(|group| u64::try_from(group.num_rows()).unwrap_or(0));
        let rows = sizes.fold(0, u64::saturating_add);
        let found = Self { rows, places };
        for start in (0..rows).step_by(BATCH as usize) {
            let range = start..start.saturating_add(BATCH).min(rows);
            let count = range.end - range.start;
            if found.read(&reader, columns, range)?.len() as u64 != count {
                return Err("ends before its last row".into());
            }
        }
        Ok(found)
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> u64 {
        self.rows
    }

    /// Some rows.
    pub(super) fn values(
        &self,
        file: File,
        columns: &[TableColumn],
        rows: Range<u64>,
    ) -> Result<Vec<Vec<Value>>, String> {
        guarded(|| {
            let reader = SerializedFileReader::new(file).map_err(words)?;
            self.read(&reader, columns, rows)
        })
    }

    fn read(
        &self,
        reader: &SerializedFileReader<File>,
        columns: &[TableColumn],
        rows: Range<u64>,
    ) -> Result<Vec<Vec<Value>>, String> {
        let mut values: Vec<Vec<Value>> = Vec::new();
        let mut first = 0_u64;
        for group in 0..reader.metadata().num_row_groups() {
            let size = u64::try_from(reader.metadata().row_group(group).num_rows()).unwrap_or(0);
            let group_rows = first..first.saturating_add(size);
            first = first.saturating_add(size);
            let part = rows.start.max(group_rows.start)..rows.end.min(group_rows.end);
            if part.is_empty() {
                continue;
            }
            let begin = values.len();
            values.resize(begin + (part.end - part.start) as usize, Vec::new());
            let group_reader = reader.get_row_group(group).map_err(words)?;
            for (column, &place) in columns.iter().zip(&self.places) {
                let reader = group_reader.get_column_reader(place).map_err(words)?;
                let within = part.start - group_rows.start..part.end - group_rows.start;
                let found = column_values(reader, column, within).map_err(|(at, fault)| {
                    let row = part.start + at as u64 + 1;
                    format!("{fault}; row {row}, column `{}`", column.names[0])
                })?;
                for (row, value) in values[begin..].iter_mut().zip(found) {
                    row.push(value);
                }
            }
        }
        if values.iter().any(|row| row.len() != columns.len()) {
            return Err("ends before its last row".into());
        }
        Ok(values)
    }
}

/// Refuses columns that are neither numbers nor texts.
fn check_type(one: &TableColumn, column: &ColumnDescriptor) -> Result<(), String> {
    let is_flat = column.max_rep_level() == 0 && column.path().parts().len() == 1;
    // Wide integers without a sign are stored as negative ones.
    let plain_integer = match column.logical_type_ref() {
        None => !matches!(
            column.converted_type(),
            ConvertedType::DECIMAL | ConvertedType::UINT_32 | ConvertedType::UINT_64
        ),
        Some(LogicalType::Integer(integer)) => integer.is_signed || integer.bit_width < 32,
        Some(_) => false,
    };
    let accepted = match column.physical_type() {
        Type::DOUBLE | Type::FLOAT => true,
        Type::INT32 | Type::INT64 => plain_integer,
        Type::BYTE_ARRAY => {
            let is_text = matches!(column.logical_type_ref(), Some(LogicalType::String))
                || column.converted_type() == ConvertedType::UTF8;
            is_text && one.options.is_some()
        }
        _ => false,
    };
    if is_flat && accepted {
        return Ok(());
    }
    let accepted = if one.options.is_some() { "numbers or texts" } else { "numbers" };
    let (name, found) = (&one.names[0], column.physical_type());
    Err(format!("has the column `{name}` of type {found}; accepted: {accepted}"))
}

/// Values of some rows of a column, or the place of the first fault among them.
fn column_values(
    reader: ColumnReader,
    column: &TableColumn,
    rows: Range<u64>,
) -> Result<Vec<Value>, (usize, String)> {
    let integer = |value: i64| match column.options {
        None => Ok(value.into()),
        Some(_) => column.of_text(&value.to_string()),
    };
    match reader {
        ColumnReader::DoubleColumnReader(reader) => {
            typed(reader, rows, |value| column.of_number(*value))
        }
        ColumnReader::FloatColumnReader(reader) => {
            typed(reader, rows, |value| column.of_number(f64::from(*value)))
        }
        ColumnReader::Int32ColumnReader(reader) => {
            typed(reader, rows, |value| integer(i64::from(*value)))
        }
        ColumnReader::Int64ColumnReader(reader) => typed(reader, rows, |value| integer(*value)),
        ColumnReader::ByteArrayColumnReader(reader) => typed(reader, rows, |value| {
            column.of_text(value.as_utf8().map_err(|_| "is not UTF-8 text".to_owned())?)
        }),
        _ => Err((0, "has another type than numbers and texts".into())),
    }
}

fn typed<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    rows: Range<u64>,
    value: impl Fn(&T::T) -> Result<Value, String>,
) -> Result<Vec<Value>, (usize, String)> {
    let here = |error: ParquetError| (0, words(error));
    reader.skip_records(rows.start as usize).map_err(here)?;
    let count = (rows.end - rows.start) as usize;
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    let mut done = 0;
    while done < count {
        let (records, _, _) = reader
            .read_records(count - done, Some(&mut levels), None, &mut values)
            .map_err(here)?;
        if records == 0 {
            break;
        }
        done += records;
    }
    // Columns without nulls have no levels.
    if let Some(null) = levels.iter().position(|&level| level == 0)
        && values.len() < done
    {
        return Err((null, "there is no value".into()));
    }
    values.iter().enumerate().map(|(at, one)| value(one).map_err(|fault| (at, fault))).collect()
}
