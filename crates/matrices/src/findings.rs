//! Checks of matrices that were read: properties that a structure without contact has.

use std::fmt;

use crate::sparse::SparseSymmetric;
use crate::{Matrices, Nodes};

/// Something wrong or surprising in matrices, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MatrixFinding {
    /// True if the matrices cannot be those of a structure.
    pub is_fault: bool,
    /// The finding, with rows and numbers.
    pub text: String,
}

impl fmt::Display for MatrixFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Rigid motions of a mesh in its matrices: three translations and three rotations about the centre of the
/// nodes that have rows.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidMotions {
    /// Displacement of every row in each motion: of the degrees of freedom of mesh nodes; zero in internal rows.
    pub motions: [Vec<f64>; 6],
    /// Mass of the motions, `e_i^T M e_j`: in kg, kg m and kg m^2.
    pub mass: [[f64; 6]; 6],
    /// Strain energy of each motion over the energy of its rows one by one, `e^T K e / sum of e_i^2 K_ii`:
    /// about 1e-13 for a free motion, above 1e-6 where the structure is held.
    pub energy_ratio: [f64; 6],
}

impl RigidMotions {
    /// Names of the motions.
    pub const NAMES: [&str; 6] = ["along x", "along y", "along z", "about x", "about y", "about z"];

    /// Largest [`Self::energy_ratio`] of a free motion; rounding of 14 digits is far below.
    pub const FREE: f64 = 1e-9;

    /// Mass in translation along x, y and z in kg. Rows of held nodes are absent, and so is their share.
    pub fn translational_mass(&self) -> [f64; 3] {
        [0, 1, 2].map(|motion| self.mass[motion][motion])
    }

    /// The motions that need no force.
    pub fn free(&self) -> impl Iterator<Item = usize> {
        (0..6).filter(|motion| self.energy_ratio[*motion] < Self::FREE)
    }
}

impl Matrices {
    /// True for each row of a node that the mesh does not have: internal unknowns of elements and constraints,
    /// which are no displacements. Without a mesh, nodes below 1 are internal.
    pub fn internal_rows(&self, mesh: Option<&Nodes>) -> Vec<bool> {
        let is_internal = |node: i64| mesh.map_or(node < 1, |mesh| !mesh.contains(node));
        self.dofs().iter().map(|dof| is_internal(dof.node)).collect()
    }

    /// Loads by gravity in N, `M e` with `e = acceleration` on rows of mesh nodes. No gravity acts on internal
    /// rows, and none is carried over from rows that are absent.
    pub fn gravity_loads(&self, acceleration: [f64; 3], mesh: Option<&Nodes>) -> Vec<f64> {
        let internal = self.internal_rows(mesh);
        let rows = self.dofs().iter().zip(&internal);
        let e: Vec<f64> = rows
            .map(|(dof, internal)| match dof.direction {
                direction @ 1..=3 if !internal => acceleration[usize::from(direction) - 1],
                _ => 0.0,
            })
            .collect();
        let mut loads = self.mass().multiply(&e);
        for (load, _) in loads.iter_mut().zip(internal).filter(|(_, internal)| *internal) {
            *load = 0.0;
        }
        loads
    }

    /// The rigid motions of a mesh.
    pub fn rigid_motions(&self, mesh: &Nodes) -> RigidMotions {
        let places: Vec<Option<[f64; 3]>> =
            self.dofs().iter().map(|dof| mesh.get(dof.node)).collect();
        let mut centre = [0.0; 3];
        let known: Vec<&[f64; 3]> = places.iter().flatten().collect();
        for place in &known {
            for (sum, x) in centre.iter_mut().zip(*place) {
                *sum += x / known.len() as f64;
            }
        }
        let motions: [Vec<f64>; 6] = std::array::from_fn(|motion| {
            let rows = self.dofs().iter().zip(&places);
            rows.map(|(dof, place)| {
                let Some(place) = place else { return 0.0 };
                let Some(direction) = usize::from(dof.direction).checked_sub(1) else { return 0.0 };
                match motion.checked_sub(3) {
                    None => f64::from(u8::from(direction == motion)),
                    Some(axis) if direction >= 3 => f64::from(u8::from(direction - 3 == axis)),
                    Some(axis) => {
                        // The displacement is the axis cross the place.
                        let arm = |index: usize| place[index] - centre[index];
                        match (direction + 3 - axis) % 3 {
                            0 => 0.0,
                            1 => -arm((direction + 1) % 3),
                            _ => arm((direction + 2) % 3),
                        }
                    }
                }
            })
            .collect()
        });
        let diagonal = self.stiffness().diagonal();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut mass = [[0.0; 6]; 6];
        let mut energy_ratio = [0.0; 6];
        for (i, motion) in motions.iter().enumerate() {
            let inertia = self.mass().multiply(motion);
            for (j, other) in motions.iter().enumerate() {
                mass[i][j] = dot(&inertia, other);
            }
            let separate: f64 = motion.iter().zip(&diagonal).map(|(e, k)| e * e * k).sum();
            let energy = dot(&self.stiffness().multiply(motion), motion);
            energy_ratio[i] = if separate > 0.0 { energy.abs() / separate } else { 0.0 };
        }
        RigidMotions { motions, mass, energy_ratio }
    }

    /// Faults and surprises of the matrices: diagonals that are negative, entries larger than the
    /// diagonals of their row and column allow, rows without stiffness or mass, internal rows, nodes without
    /// rows, and mass and restraint of the rigid motions of a mesh.
    pub fn findings(&self, mesh: Option<&Nodes>) -> Vec<MatrixFinding> {
        let mut found = Vec::new();
        if !self.held().is_empty() {
            let count = self.held().len();
            found.push(notice(format!("{count} rows are held by diagonals of 1e36, and removed")));
        }
        self.check_definite("stiffness", self.stiffness(), &mut found);
        self.check_definite("mass", self.mass(), &mut found);
        let without = |matrix: &SparseSymmetric| {
            matrix.diagonal().iter().filter(|diagonal| **diagonal == 0.0).count()
        };
        let (size, massless) = (self.size(), without(self.mass()));
        if massless == size {
            found.push(fault("the mass matrix is zero; expected the mass of the structure".into()));
        } else if massless > 0 {
            found.push(notice(format!("{massless} of {size} rows have no mass")));
        }
        let soft = without(self.stiffness());
        if soft > 0 {
            found.push(notice(format!("{soft} of {size} rows have no stiffness")));
        }
        let internal = self.internal_rows(mesh).iter().filter(|internal| **internal).count();
        if internal == size {
            let text = "no row belongs to a node of the mesh; expected the mesh of the matrices";
            found.push(fault(text.into()));
        } else if internal > 0 {
            found.push(notice(format!(
                "{internal} of {size} rows belong to no node of the mesh: internal unknowns of elements, on which \
                 no gravity acts"
            )));
        }
        if let Some(mesh) = mesh.filter(|_| internal < size) {
            self.check_rigid_motions(mesh, &mut found);
        }
        found
    }

    /// A matrix with a negative diagonal, or with `k_ij^2 > k_ii k_jj`, is indefinite.
    fn check_definite(&self, name: &str, matrix: &SparseSymmetric, found: &mut Vec<MatrixFinding>) {
        const TOLERANCE: f64 = 1e-9;
        let diagonal = matrix.diagonal();
        let largest = diagonal.iter().copied().fold(0.0, f64::max);
        let row_name = |row: usize| format!("{} ({})", row + 1, self.dofs()[row]);
        let negative = diagonal.iter().filter(|value| **value < 0.0).count();
        if let Some(row) = diagonal.iter().position(|value| *value < 0.0) {
            found.push(fault(format!(
                "{negative} diagonals of the {name} are negative, the first {:e} in row {}; expected a matrix \
                 without negative directions (linear elements, no loads in the stiffness, no lumped mass of \
                 quadratic elements)",
                diagonal[row],
                row_name(row)
            )));
            return;
        }
        let excess = matrix.triplets().find(|&(row, column, value)| {
            value * value
                > (1.0 + TOLERANCE) * diagonal[row] * diagonal[column] + (1e-14 * largest).powi(2)
        });
        if let Some((row, column, value)) = excess {
            found.push(fault(format!(
                "the {name} has the entry {value:e} of row {} and column {}, larger than their diagonals {:e} and \
                 {:e} allow; expected a matrix without negative directions",
                row_name(row),
                row_name(column),
                diagonal[row],
                diagonal[column]
            )));
        }
    }

    fn check_rigid_motions(&self, mesh: &Nodes, found: &mut Vec<MatrixFinding>) {
        let with_rows: std::collections::HashSet<i64> =
            self.dofs().iter().map(|dof| dof.node).collect();
        let without = mesh.numbers().filter(|node| !with_rows.contains(node)).count();
        if without > 0 {
            let text = "nodes of the mesh have no rows: they are held, dependent, or in no element";
            found.push(notice(format!("{without} {text}")));
        }
        let rigid = self.rigid_motions(mesh);
        let [x, y, z] = rigid.translational_mass();
        let present = [1, 2, 3].map(|axis| self.dofs().iter().any(|dof| dof.direction == axis));
        let largest = x.max(y).max(z);
        let negligible =
            [x, y, z].iter().zip(present).any(|(mass, there)| there && *mass <= 1e-9 * largest);
        let text = format!("mass in translation along x, y, z: {x:.6e}, {y:.6e}, {z:.6e} kg");
        if largest <= 0.0 || negligible {
            found.push(fault(format!("{text}; expected a positive mass in every direction")));
        } else {
            found.push(notice(text));
        }
        let free: Vec<&str> = rigid.free().map(|motion| RigidMotions::NAMES[motion]).collect();
        let free = if free.is_empty() { "none".to_owned() } else { free.join(", ") };
        found.push(notice(format!("rigid motions of the whole mesh without stiffness: {free}")));
    }
}

fn fault(text: String) -> MatrixFinding {
    MatrixFinding { is_fault: true, text }
}

fn notice(text: String) -> MatrixFinding {
    MatrixFinding { is_fault: false, text }
}
