//! Named columns of equal length: what a figure draws and what its CSV file holds.

use crate::FigureError;

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
///
/// ```
/// use asperity_figure::Table;
/// let table = Table::new()
///     .with_column("frequency_hz", vec![1.0, 2.0])?
///     .with_column("gain", vec![0.5, f64::NAN])?;
/// assert_eq!(table.to_csv(), "frequency_hz,gain\n1,0.5\n2,\n");
/// # Ok::<(), asperity_figure::FigureError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    columns: Vec<Column>,
}

impl Table {
    /// A table without columns.
    pub fn new() -> Self {
        Self::default()
    }

    /// The table with one more column.
    ///
    /// # Errors
    /// [`FigureError::UnequalLengths`] or [`FigureError::DuplicateColumn`].
    pub fn with_column(
        mut self,
        name: impl Into<String>,
        values: impl Into<Vec<f64>>,
    ) -> Result<Self, FigureError> {
        self.push(name, values)?;
        Ok(self)
    }

    /// Adds a column.
    ///
    /// # Errors
    /// [`FigureError::UnequalLengths`] or [`FigureError::DuplicateColumn`].
    pub fn push(
        &mut self,
        name: impl Into<String>,
        values: impl Into<Vec<f64>>,
    ) -> Result<(), FigureError> {
        let (name, values) = (name.into(), values.into());
        if self.columns.iter().any(|column| column.name == name) {
            return Err(FigureError::DuplicateColumn { name });
        }
        if !self.columns.is_empty() && values.len() != self.rows() {
            return Err(FigureError::UnequalLengths {
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
    /// [`FigureError::UnknownColumn`].
    pub fn column(&self, name: &str) -> Result<&[f64], FigureError> {
        match self.columns.iter().find(|column| column.name == name) {
            Some(column) => Ok(&column.values),
            None => Err(FigureError::UnknownColumn {
                name: name.to_owned(),
                available: self.names().map(str::to_owned).collect(),
            }),
        }
    }

    /// Whether there is a column called `name`.
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

    /// Whether the table has no value.
    pub fn is_empty(&self) -> bool {
        self.rows() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_unequal_lengths_and_repeated_names() {
        let table = Table::new().with_column("a", vec![1.0, 2.0]).unwrap();
        assert!(matches!(
            table.clone().with_column("b", vec![1.0]),
            Err(FigureError::UnequalLengths { expected: 2, found: 1, .. })
        ));
        assert!(matches!(
            table.clone().with_column("a", vec![1.0, 2.0]),
            Err(FigureError::DuplicateColumn { .. })
        ));
        assert!(matches!(table.column("z"), Err(FigureError::UnknownColumn { .. })));
        assert_eq!(table.column("a").unwrap(), [1.0, 2.0]);
    }
}
