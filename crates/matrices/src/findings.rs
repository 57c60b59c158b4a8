//! Checks of matrices that were read: properties that a structure without contact has.

use std::fmt;

use crate::sparse::SparseSymmetric;
use crate::{Matrices, Nodes, RigidMotions};

/// Most parts whose rigid motions are listed.
const MOST_PARTS: usize = 10;

/// Something wrong or surprising in matrices, in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MatrixFinding {
    /// True if no structure can have the matrices.
    pub is_fault: bool,
    /// The finding, with rows and numbers.
    pub text: String,
}

impl fmt::Display for MatrixFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
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

    /// Faults and surprises of the matrices: diagonals that are negative, entries larger than the
    /// diagonals of their row and column allow, rows without stiffness or mass, internal rows, nodes without
    /// rows, the extent of the mesh, and for each part of it the mass and the rigid motions without stiffness.
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
                 {:e} allow; expected a matrix without negative directions (no Lagrange multipliers of constraints or \
                 of hybrid elements)",
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
        self.extent(mesh, found);
        let parts = self.parts(mesh);
        let several = parts.len() > 1;
        for (index, part) in parts.iter().enumerate().take(MOST_PARTS) {
            let rigid = self.rigid_motions(mesh, Some(part));
            let [x, y, z] = rigid.translational_mass();
            let name = if several {
                let nodes = part
                    .iter()
                    .map(|row| self.dofs()[*row].node)
                    .filter(|node| mesh.contains(*node));
                let (first, last) =
                    nodes.fold((i64::MAX, i64::MIN), |(a, b), node| (a.min(node), b.max(node)));
                format!("part {} of {} (nodes {first} to {last}): ", index + 1, parts.len())
            } else {
                String::new()
            };
            let moves =
                [1, 2, 3].map(|axis| part.iter().any(|row| self.dofs()[*row].direction == axis));
            let largest = x.max(y).max(z);
            let negligible =
                [x, y, z].iter().zip(moves).any(|(mass, moves)| moves && *mass <= 1e-9 * largest);
            let text =
                format!("{name}mass in translation along x, y, z: {x:.6e}, {y:.6e}, {z:.6e} kg");
            if largest <= 0.0 || negligible {
                found.push(fault(format!("{text}; expected a positive mass in every direction")));
            } else {
                found.push(notice(text));
            }
            let axes: Vec<&str> = rigid.free_axes().map(|axis| RigidMotions::NAMES[axis]).collect();
            let count = rigid.free_count();
            let axes = match axes.len() {
                0 => String::new(),
                listed if listed == count => format!(": {}", axes.join(", ")),
                _ => format!(", among them {}", axes.join(", ")),
            };
            found.push(notice(format!("{name}{count} rigid motions without stiffness{axes}")));
        }
        if parts.len() > MOST_PARTS {
            let count = parts.len();
            found.push(notice(format!(
                "{count} parts are not connected; the first {MOST_PARTS} are listed"
            )));
        }
    }

    /// Extent of the nodes that have rows, which tells metres from millimetres.
    fn extent(&self, mesh: &Nodes, found: &mut Vec<MatrixFinding>) {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for place in self.dofs().iter().filter_map(|dof| mesh.get(dof.node)) {
            for axis in 0..3 {
                low[axis] = low[axis].min(place[axis]);
                high[axis] = high[axis].max(place[axis]);
            }
        }
        let [x, y, z] = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        found.push(notice(format!("extent along x, y, z: {x:.6}, {y:.6}, {z:.6} m")));
    }
}

fn fault(text: String) -> MatrixFinding {
    MatrixFinding { is_fault: true, text }
}

fn notice(text: String) -> MatrixFinding {
    MatrixFinding { is_fault: false, text }
}
