//! Columns of the joined table, each read from the disk as often as it is needed.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

use asperity_table::DataTable;
use parquet::column::reader::get_typed_column_reader;
use parquet::data_type::{ByteArrayType, DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::Value;

use crate::error::StudyError;

/// Values that are read at a time.
const BATCH: usize = 1 << 14;

/// Visits a level for each row, 1 where there is a value, and the values that are there.
type VisitLevels<'a, T> = &'a mut dyn FnMut(&[i16], &[T]);

/// The table of a finished study, as Parquet.
pub(crate) struct StudyTable {
    path: PathBuf,
    reader: SerializedFileReader<File>,
}

impl StudyTable {
    /// Opens the table of the study of `identity`.
    ///
    /// # Errors
    /// [`StudyError::Io`], and [`StudyError::Table`] for a file that is damaged or of another
    /// study.
    pub(crate) fn open(path: PathBuf, identity: &Value) -> Result<Self, StudyError> {
        let file =
            File::open(&path).map_err(|source| StudyError::Io { path: path.clone(), source })?;
        let table = |fault: String| StudyError::Table { path: path.clone(), fault };
        let reader = guarded(|| SerializedFileReader::new(file).map_err(words)).map_err(table)?;
        let mut entries =
            reader.metadata().file_metadata().key_value_metadata().into_iter().flatten();
        let found = entries.find(|entry| entry.key == "asperity:identity");
        let found = found.and_then(|entry| serde_json::from_str(entry.value.as_ref()?).ok());
        if found.as_ref() != Some(identity) {
            return Err(table("is the table of another study".into()));
        }
        Ok(Self { path, reader })
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> u64 {
        u64::try_from(self.reader.metadata().file_metadata().num_rows()).unwrap_or(0)
    }

    /// Place of the column of this name.
    pub(crate) fn place(&self, name: &str) -> Result<usize, StudyError> {
        let schema = self.reader.metadata().file_metadata().schema_descr();
        let place = schema.columns().iter().position(|column| column.name() == name);
        place.ok_or_else(|| self.fault(format!("has no column `{name}`")))
    }

    /// Visits the numbers of a column, NaN where there is none.
    pub(crate) fn numbers(
        &self,
        place: usize,
        visit: &mut dyn FnMut(&[f64]),
    ) -> Result<(), StudyError> {
        let mut numbers = Vec::with_capacity(BATCH);
        self.read::<DoubleType>(place, &mut |levels, values| {
            let mut values = values.iter();
            numbers.clear();
            numbers.extend(levels.iter().map(|&level| match level {
                0 => f64::NAN,
                _ => values.next().copied().unwrap_or(f64::NAN),
            }));
            visit(&numbers);
        })
    }

    /// Visits the texts of a column that are there.
    pub(crate) fn texts(
        &self,
        place: usize,
        visit: &mut dyn FnMut(&str),
    ) -> Result<(), StudyError> {
        self.read::<ByteArrayType>(place, &mut |_, values| {
            for value in values {
                visit(&String::from_utf8_lossy(value.data()));
            }
        })
    }

    /// The columns of these names, numbers or not, in memory.
    pub(crate) fn columns<'a>(
        &self,
        columns: impl IntoIterator<Item = (&'a str, bool)>,
    ) -> Result<DataTable, StudyError> {
        let mut all = DataTable::new();
        for (name, is_number) in columns {
            let place = self.place(name)?;
            all = if is_number {
                let mut numbers = Vec::new();
                self.numbers(place, &mut |values| numbers.extend_from_slice(values))?;
                all.with(name, numbers)
            } else {
                let mut texts = Vec::new();
                self.read::<ByteArrayType>(place, &mut |levels, values| {
                    let mut values =
                        values.iter().map(|value| String::from_utf8_lossy(value.data()));
                    texts.extend(levels.iter().map(|&level| match level {
                        0 => String::new(),
                        _ => values.next().unwrap_or_default().into_owned(),
                    }));
                })?;
                all.with(name, texts)
            };
        }
        Ok(all)
    }

    fn read<T: DataType>(
        &self,
        place: usize,
        visit: VisitLevels<'_, T::T>,
    ) -> Result<(), StudyError> {
        guarded(|| {
            let (mut levels, mut values) = (Vec::new(), Vec::new());
            for group in 0..self.reader.metadata().num_row_groups() {
                let group = self.reader.get_row_group(group).map_err(words)?;
                let column = group.get_column_reader(place).map_err(words)?;
                let mut column = get_typed_column_reader::<T>(column);
                loop {
                    levels.clear();
                    values.clear();
                    let (records, ..) = column
                        .read_records(BATCH, Some(&mut levels), None, &mut values)
                        .map_err(words)?;
                    if records == 0 {
                        break;
                    }
                    visit(&levels, &values);
                }
            }
            Ok(())
        })
        .map_err(|fault| self.fault(fault))
    }

    /// An error that names the file.
    pub(crate) fn fault(&self, fault: String) -> StudyError {
        StudyError::Table { path: self.path.clone(), fault }
    }
}

/// Words for an error of reading.
pub(crate) fn words(error: ParquetError) -> String {
    match error {
        ParquetError::NYI(text) => format!("{text}; accepted: Snappy or no compression"),
        other => format!("cannot be read as Parquet: {other}"),
    }
}

/// Panics of the crate `parquet`, which asserts what a damaged file may break, as errors.
pub(crate) fn guarded<T>(read: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err("is damaged".into()))
}
