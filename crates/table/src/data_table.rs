//! Named columns of numbers, integers, truth values and texts.

use crate::CsvWriter;

/// Values of a column.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ColumnData {
    /// Numbers, NaN where there is none.
    Numbers(Vec<f64>),
    /// Integers.
    Integers(Vec<i64>),
    /// Truth values, `true` and `false` as text.
    Truths(Vec<bool>),
    /// Truth values, 1 and 0 as text.
    Flags(Vec<bool>),
    /// Truth values that are not known everywhere.
    PartialTruths(Vec<Option<bool>>),
    /// Texts.
    Texts(Vec<String>),
}

impl ColumnData {
    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Integers(values) => values.len(),
            Self::Truths(values) | Self::Flags(values) => values.len(),
            Self::PartialTruths(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes the field of a row; an empty one beyond the last row.
    fn write(&self, row: usize, csv: &mut CsvWriter) {
        let truth = |value: bool| if value { "true" } else { "false" };
        match self {
            Self::Numbers(values) => csv.number(values.get(row).copied()),
            Self::Integers(values) => csv.number(values.get(row).map(|&value| value as f64)),
            Self::Truths(values) => csv.text(values.get(row).map_or("", |&value| truth(value))),
            Self::Flags(values) => csv.number(values.get(row).copied().map(f64::from)),
            Self::PartialTruths(values) => {
                csv.text(values.get(row).copied().flatten().map_or("", truth))
            }
            Self::Texts(values) => csv.text(values.get(row).map_or("", String::as_str)),
        };
    }
}

impl From<Vec<f64>> for ColumnData {
    fn from(values: Vec<f64>) -> Self {
        Self::Numbers(values)
    }
}

impl From<Vec<i64>> for ColumnData {
    fn from(values: Vec<i64>) -> Self {
        Self::Integers(values)
    }
}

impl From<Vec<bool>> for ColumnData {
    fn from(values: Vec<bool>) -> Self {
        Self::Truths(values)
    }
}

impl From<Vec<Option<bool>>> for ColumnData {
    fn from(values: Vec<Option<bool>>) -> Self {
        Self::PartialTruths(values)
    }
}

impl From<Vec<String>> for ColumnData {
    fn from(values: Vec<String>) -> Self {
        Self::Texts(values)
    }
}

/// Columns of several types, as results have them, in their order.
///
/// ```
/// use asperity_table::DataTable;
/// let table = DataTable::new()
///     .with("branch", vec![1_i64, 1])
///     .with("frequency_hz", vec![800.5, f64::NAN])
///     .with("stable", vec![Some(true), None])
///     .flags("averaged", [true, false])
///     .texts("file", ["a.npy", "b.npy"]);
/// let text = "branch,frequency_hz,stable,averaged,file\n1,800.5,true,1,a.npy\n1,,,0,b.npy\n";
/// assert_eq!(table.to_csv(), text);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DataTable {
    columns: Vec<(String, ColumnData)>,
}

impl DataTable {
    /// A table without columns.
    pub fn new() -> Self {
        Self::default()
    }

    /// The table with one more column. A column shorter than the longest ends in empty fields.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, data: impl Into<ColumnData>) -> Self {
        self.columns.push((name.into(), data.into()));
        self
    }

    /// The table with a column of numbers; `None` is NaN, and an empty field as text.
    #[must_use]
    pub fn numbers<T: Into<Option<f64>>>(
        self,
        name: impl Into<String>,
        values: impl IntoIterator<Item = T>,
    ) -> Self {
        let values = values.into_iter().map(|value| value.into().unwrap_or(f64::NAN));
        self.with(name, ColumnData::Numbers(values.collect()))
    }

    /// The table with a column of counts.
    #[must_use]
    pub fn counts(self, name: impl Into<String>, values: impl IntoIterator<Item = usize>) -> Self {
        let values = values.into_iter().map(|value| i64::try_from(value).unwrap_or(i64::MAX));
        self.with(name, ColumnData::Integers(values.collect()))
    }

    /// The table with a column of truth values that are 1 and 0 as text.
    #[must_use]
    pub fn flags(self, name: impl Into<String>, values: impl IntoIterator<Item = bool>) -> Self {
        self.with(name, ColumnData::Flags(values.into_iter().collect()))
    }

    /// The table with a column of texts.
    #[must_use]
    pub fn texts<T: Into<String>>(
        self,
        name: impl Into<String>,
        values: impl IntoIterator<Item = T>,
    ) -> Self {
        let values = values.into_iter().map(Into::into);
        self.with(name, ColumnData::Texts(values.collect()))
    }

    /// Names and values, in order.
    pub fn columns(&self) -> &[(String, ColumnData)] {
        &self.columns
    }

    /// Names and values, in order.
    pub fn into_columns(self) -> Vec<(String, ColumnData)> {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.iter().map(|(_, data)| data.len()).max().unwrap_or(0)
    }

    /// The table as CSV text, in the formats of [`CsvWriter`].
    pub fn to_csv(&self) -> String {
        let mut csv = CsvWriter::with_header(self.columns.iter().map(|(name, _)| name));
        for row in 0..self.rows() {
            for (_, data) in &self.columns {
                data.write(row, &mut csv);
            }
            csv.end_row();
        }
        csv.into_string()
    }
}
