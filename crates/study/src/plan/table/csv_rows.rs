//! Rows of a CSV file by their number: the byte offsets of some rows are kept.
//!
//! The crate `csv` reads the records and gives their offsets. The index of `csv-index` holds every
//! offset, 8 bytes a row, as a file of its own; this one holds at most 65,536 and no file.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;

use csv::{ErrorKind, Reader, ReaderBuilder, StringRecord};
use serde_json::Value;

use super::column::TableColumn;

/// Rows from one kept offset to the next, at first.
const FIRST_STRIDE: u64 = 256;

/// Most offsets that are kept: beyond them, every second one is dropped.
const MOST_OFFSETS: usize = 1 << 16;

/// A CSV file whose rows have been checked.
#[derive(Debug, Clone)]
pub(super) struct CsvRows {
    rows: u64,
    /// Byte offsets of the rows with numbers 0, `stride`, 2 `stride`, ...
    offsets: Vec<u64>,
    stride: u64,
    /// Places of the inputs among the columns.
    places: Vec<usize>,
}

impl CsvRows {
    /// Reads the whole file once.
    pub(super) fn check(file: impl Read, columns: &[TableColumn]) -> Result<Self, String> {
        let mut reader = Reader::from_reader(file);
        let header = reader.headers().map_err(|error| words(&error))?;
        let names: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        let places = columns.iter().map(|one| one.place(&names)).collect::<Result<_, _>>()?;
        let mut found = Self { rows: 0, offsets: Vec::new(), stride: FIRST_STRIDE, places };
        let mut record = StringRecord::new();
        loop {
            let offset = reader.position().byte();
            if !reader.read_record(&mut record).map_err(|error| words(&error))? {
                return Ok(found);
            }
            found.of_record(columns, &record, found.rows)?;
            found.keep(offset);
        }
    }

    fn keep(&mut self, offset: u64) {
        if self.rows.is_multiple_of(self.stride) {
            if self.offsets.len() == MOST_OFFSETS {
                self.offsets = self.offsets.iter().step_by(2).copied().collect();
                self.stride *= 2;
            }
            // The number of offsets is even, so that this row has a place in the wider stride.
            self.offsets.push(offset);
        }
        self.rows += 1;
    }

    fn of_record(
        &self,
        columns: &[TableColumn],
        record: &StringRecord,
        row: u64,
    ) -> Result<Vec<Value>, String> {
        let value = |(column, &place): (&TableColumn, &usize)| {
            column
                .of_text(record.get(place).unwrap_or_default())
                .map_err(|fault| format!("{fault}; row {}, column `{}`", row + 1, column.names[0]))
        };
        columns.iter().zip(&self.places).map(value).collect()
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> u64 {
        self.rows
    }

    /// Some rows, from the nearest offset before them.
    pub(super) fn values(
        &self,
        mut file: File,
        columns: &[TableColumn],
        rows: Range<u64>,
    ) -> Result<Vec<Vec<Value>>, String> {
        let nearest = (rows.start / self.stride) as usize;
        let offset = self.offsets.get(nearest).copied().unwrap_or_default();
        file.seek(SeekFrom::Start(offset)).map_err(|error| error.to_string())?;
        let mut reader = ReaderBuilder::new().has_headers(false).from_reader(file);
        let mut record = StringRecord::new();
        let mut values = Vec::new();
        for row in nearest as u64 * self.stride..rows.end {
            if !reader.read_record(&mut record).map_err(|error| words(&error))? {
                break;
            }
            if row >= rows.start {
                values.push(self.of_record(columns, &record, row)?);
            }
        }
        Ok(values)
    }
}

fn words(error: &csv::Error) -> String {
    match error.kind() {
        ErrorKind::UnequalLengths { pos, expected_len, len } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            format!("has {len} fields in line {line}; accepted: {expected_len}, as in its header")
        }
        ErrorKind::Utf8 { pos, .. } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            format!("is not UTF-8 text in line {line}")
        }
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn column() -> Vec<TableColumn> {
        vec![TableColumn { names: vec!["x".into()], options: None }]
    }

    #[test]
    fn rows_are_found_by_number_when_offsets_have_been_dropped() {
        let mut file = tempfile::tempfile().unwrap();
        let mut found = CsvRows { rows: 0, offsets: Vec::new(), stride: 1, places: vec![1] };
        let mut offset = 0;
        let rows = 2 * MOST_OFFSETS as u64 + 77;
        for row in 0..rows {
            let text = format!("\"a\n,\",{row}\n");
            file.write_all(text.as_bytes()).unwrap();
            found.keep(offset);
            offset += text.len() as u64;
        }
        assert_eq!((found.rows(), found.stride), (rows, 4));
        assert!(found.offsets.len() <= MOST_OFFSETS);
        for start in [0, 1, 131_071, 131_073, rows - 2] {
            let range = start..(start + 5).min(rows);
            let values = found.values(file.try_clone().unwrap(), &column(), range.clone()).unwrap();
            let expected: Vec<Vec<Value>> = range.map(|row| vec![row.into()]).collect();
            assert_eq!(values, expected);
        }
    }
}
