//! Reduced models: dense matrices with the closure rows of contact cells.

use std::path::Path;

use crate::text::Content;
use crate::{DenseMatrix, Dof, Matrices, MatricesError, SparseSymmetric, matlab, npz};

/// A reduced model of a structure with contact cells, in SI units.
///
/// With reduced coordinates `q` and pressures `p` of the cells, static equilibrium is
///
/// ```text
/// K q + W^T (A p(W q)) = f,
/// ```
///
/// and the responses are `R q`.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedModel {
    /// `K`, of as many rows as there are reduced coordinates; symmetric.
    pub stiffness: DenseMatrix,
    /// `M`, of the same size; symmetric, and not diagonal in general.
    pub mass: DenseMatrix,
    /// `W`: the closure of each cell in m, positive when the faces approach; cells by coordinates.
    pub closure: DenseMatrix,
    /// `A`: the area of each cell in m^2.
    pub areas_m2: Vec<f64>,
    /// `f`: static loads of the coordinates.
    pub loads: Vec<f64>,
    /// `R`: responses by coordinates; may have no rows.
    pub responses: DenseMatrix,
}

/// Reads a reduced model from a MATLAB (`.mat`, versions 5 to 7) or NumPy (`.npz`) file with the arrays `K`,
/// `M`, `W`, `area`, and optionally `f` and `R`.
///
/// # Errors
/// [`MatricesError`] names file and array of a wrong shape, of a number that is not finite, of an area
/// that is not positive, and of a matrix that is not symmetric.
pub fn read_reduced(path: &Path) -> Result<ReducedModel, MatricesError> {
    let content = Content::open(path)?;
    reduced(&content.name.clone(), content.bytes()?)
}

impl ReducedModel {
    /// The reduced model of a file in memory. `name` stands for the file in errors.
    ///
    /// # Errors
    /// As [`read_reduced`].
    pub fn of_bytes(name: &str, bytes: &[u8]) -> Result<Self, MatricesError> {
        reduced(name, bytes.to_vec())
    }

    /// Its stiffness and mass as matrices; coordinate `k` is direction 1 of node `k + 1`.
    ///
    /// # Errors
    /// For a model without coordinates.
    pub fn matrices(&self) -> Result<Matrices, MatricesError> {
        let size = self.stiffness.rows();
        let sparse = |matrix: &DenseMatrix| {
            let lower = (0..size).flat_map(|column| (column..size).map(move |row| (row, column)));
            let entries = lower.map(|(row, column)| (row, column, matrix.get(row, column)));
            SparseSymmetric::from_triplets(size, entries.filter(|entry| entry.2 != 0.0))
        };
        let dofs = (1..).take(size).map(|node| Dof::new(node, 1)).collect();
        Matrices::new(sparse(&self.stiffness), sparse(&self.mass), dofs)
    }
}

fn reduced(name: &str, bytes: Vec<u8>) -> Result<ReducedModel, MatricesError> {
    let is_archive = bytes.starts_with(npz::MARK);
    let arrays = if is_archive { npz::read(name, bytes)? } else { matlab::read(name, &bytes)? };
    arrays.reduced()
}
