//! Dense matrices.

/// A dense matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct DenseMatrix {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

impl DenseMatrix {
    /// The matrix of `rows` rows whose entries are `values`, column by column.
    ///
    /// # Panics
    /// If the number of values is not `rows columns`.
    pub fn new(rows: usize, columns: usize, values: Vec<f64>) -> Self {
        assert_eq!(Some(values.len()), rows.checked_mul(columns), "number of values");
        Self { rows, columns, values }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The entry of `row` and `column`.
    ///
    /// # Panics
    /// If there is none.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        assert!(row < self.rows, "row {row} of {}", self.rows);
        self.values[row + column * self.rows]
    }

    /// The entries, column by column.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The product with the vector `x`.
    ///
    /// # Panics
    /// If the length of `x` is not the number of columns.
    pub fn multiply(&self, x: &[f64]) -> Vec<f64> {
        assert_eq!(x.len(), self.columns, "length of the vector");
        let mut product = vec![0.0; self.rows];
        for (column, factor) in x.iter().enumerate() {
            let values = &self.values[column * self.rows..(column + 1) * self.rows];
            for (sum, value) in product.iter_mut().zip(values) {
                *sum += factor * value;
            }
        }
        product
    }

    /// The transposed matrix.
    #[must_use]
    pub fn transposed(&self) -> Self {
        let entries = (0..self.rows).flat_map(|row| (0..self.columns).map(move |c| (row, c)));
        let values = entries.map(|(row, column)| self.get(row, column)).collect();
        Self { rows: self.columns, columns: self.rows, values }
    }
}
