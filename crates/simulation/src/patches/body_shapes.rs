//! Shapes of the modes kept of a body at its rows.

use asperity_matrices::Dof;
use faer::Mat;

/// Shapes of the modes kept of a body at its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyShapes {
    /// The degree of freedom of each row.
    pub dofs: Vec<Dof>,
    /// Shapes \[kg^-1/2\]: rows by modes.
    pub shapes: Mat<f64>,
}
