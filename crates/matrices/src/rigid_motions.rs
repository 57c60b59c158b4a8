//! Rigid motions of a mesh, or of a part of it, in its matrices.

use std::collections::HashMap;

use crate::{Matrices, Nodes};

/// Three translations, and three rotations about the centre of the nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidMotions {
    /// Displacement `e_i` of every row in each motion: of the degrees of freedom of mesh nodes; zero in internal
    /// rows and in other parts.
    pub motions: [Vec<f64>; 6],
    /// `e_i^T M e_j`: in kg, kg m and kg m^2.
    pub mass: Gram,
    /// `e_i^T K e_j`: in N/m, N and N m. Zero up to rounding for a motion without stiffness.
    pub stiffness: Gram,
    /// `e_i^T diag(K) e_j`, the stiffness of the rows one by one, against which [`Self::stiffness`] is small or not.
    pub row_stiffness: Gram,
}

/// A symmetric matrix of the six motions.
type Gram = [[f64; 6]; 6];

impl RigidMotions {
    /// Names of the motions.
    pub const NAMES: [&str; 6] = ["along x", "along y", "along z", "about x", "about y", "about z"];

    /// Largest stiffness of a motion without stiffness, as a ratio to the stiffness of its rows one by one.
    /// Rounding to 14 digits gives about 1e-15; a structure that is held at a few nodes is above 1e-6.
    pub const FREE: f64 = 1e-12;

    /// Mass in translation along x, y and z in kg. Rows of held nodes are absent, and so is their share.
    pub fn translational_mass(&self) -> [f64; 3] {
        [0, 1, 2].map(|motion| self.mass[motion][motion])
    }

    /// Number of independent rigid motions without stiffness, in any direction and about any axis.
    pub fn free_count(&self) -> usize {
        // Motions that move no row, such as turning a single node, are in both.
        let still = nullity(&self.row_stiffness, &self.row_stiffness);
        nullity(&self.stiffness, &self.row_stiffness).saturating_sub(still)
    }

    /// The motions along and about the axes that have no stiffness.
    pub fn free_axes(&self) -> impl Iterator<Item = usize> {
        (0..6).filter(|&motion| {
            let rows = self.row_stiffness[motion][motion];
            rows > 0.0 && self.stiffness[motion][motion].abs() < Self::FREE * rows
        })
    }
}

impl Matrices {
    /// The rows of each part of the structure: rows are connected by entries of the stiffness, and by nodes. Parts
    /// without a mesh node are left out. Contact, springs and dampers are no part of the stiffness.
    pub fn parts(&self, mesh: &Nodes) -> Vec<Vec<usize>> {
        let mut parent: Vec<usize> = (0..self.size()).collect();
        let mut join = |a: usize, b: usize| {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b)] = a.min(b);
        };
        for (row, column, _) in self.stiffness().triplets() {
            join(row, column);
        }
        let mut first_of = HashMap::new();
        for (row, dof) in self.dofs().iter().enumerate() {
            join(*first_of.entry(dof.node).or_insert(row), row);
        }
        let mut index = HashMap::new();
        let mut parts: Vec<Vec<usize>> = Vec::new();
        for row in 0..self.size() {
            let part = *index.entry(root(&mut parent, row)).or_insert_with(|| {
                parts.push(Vec::new());
                parts.len() - 1
            });
            parts[part].push(row);
        }
        parts.retain(|rows| rows.iter().any(|row| mesh.contains(self.dofs()[*row].node)));
        parts
    }

    /// The rigid motions of a mesh, or of the part of it with the rows `part`.
    ///
    /// # Panics
    /// If a row of `part` is not below the size.
    pub fn rigid_motions(&self, mesh: &Nodes, part: Option<&[usize]>) -> RigidMotions {
        let rows = part.map_or_else(|| (0..self.size()).collect(), <[usize]>::to_vec);
        let places: Vec<(usize, [f64; 3])> =
            rows.iter().filter_map(|row| Some((*row, mesh.get(self.dofs()[*row].node)?))).collect();
        let count = places.len() as f64;
        let centre =
            [0, 1, 2].map(|x| places.iter().map(|(_, place)| place[x]).sum::<f64>() / count);
        let motions: [Vec<f64>; 6] = std::array::from_fn(|motion| {
            let mut displacement = vec![0.0; self.size()];
            for (row, place) in &places {
                let arm = [0, 1, 2].map(|x| place[x] - centre[x]);
                displacement[*row] = displacement_of(motion, self.dofs()[*row].direction, arm);
            }
            displacement
        });
        let diagonal = self.stiffness().diagonal();
        let gram = |multiply: &dyn Fn(&[f64]) -> Vec<f64>| -> Gram {
            motions.each_ref().map(|motion| {
                let product = multiply(motion);
                motions.each_ref().map(|other| other.iter().zip(&product).map(|(a, b)| a * b).sum())
            })
        };
        let by_rows = |x: &[f64]| x.iter().zip(&diagonal).map(|(x, k)| x * k).collect();
        let mass = gram(&|x| self.mass().multiply(x));
        let stiffness = gram(&|x| self.stiffness().multiply(x));
        let row_stiffness = gram(&by_rows);
        RigidMotions { motions, mass, stiffness, row_stiffness }
    }
}

/// The row that stands for the part of `row`.
fn root(parent: &mut [usize], mut row: usize) -> usize {
    while parent[row] != row {
        parent[row] = parent[parent[row]];
        row = parent[row];
    }
    row
}

/// Displacement or rotation in `direction` of a point at `arm` from the centre.
fn displacement_of(motion: usize, direction: u8, arm: [f64; 3]) -> f64 {
    let unit = |equal: bool| f64::from(u8::from(equal));
    match (motion.checked_sub(3), usize::from(direction)) {
        (None, direction) => unit(direction == motion + 1),
        (Some(axis), 1..=3) => {
            // The axis cross the arm.
            let direction = usize::from(direction) - 1;
            match (direction + 3 - axis) % 3 {
                1 => -arm[(direction + 1) % 3],
                2 => arm[(direction + 2) % 3],
                _ => 0.0,
            }
        }
        (Some(axis), direction) => unit(direction == axis + 4),
    }
}

/// Number of eigenvalues of `matrix` below [`RigidMotions::FREE`], scaled by the diagonal of `scale`.
fn nullity(matrix: &Gram, scale: &Gram) -> usize {
    let factor: [f64; 6] =
        std::array::from_fn(|i| if scale[i][i] > 0.0 { 1.0 / scale[i][i].sqrt() } else { 0.0 });
    let scaled =
        std::array::from_fn(|i| std::array::from_fn(|j| factor[i] * matrix[i][j] * factor[j]));
    eigenvalues(scaled).iter().filter(|value| value.abs() < RigidMotions::FREE).count()
}

/// Eigenvalues of a symmetric matrix by Jacobi's rotations.
fn eigenvalues(mut a: Gram) -> [f64; 6] {
    const SWEEPS: usize = 30;
    for _ in 0..SWEEPS {
        for p in 0..6 {
            for q in p + 1..6 {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                let (of_p, of_q) = (a[p], a[q]);
                a[p] = std::array::from_fn(|k| c * of_p[k] - s * of_q[k]);
                a[q] = std::array::from_fn(|k| s * of_p[k] + c * of_q[k]);
            }
        }
    }
    std::array::from_fn(|i| a[i][i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_of_a_projection() {
        // The projection on the first axis, and on the direction (1, 1, 1, 1) of the last four.
        let mut matrix = [[0.0; 6]; 6];
        matrix[0][0] = 1.0;
        for row in &mut matrix[2..] {
            row[2..].fill(0.25);
        }
        let mut values = eigenvalues(matrix);
        values.sort_unstable_by(f64::total_cmp);
        for (value, expected) in values.iter().zip([0.0, 0.0, 0.0, 0.0, 1.0, 1.0]) {
            assert!((value - expected).abs() < 1e-15, "{values:?}");
        }
    }
}
