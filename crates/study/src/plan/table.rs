//! Rows of inputs from a file, which stays on the disk.

mod column;
mod csv_rows;
mod parquet_rows;

use std::fs::Metadata;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use asperity_sampling::MOST_ROWS;
use asperity_scenario::{InputError, file_sha256, open_input};
use asperity_simulation::error::SimulationError;
use serde_json::Value;

use crate::error::StudyError;
pub(crate) use column::TableColumn;
use csv_rows::CsvRows;
use parquet_rows::ParquetRows;

/// Rows of inputs in a CSV or Parquet file that has been checked from end to end.
#[derive(Debug, Clone)]
pub(crate) struct TableRows {
    path: PathBuf,
    sha256: String,
    stamp: (u64, Option<SystemTime>),
    columns: Vec<TableColumn>,
    source: Source,
}

#[derive(Debug, Clone)]
enum Source {
    Csv(CsvRows),
    Parquet(ParquetRows),
}

impl TableRows {
    /// Checks the file from end to end: every row must have a value for each of `columns`. Of CSV
    /// files the places of some rows are kept, in bounded memory.
    ///
    /// # Errors
    /// [`StudyError::Table`] for the first fault, [`StudyError::Study`] for a file that cannot
    /// be read.
    pub(crate) fn read(
        path: PathBuf,
        columns: Vec<TableColumn>,
        expected: Option<u64>,
    ) -> Result<Self, StudyError> {
        let input = |source: InputError| {
            StudyError::from(SimulationError::Input { path: path.clone(), source })
        };
        let fault = |fault: String| StudyError::Table { path: path.clone(), fault };
        let file = open_input(&path, u64::MAX).map_err(input)?;
        let stamp = stamp(&file.metadata().map_err(|error| fault(error.to_string()))?);
        let sha256 = file_sha256(&path).map_err(input)?;
        let is_parquet =
            path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"));
        let source = if is_parquet {
            ParquetRows::check(file, &columns).map(Source::Parquet)
        } else {
            CsvRows::check(file, &columns).map(Source::Csv)
        };
        let source = source.map_err(fault)?;
        let found = Self { path, sha256, stamp, columns, source };
        let rows = found.rows();
        if !(1..=MOST_ROWS).contains(&rows) || expected.is_some_and(|expected| expected != rows) {
            let accepted =
                expected.map_or_else(|| format!("1 to {MOST_ROWS}"), |rows| rows.to_string());
            return Err(found.fault(format!("has {rows} rows; accepted: {accepted}")));
        }
        found.check_unchanged()?;
        Ok(found)
    }

    fn fault(&self, fault: String) -> StudyError {
        StudyError::Table { path: self.path.clone(), fault }
    }

    fn check_unchanged(&self) -> Result<(), StudyError> {
        match std::fs::metadata(&self.path) {
            Ok(now) if stamp(&now) == self.stamp => Ok(()),
            Ok(_) => Err(self.fault("has changed since the study read it; start again".into())),
            Err(source) => Err(StudyError::Io { path: self.path.clone(), source }),
        }
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> u64 {
        match &self.source {
            Source::Csv(rows) => rows.rows(),
            Source::Parquet(rows) => rows.rows(),
        }
    }

    /// SHA-256 of the file.
    pub(crate) fn sha256(&self) -> &str {
        &self.sha256
    }

    /// The inputs of some rows, from the disk.
    ///
    /// # Errors
    /// [`StudyError::Table`] for a file that has changed, [`StudyError::Io`].
    pub(crate) fn values(&self, rows: Range<u64>) -> Result<Vec<Vec<Value>>, StudyError> {
        self.check_unchanged()?;
        let path: &Path = &self.path;
        let file = std::fs::File::open(path)
            .map_err(|source| StudyError::Io { path: path.to_owned(), source })?;
        let count = rows.end - rows.start;
        let found = match &self.source {
            Source::Csv(source) => source.values(file, &self.columns, rows),
            Source::Parquet(source) => source.values(file, &self.columns, rows),
        };
        let found = found.map_err(|fault| self.fault(fault))?;
        if found.len() as u64 != count {
            return Err(self.fault("ends before its last row".into()));
        }
        Ok(found)
    }
}

/// Length and time of change of a file, which tell whether it is the one that was read.
fn stamp(metadata: &Metadata) -> (u64, Option<SystemTime>) {
    (metadata.len(), metadata.modified().ok())
}
