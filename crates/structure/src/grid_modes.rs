//! Natural frequencies of a discretised structure, by a dense eigensolver.

use std::f64::consts::TAU;

use asperity_mesh::LinearStructure;
use faer::{Mat, Side};

use crate::StructureError;

/// All natural frequencies \[Hz\], lowest first, of `structure` with its contacts
/// replaced by springs of `contact_stiffness` \[Pa/m\] per area.
///
/// Solves `k phi = w^2 M phi` with lumped masses as the symmetric problem of
/// `M^(-1/2) k M^(-1/2)`. The cost grows with the cube of the node count: this
/// is the second method beside the exact [`modes`](crate::PreloadedStructure::modes), and
/// the one for structures that are no chain of bars.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_law::Constant;
/// use asperity_mesh::{Body, Grid, Interface, LinearStructure, Stack, Support};
/// use asperity_structure::grid_frequencies;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
/// let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Constant::new(4.25e11)?))?;
/// let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
/// let structure = LinearStructure::on_grid(&stack, &Grid::new(&stack, 5e-3)?);
/// let lowest = grid_frequencies(&structure, &[4.25e11])?[0];
/// assert!((800.0..900.0).contains(&lowest));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`StructureError::Eigenvalues`] if the eigensolver does not converge.
pub fn grid_frequencies(
    structure: &LinearStructure,
    contact_stiffness: &[f64],
) -> Result<Vec<f64>, StructureError> {
    let size = structure.nodes();
    let mut matrix = Mat::<f64>::zeros(size, size);
    for &(row, column, value) in structure.stiffness() {
        matrix[(row, column)] += value;
    }
    for (contact, stiffness) in structure.contacts().iter().zip(contact_stiffness) {
        let k = stiffness * contact.area;
        matrix[(contact.above, contact.above)] += k;
        if let Some(below) = contact.below {
            matrix[(below, below)] += k;
            matrix[(contact.above, below)] -= k;
            matrix[(below, contact.above)] -= k;
        }
    }
    let root: Vec<f64> = structure.mass().iter().map(|mass| mass.sqrt()).collect();
    let scaled = Mat::from_fn(size, size, |i, j| matrix[(i, j)] / (root[i] * root[j]));
    let squares = scaled
        .self_adjoint_eigenvalues(Side::Lower)
        .map_err(|_| StructureError::Eigenvalues { size })?;
    Ok(squares.into_iter().map(|square| square.max(0.0).sqrt() / TAU).collect())
}
