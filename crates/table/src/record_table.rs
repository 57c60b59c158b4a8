//! Columns of numbers, counts, flags and texts.

use crate::CsvWriter;

/// Values of a column.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ColumnValues {
    /// Numbers; NaN where there is none.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Counts(Vec<u64>),
    /// Truth values, 0 and 1 as text.
    Flags(Vec<bool>),
    /// Texts.
    Texts(Vec<String>),
}

/// A table of records: a row for each, with columns of several types.
///
/// ```
/// use asperity_table::RecordTable;
/// let table = RecordTable::new()
///     .counts("index", [1, 2])
///     .texts("file", ["a.npy", "b.npy"])
///     .numbers("force_peak_n", [Some(9.5), None])
///     .flags("averaged", [true, false]);
/// assert_eq!(table.to_csv(), "index,file,force_peak_n,averaged\n1,a.npy,9.5,1\n2,b.npy,,0\n");
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordTable {
    columns: Vec<(String, ColumnValues)>,
}

impl RecordTable {
    /// A table without columns.
    pub fn new() -> Self {
        Self::default()
    }

    /// The table with a column of numbers; `None` is NaN, and an empty field as text.
    #[must_use]
    pub fn numbers<T: Into<Option<f64>>>(
        self,
        name: impl Into<String>,
        values: impl IntoIterator<Item = T>,
    ) -> Self {
        let values = values.into_iter().map(|value| value.into().unwrap_or(f64::NAN));
        self.with(name, ColumnValues::Numbers(values.collect()))
    }

    /// The table with a column of whole numbers.
    #[must_use]
    pub fn counts(self, name: impl Into<String>, values: impl IntoIterator<Item = usize>) -> Self {
        let values = values.into_iter().map(|value| value as u64);
        self.with(name, ColumnValues::Counts(values.collect()))
    }

    /// The table with a column of truth values.
    #[must_use]
    pub fn flags(self, name: impl Into<String>, values: impl IntoIterator<Item = bool>) -> Self {
        self.with(name, ColumnValues::Flags(values.into_iter().collect()))
    }

    /// The table with a column of texts.
    #[must_use]
    pub fn texts<T: Into<String>>(
        self,
        name: impl Into<String>,
        values: impl IntoIterator<Item = T>,
    ) -> Self {
        let values = values.into_iter().map(Into::into);
        self.with(name, ColumnValues::Texts(values.collect()))
    }

    fn with(mut self, name: impl Into<String>, values: ColumnValues) -> Self {
        self.columns.push((name.into(), values));
        self
    }

    /// Names and values of the columns, in their order.
    pub fn columns(&self) -> &[(String, ColumnValues)] {
        &self.columns
    }

    /// As [`columns`](Self::columns), without a copy.
    pub fn into_columns(self) -> Vec<(String, ColumnValues)> {
        self.columns
    }

    /// The table as CSV text, in the number format of [`CsvWriter`]. A column shorter than the
    /// longest ends in empty fields.
    pub fn to_csv(&self) -> String {
        let mut csv = CsvWriter::with_header(self.columns.iter().map(|(name, _)| name));
        let rows = self.columns.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
        for row in 0..rows {
            for (_, values) in &self.columns {
                values.write(row, &mut csv);
            }
            csv.end_row();
        }
        csv.into_string()
    }
}

impl ColumnValues {
    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Counts(values) => values.len(),
            Self::Flags(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn write(&self, row: usize, csv: &mut CsvWriter) {
        match self {
            Self::Numbers(values) => csv.number(values.get(row).copied()),
            Self::Counts(values) => csv.number(values.get(row).map(|count| *count as f64)),
            Self::Flags(values) => {
                csv.number(values.get(row).map(|flag| f64::from(u8::from(*flag))))
            }
            Self::Texts(values) => csv.text(values.get(row).map_or("", String::as_str)),
        };
    }
}
