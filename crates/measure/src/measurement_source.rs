//! Sources of measurements: files, and records in memory.

use std::path::{Path, PathBuf};

use crate::{MeasureError, Measurement, ReadOptions, Reader, Record, open};

/// A file, or records in memory: both are read in the same way.
#[derive(Debug, Clone, PartialEq)]
pub enum MeasurementSource {
    /// A file of any format.
    File(PathBuf),
    /// Records in memory.
    Records {
        /// Name in results and messages, in place of a file's name.
        name: PathBuf,
        /// The records.
        records: Vec<Record>,
    },
}

impl MeasurementSource {
    /// The path of the file, or the name of the records.
    pub fn name(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Records { name, .. } => name,
        }
    }

    /// Opens the source for reading record by record.
    ///
    /// # Errors
    /// Those of [`open`] and [`Reader::of_records`].
    pub fn open(&self, options: &ReadOptions) -> Result<Reader<'_>, MeasureError> {
        match self {
            Self::File(path) => open(path, options),
            Self::Records { name, records } => {
                Reader::of_records(&name.to_string_lossy(), records, options)
            }
        }
    }

    /// Reads the whole source.
    ///
    /// # Errors
    /// Those of [`MeasurementSource::open`] and [`Reader::next_record`].
    pub fn read(&self, options: &ReadOptions) -> Result<Measurement, MeasureError> {
        self.open(&ReadOptions { block: usize::MAX, ..options.clone() })?.read_all()
    }
}

impl From<PathBuf> for MeasurementSource {
    fn from(path: PathBuf) -> Self {
        Self::File(path)
    }
}
