//! Named columns of equal length.

use crate::columns_to_csv;

/// A named column; the name ends with its unit, such as `frequency_hz`.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    name: String,
    values: Vec<f64>,
}

impl Column {
    /// Name with unit.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Values, NaN where there is none.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// Columns of equal length with distinct names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    columns: Vec<Column>,
}

/// Reasons why a table refuses a column.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// A column does not have the length of the columns before it.
    #[error("column `{name}` has {found} rows, the table has {expected}")]
    UnequalLengths {
        /// Name of the column.
        name: String,
        /// Rows of the table so far.
        expected: usize,
        /// Rows of the column.
        found: usize,
    },
    /// A column name is used twice.
    #[error("column `{name}` is already in the table")]
    DuplicateColumn {
        /// The repeated name.
        name: String,
    },
    /// A table has no column of that name.
    #[error("no column `{name}`; the table has {available:?}")]
    UnknownColumn {
        /// The name asked for.
        name: String,
        /// Names of all columns.
        available: Vec<String>,
    },
}

impl Table {
    /// A table without columns.
    pub fn new() -> Self {
        Self::default()
    }

    /// The table with one more column.
    ///
    /// # Errors
    /// [`TableError::UnequalLengths`] or [`TableError::DuplicateColumn`].
    pub fn with_column(
        mut self,
        name: impl Into<String>,
        values: impl Into<Vec<f64>>,
    ) -> Result<Self, TableError> {
        self.push(name, values)?;
        Ok(self)
    }

    /// Adds a column.
    ///
    /// # Errors
    /// [`TableError::UnequalLengths`] or [`TableError::DuplicateColumn`].
    pub fn push(
        &mut self,
        name: impl Into<String>,
        values: impl Into<Vec<f64>>,
    ) -> Result<(), TableError> {
        let (name, values) = (name.into(), values.into());
        if self.has_column(&name) {
            return Err(TableError::DuplicateColumn { name });
        }
        if !self.columns.is_empty() && values.len() != self.rows() {
            return Err(TableError::UnequalLengths {
                name,
                expected: self.rows(),
                found: values.len(),
            });
        }
        self.columns.push(Column { name, values });
        Ok(())
    }

    /// Values of the column called `name`.
    ///
    /// # Errors
    /// [`TableError::UnknownColumn`].
    pub fn column(&self, name: &str) -> Result<&[f64], TableError> {
        match self.columns.iter().find(|column| column.name == name) {
            Some(column) => Ok(&column.values),
            None => Err(TableError::UnknownColumn {
                name: name.to_owned(),
                available: self.names().map(str::to_owned).collect(),
            }),
        }
    }

    /// True if there is a column called `name`.
    pub fn has_column(&self, name: &str) -> bool {
        self.columns.iter().any(|column| column.name == name)
    }

    /// Columns in order.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Column names in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(Column::name)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The table as CSV text, in the number format of [`CsvWriter`](crate::CsvWriter).
    pub fn to_csv(&self) -> String {
        columns_to_csv(self.columns.iter().map(|column| (column.name(), column.values())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unequal_lengths_and_repeated_names_are_errors() {
        let table = Table::new().with_column("a", [1.0, 2.0]).unwrap();
        assert!(matches!(
            table.clone().with_column("b", [1.0]),
            Err(TableError::UnequalLengths { expected: 2, found: 1, .. })
        ));
        assert!(matches!(
            table.clone().with_column("a", [1.0, 2.0]),
            Err(TableError::DuplicateColumn { .. })
        ));
        assert!(matches!(table.column("z"), Err(TableError::UnknownColumn { .. })));
        assert_eq!(table.column("a").unwrap(), [1.0, 2.0]);
    }
}
