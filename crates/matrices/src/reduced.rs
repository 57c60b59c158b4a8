//! Reduced models: dense matrices with the closure rows of contact cells.

use std::path::Path;

use crate::text::Content;
use crate::{DenseMatrix, MatricesError, matlab, npz};

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
    let npz = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npz"));
    let content = Content::open(path)?;
    let arrays = if npz { npz::read(content)? } else { matlab::read(content)? };
    arrays.reduced()
}
