//! Component modes of mass and stiffness matrices.

use faer::{Mat, MatRef, Side};

use crate::{ComponentModes, MeshError, NormalMode, ResidualFlexibility};

/// Linear combinations of degrees of freedom by which a structure is driven, observed and touched.
///
/// Each is a list of a degree of freedom and its weight. A displacement at a point has one entry;
/// the mean over a face has one for each of its degrees of freedom, with weights that add up to one;
/// the closure of a contact pair is the mean over its upper face less that over its lower face, or
/// the upper face alone on an immovable support. Forces act through the same weights.
#[derive(Debug, Clone, PartialEq)]
pub struct InterfaceDofs {
    /// Displacement of the driving point.
    pub drive: Vec<(usize, f64)>,
    /// Displacement observed.
    pub output: Vec<(usize, f64)>,
    /// Closure of each contact pair.
    pub closures: Vec<Vec<(usize, f64)>>,
}

/// Squared frequency over the largest, per degree of freedom, up to which a mode counts as rigid:
/// a hundred roundings of the eigenvalues.
const RIGID: f64 = 100.0 * f64::EPSILON;

impl ComponentModes {
    /// The free-interface modes of `M u'' + K u = f`: the `count` lowest, and the rigid ones at
    /// least, with the residual flexibility of all others.
    ///
    /// `stiffness` K \[N/m\] and `mass` M \[kg\] are symmetric, of one size, without the contacts;
    /// their lower triangles are read. K may be singular. Every mode is computed, so the cost grows
    /// with the cube of the size. Mass-proportional damping acts on all modes.
    ///
    /// ```
    /// use asperity_mesh::{ComponentModes, InterfaceDofs};
    /// use faer::mat;
    ///
    /// // Two masses of 1 kg joined by a spring of 200 N/m, the lower on a contact.
    /// let stiffness = mat![[200.0, -200.0], [-200.0, 200.0]];
    /// let mass = mat![[1.0, 0.0], [0.0, 1.0]];
    /// let dofs = InterfaceDofs {
    ///     drive: vec![(0, 1.0)],
    ///     output: vec![(0, 1.0)],
    ///     closures: vec![vec![(1, 1.0)]],
    /// };
    /// let modes = ComponentModes::from_matrices(stiffness.as_ref(), mass.as_ref(), &dofs, 2)?;
    /// assert_eq!(modes.modes()[0].angular_frequency, 0.0);
    /// assert!((modes.modes()[1].angular_frequency - 20.0).abs() < 1e-9);
    /// # Ok::<(), asperity_mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError::Matrix`] for matrices that are not of one size, a mass matrix that is not
    /// positive definite, a stiffness matrix with a negative eigenvalue, or eigenvalues that do not
    /// converge; [`MeshError::DegreeOfFreedom`] for one beyond the size.
    pub fn from_matrices(
        stiffness: MatRef<'_, f64>,
        mass: MatRef<'_, f64>,
        dofs: &InterfaceDofs,
        count: usize,
    ) -> Result<Self, MeshError> {
        let size = mass.nrows();
        let of_size = |matrix: MatRef<'_, f64>| matrix.nrows() == size && matrix.ncols() == size;
        if size == 0 || !of_size(mass) || !of_size(stiffness) {
            let problem = "not square or not of the size of the other";
            return Err(MeshError::Matrix { matrix: "mass or stiffness", problem });
        }
        let all = dofs.closures.iter().chain([&dofs.drive, &dofs.output]).flatten();
        if let Some(&(dof, _)) = all.clone().find(|(dof, _)| *dof >= size) {
            return Err(MeshError::DegreeOfFreedom { dof, size });
        }
        let (squares, shapes) = eigen(stiffness, mass)?;
        let largest = squares.iter().copied().fold(0.0, f64::max);
        let rigid = RIGID * size as f64 * largest;
        if squares[0] < -rigid {
            let problem = "not positive semidefinite";
            return Err(MeshError::Matrix { matrix: "stiffness", problem });
        }
        let mut residual = ResidualFlexibility::zero(dofs.closures.len());
        let mut kept = Vec::new();
        for (number, &square) in squares.iter().enumerate() {
            let along = |combination: &[(usize, f64)]| -> f64 {
                combination.iter().map(|&(dof, weight)| weight * shapes[(dof, number)]).sum()
            };
            let frequency = if square <= rigid { 0.0 } else { square.sqrt() };
            let closure = dofs.closures.iter().map(|closure| along(closure)).collect();
            let mut mode = NormalMode::elastic(frequency, along(&dofs.drive), closure);
            mode.output = along(&dofs.output);
            if number < count || frequency == 0.0 {
                kept.push(mode);
            } else {
                residual.add(&mode);
            }
        }
        Self::new(kept, residual)
    }
}

/// Squared angular frequencies, lowest first, and mass-normalised shapes by columns: those of
/// `M^(-1/2) K M^(-1/2)`.
fn eigen(
    stiffness: MatRef<'_, f64>,
    mass: MatRef<'_, f64>,
) -> Result<(Vec<f64>, Mat<f64>), MeshError> {
    let failed = |matrix| MeshError::Matrix { matrix, problem: "without converging eigenvalues" };
    let of_mass = mass.self_adjoint_eigen(Side::Lower).map_err(|_| failed("mass"))?;
    let (axes, masses) = (of_mass.U(), of_mass.S().column_vector());
    let size = mass.nrows();
    if (0..size).any(|i| masses[i].is_nan() || masses[i] <= 0.0) {
        return Err(MeshError::Matrix { matrix: "mass", problem: "not positive definite" });
    }
    let scaled = Mat::from_fn(size, size, |i, j| axes[(i, j)] / masses[j].sqrt());
    let root = &scaled * axes.transpose();
    let symmetric = Mat::from_fn(size, size, |i, j| stiffness[(i.max(j), i.min(j))]);
    let problem = &root * &symmetric * &root;
    let found = problem.self_adjoint_eigen(Side::Lower).map_err(|_| failed("stiffness"))?;
    let squares = found.S().column_vector();
    Ok(((0..size).map(|i| squares[i]).collect(), &root * found.U()))
}
