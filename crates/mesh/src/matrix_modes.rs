//! Component modes of mass and stiffness matrices.

use faer::{Mat, MatRef, Side};

use crate::{ComponentModes, MeshError, NormalMode, PortPair, ResidualFlexibility};

/// Squared frequency over the largest, per degree of freedom, up to which a mode counts as rigid:
/// a hundred roundings of the eigenvalues.
const RIGID: f64 = 100.0 * f64::EPSILON;

impl ComponentModes {
    /// The free-interface modes of `M u'' + K u = f`: the `count` lowest, and the rigid ones at
    /// least, with the residual flexibility of all others.
    ///
    /// `stiffness` K \[N/m\] and `mass` M \[kg\] are symmetric, of one size, without the contacts;
    /// their lower triangles are read. K may be singular. Each port is a list of degrees of freedom and
    /// their weights: one entry for the displacement at a point, for the mean over a face one for each
    /// degree of freedom of it, with weights that add up to one. Every mode is computed, so the cost
    /// grows with the cube of the size. Mass-proportional damping acts on all modes.
    ///
    /// ```
    /// use asperity_mesh::{ComponentModes, PortPair};
    /// use faer::mat;
    ///
    /// // Two masses of 1 kg joined by a spring of 200 N/m, the lower on a contact.
    /// let stiffness = mat![[200.0, -200.0], [-200.0, 200.0]];
    /// let mass = mat![[1.0, 0.0], [0.0, 1.0]];
    /// let ports = [vec![(0, 1.0)], vec![(1, 1.0)]];
    /// let contacts = vec![PortPair::on_ground(1)];
    /// let (k, m) = (stiffness.as_ref(), mass.as_ref());
    /// let modes = ComponentModes::from_matrices((k, m), &ports, contacts, 2)?;
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
        (stiffness, mass): (MatRef<'_, f64>, MatRef<'_, f64>),
        ports: &[Vec<(usize, f64)>],
        contacts: Vec<PortPair>,
        count: usize,
    ) -> Result<Self, MeshError> {
        let size = mass.nrows();
        let of_size = |matrix: MatRef<'_, f64>| matrix.nrows() == size && matrix.ncols() == size;
        if size == 0 || !of_size(mass) || !of_size(stiffness) {
            let problem = "not square or not of the size of the other";
            return Err(MeshError::Matrix { matrix: "mass or stiffness", problem });
        }
        if let Some(&(dof, _)) = ports.iter().flatten().find(|(dof, _)| *dof >= size) {
            return Err(MeshError::DegreeOfFreedom { dof, size });
        }
        let (squares, shapes) = eigen(stiffness, mass)?;
        let largest = squares.iter().copied().fold(0.0, f64::max);
        let rigid = RIGID * size as f64 * largest;
        if squares[0] < -rigid {
            let problem = "not positive semidefinite";
            return Err(MeshError::Matrix { matrix: "stiffness", problem });
        }
        let mut residual = ResidualFlexibility::zero(ports.len());
        let mut kept = Vec::new();
        for (number, &square) in squares.iter().enumerate() {
            let along = |port: &Vec<(usize, f64)>| -> f64 {
                port.iter().map(|&(dof, weight)| weight * shapes[(dof, number)]).sum()
            };
            let frequency = if square <= rigid { 0.0 } else { square.sqrt() };
            let mode = NormalMode::elastic(frequency, ports.iter().map(along).collect());
            if number < count || frequency == 0.0 {
                kept.push(mode);
            } else {
                residual.add(&mode);
            }
        }
        Self::new(kept, residual, contacts, Vec::new())
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
