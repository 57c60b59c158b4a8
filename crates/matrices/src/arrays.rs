//! Named arrays of a file, full or sparse: the matrices of a structure, and reduced models.

use crate::error::{MatricesError, Place};
use crate::matrices::assemble;
use crate::sparse::{Entry, SparseSymmetric, Triangles};
use crate::{DenseMatrix, Dof, Matrices, ReducedModel};

/// An array.
pub(crate) enum Array {
    Dense(DenseMatrix),
    Sparse { rows: usize, columns: usize, entries: Vec<Entry> },
}

/// The arrays of a file.
pub(crate) struct Arrays {
    file: String,
    list: Vec<(String, Array)>,
    left_out: Vec<String>,
}

const STIFFNESS: [&str; 2] = ["K", "stiffness"];
const MASS: [&str; 2] = ["M", "mass"];
const ROWS: [&str; 2] = ["dof", "coordinate"];

/// Most rows of a reduced model.
const MOST_REDUCED: usize = 5_000;

impl Array {
    fn shape(&self) -> (usize, usize) {
        match self {
            Self::Dense(dense) => (dense.rows(), dense.columns()),
            Self::Sparse { rows, columns, .. } => (*rows, *columns),
        }
    }

    /// The entries that are not zero.
    fn entries(self) -> Vec<Entry> {
        match self {
            Self::Sparse { entries, .. } => entries,
            Self::Dense(dense) => {
                let rows = dense.rows().max(1);
                let entry = |(index, &value): (usize, &f64)| {
                    let (row, column) = ((index % rows) as u32, (index / rows) as u32);
                    Entry { row, column, value }
                };
                let values = dense.values().iter().enumerate();
                values.filter(|(_, value)| **value != 0.0).map(entry).collect()
            }
        }
    }

    fn dense(self) -> DenseMatrix {
        match self {
            Self::Dense(dense) => dense,
            Self::Sparse { rows, columns, entries } => {
                let mut values = vec![0.0; rows * columns];
                for entry in entries {
                    values[entry.row as usize + entry.column as usize * rows] += entry.value;
                }
                DenseMatrix::new(rows, columns, values)
            }
        }
    }
}

impl Arrays {
    pub(crate) fn new(file: &str) -> Self {
        Self { file: file.to_owned(), list: Vec::new(), left_out: Vec::new() }
    }

    pub(crate) fn add(&mut self, name: String, array: Array) {
        self.list.push((name, array));
    }

    /// Remembers an array that cannot be used, for messages.
    pub(crate) fn leave_out(&mut self, name: &str, reason: &str) {
        self.left_out.push(format!("{name} {reason}"));
    }

    /// Removes and returns an array by one of its names.
    fn take(&mut self, names: [&str; 2]) -> Option<Array> {
        let index = self.list.iter().position(|(name, _)| names.contains(&name.as_str()))?;
        Some(self.list.swap_remove(index).1)
    }

    fn need(&mut self, names: [&str; 2]) -> Result<Array, MatricesError> {
        let array = self.take(names);
        array.ok_or_else(|| {
            let names = names.iter().filter(|name| !name.is_empty()).copied().collect::<Vec<_>>();
            let mut present: Vec<String> = self.list.iter().map(|(name, _)| name.clone()).collect();
            present.extend(self.left_out.iter().cloned());
            let what = format!("{}: no array {}", self.file, names.join(" or "));
            let present = if present.is_empty() { "none".into() } else { present.join(", ") };
            MatricesError::inconsistent(what, format!("the file has {present}"))
        })
    }

    fn wrong(&self, name: &str, found: String, expected: impl Into<String>) -> MatricesError {
        MatricesError::malformed(&self.file, Place::Array(name.to_owned()), found, expected)
    }

    fn check_shape(
        &self,
        name: &str,
        array: &Array,
        (rows, columns): (usize, usize),
    ) -> Result<(), MatricesError> {
        if array.shape() == (rows, columns) {
            return Ok(());
        }
        let found = format!("{} x {}", array.shape().0, array.shape().1);
        Err(self.wrong(name, found, format!("{rows} x {columns}")))
    }

    fn check_finite(&self, name: &str, array: &Array) -> Result<(), MatricesError> {
        let place = |row: usize, column: usize, value: f64| {
            let found = format!("the element ({}, {}) is {value}", row + 1, column + 1);
            Err(self.wrong(name, found, "finite numbers"))
        };
        match array {
            Array::Dense(dense) => {
                let index = dense.values().iter().position(|value| !value.is_finite());
                index.map_or(Ok(()), |index| {
                    place(index % dense.rows(), index / dense.rows(), dense.values()[index])
                })
            }
            Array::Sparse { entries, .. } => {
                let entry = entries.iter().find(|entry| !entry.value.is_finite());
                entry.map_or(Ok(()), |e| place(e.row as usize, e.column as usize, e.value))
            }
        }
    }

    /// The matrices of a structure; `rows` in place of those of the file.
    pub(crate) fn matrices(
        mut self,
        mut mass: Option<Self>,
        rows: Option<Vec<Dof>>,
    ) -> Result<Matrices, MatricesError> {
        let dofs = match rows {
            Some(rows) => rows,
            None => self.dofs()?,
        };
        self.check_transformation()?;
        let stiffness = self.symmetric(STIFFNESS, &dofs)?;
        let mass = mass.as_mut().unwrap_or(&mut self).symmetric(MASS, &dofs)?;
        Matrices::new(stiffness, mass, dofs)
    }

    fn symmetric(
        &mut self,
        names: [&str; 2],
        dofs: &[Dof],
    ) -> Result<SparseSymmetric, MatricesError> {
        let array = match self.scipy()? {
            Some(array) => array,
            None => self.need(names)?,
        };
        self.check_shape(names[0], &array, (dofs.len(), dofs.len()))?;
        self.check_finite(names[0], &array)?;
        let file = format!("{}, array {}", self.file, names[0]);
        Ok(assemble(&file, dofs, array.entries(), Triangles::OneOrBoth)?.matrix)
    }

    /// The one matrix of an archive of `scipy.sparse.save_npz`, in the format csr, csc or coo. The matrix is
    /// symmetric, so that rows and columns may be exchanged.
    fn scipy(&mut self) -> Result<Option<Array>, MatricesError> {
        let mut numbers = |name: &str| -> Result<Option<Vec<f64>>, MatricesError> {
            let Some(array) = self.take([name, ""]) else { return Ok(None) };
            match array {
                Array::Dense(dense) => Ok(Some(dense.values().to_vec())),
                Array::Sparse { .. } => Err(self.wrong(name, "it is sparse".into(), "numbers")),
            }
        };
        let (starts, indices) = (numbers("indptr")?, numbers("indices")?);
        let (rows, columns) = (numbers("row")?, numbers("col")?);
        let (values, shape) = (numbers("data")?, numbers("shape")?);
        let (rows, columns) = match (starts, indices, rows, columns) {
            (Some(starts), Some(indices), _, _) => {
                if !starts.is_sorted() || starts.last() != Some(&(indices.len() as f64)) {
                    return Err(self.wrong(
                        "indptr",
                        "it does not ascend to the number of entries".into(),
                        "a csr or csc matrix",
                    ));
                }
                let of = |index: usize| {
                    starts.partition_point(|start| *start <= index as f64) as f64 - 1.0
                };
                ((0..indices.len()).map(of).collect(), indices)
            }
            (_, _, Some(rows), Some(columns)) => (rows, columns),
            _ => return Ok(None),
        };
        let (Some(values), Some(&[count, across])) = (values, shape.as_deref()) else {
            return Err(self.wrong(
                "data",
                "it is absent, or there is no shape".into(),
                "a matrix of scipy.sparse",
            ));
        };
        let size = u32::try_from(count as i64).ok().filter(|_| count == across);
        let within = |index: &f64| *index >= 0.0 && *index < count;
        let lengths = rows.len() == columns.len() && rows.len() == values.len();
        let Some(size) = size.filter(|_| lengths && rows.iter().chain(&columns).all(within)) else {
            return Err(self.wrong(
                "shape",
                format!("{count} x {across}"),
                "a square matrix with its entries",
            ));
        };
        let places = rows.iter().zip(&columns).zip(values);
        let entries = places
            .map(|((row, column), value)| Entry { row: *row as u32, column: *column as u32, value })
            .collect();
        Ok(Some(Array::Sparse { rows: size as usize, columns: size as usize, entries }))
    }

    /// The rows: `n x 2`, node and direction.
    fn dofs(&mut self) -> Result<Vec<Dof>, MatricesError> {
        let expected = "n x 2, full: a node and a direction for each row of the matrices";
        let array = match self.need(ROWS)? {
            Array::Dense(array) if array.columns() == 2 && array.rows() > 0 => array,
            other => {
                let found = format!("{} x {}", other.shape().0, other.shape().1);
                return Err(self.wrong(ROWS[0], found, expected));
            }
        };
        let whole =
            |value: f64| (value.fract() == 0.0 && value.abs() < 1e15).then_some(value as i64);
        let row = |row: usize| {
            let (node, direction) = (array.get(row, 0), array.get(row, 1));
            let dof = whole(node).zip(whole(direction));
            let dof = dof.and_then(|(node, direction)| Dof::of_numbers(node, direction));
            dof.ok_or_else(|| {
                let found = format!("row {} is ({node}, {direction})", row + 1);
                self.wrong(ROWS[0], found, "a node and a direction from 1 to 6")
            })
        };
        (0..array.rows()).map(row).collect()
    }

    /// The transformation of a system of SDynPy is the identity: its rows are degrees of freedom of nodes.
    fn check_transformation(&mut self) -> Result<(), MatricesError> {
        let Some(transformation) = self.take(["transformation", ""]) else { return Ok(()) };
        let (rows, columns) = transformation.shape();
        let entries = transformation.entries();
        let ones = entries.iter().all(|entry| entry.row == entry.column && entry.value == 1.0);
        if ones && rows == columns && entries.len() == rows {
            return Ok(());
        }
        let found = "it is not the identity".to_owned();
        Err(self.wrong(
            "transformation",
            found,
            "a system whose rows are degrees of freedom of nodes",
        ))
    }

    /// A reduced model.
    pub(crate) fn reduced(mut self) -> Result<ReducedModel, MatricesError> {
        let stiffness = self.need(STIFFNESS)?;
        let size = stiffness.shape().0;
        if size == 0 || size > MOST_REDUCED {
            let found = format!("{size} rows");
            return Err(self.wrong(STIFFNESS[0], found, format!("1 to {MOST_REDUCED}")));
        }
        let mass = self.need(MASS)?;
        let stiffness = self.dense_symmetric(STIFFNESS[0], stiffness, size)?;
        let mass = self.dense_symmetric(MASS[0], mass, size)?;
        let closure = self.need(["W", ""])?;
        let cells = closure.shape().0;
        if cells > MOST_REDUCED {
            return Err(self.wrong(
                "W",
                format!("{cells} rows"),
                format!("at most {MOST_REDUCED}"),
            ));
        }
        let closure = self.dense("W", closure, (cells, size))?;
        let area = self.need(["area", ""])?;
        let areas = self.vector("area", area, cells)?;
        if let Some(cell) = areas.iter().position(|area| *area <= 0.0) {
            let found = format!("element {} is {}", cell + 1, areas[cell]);
            return Err(self.wrong("area", found, "positive areas"));
        }
        let loads = match self.take(["f", ""]) {
            Some(loads) => self.vector("f", loads, size)?,
            None => vec![0.0; size],
        };
        let responses = match self.take(["R", ""]) {
            Some(responses) if responses.shape().0 <= MOST_REDUCED => {
                let rows = responses.shape().0;
                self.dense("R", responses, (rows, size))?
            }
            Some(responses) => {
                let found = format!("{} rows", responses.shape().0);
                return Err(self.wrong("R", found, format!("at most {MOST_REDUCED}")));
            }
            None => DenseMatrix::new(0, size, Vec::new()),
        };
        Ok(ReducedModel { stiffness, mass, closure, areas_m2: areas, loads, responses })
    }

    fn dense(
        &self,
        name: &str,
        array: Array,
        shape: (usize, usize),
    ) -> Result<DenseMatrix, MatricesError> {
        self.check_shape(name, &array, shape)?;
        self.check_finite(name, &array)?;
        Ok(array.dense())
    }

    /// A row or a column of `length` numbers.
    fn vector(&self, name: &str, array: Array, length: usize) -> Result<Vec<f64>, MatricesError> {
        let shape = if array.shape().1 == 1 { (length, 1) } else { (1, length) };
        Ok(self.dense(name, array, shape)?.values().to_vec())
    }

    fn dense_symmetric(
        &self,
        name: &str,
        array: Array,
        size: usize,
    ) -> Result<DenseMatrix, MatricesError> {
        self.check_shape(name, &array, (size, size))?;
        self.check_finite(name, &array)?;
        // Rows of a reduced model have numbers only.
        let dofs: Vec<Dof> = (1..).take(size).map(|row| Dof::new(row, 1)).collect();
        let file = format!("{}, array {name}", self.file);
        let matrix = assemble(&file, &dofs, array.entries(), Triangles::OneOrBoth)?.matrix;
        let mut values = vec![0.0; size * size];
        for (row, column, value) in matrix.triplets() {
            values[row + column * size] = value;
            values[column + row * size] = value;
        }
        Ok(DenseMatrix::new(size, size, values))
    }
}
