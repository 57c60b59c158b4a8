//! Stiffness and mass with the degree of freedom of each row.

use std::collections::HashMap;

use crate::Dof;
use crate::error::MatricesError;
use crate::sparse::{Assembled, Entry, EntryFault, MOST_ROWS, SparseSymmetric, Triangles};
use crate::text::Content;

/// Stiffness and mass of a structure without contact, and the degree of freedom of each row.
///
/// Rows of held and of dependent degrees of freedom are absent.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrices {
    stiffness: SparseSymmetric,
    mass: SparseSymmetric,
    dofs: Vec<Dof>,
    index: HashMap<Dof, usize>,
    held: Vec<Dof>,
}

/// Diagonal of the stiffness by which Abaqus marks a held degree of freedom.
const HELD: f64 = 1e36;

impl Matrices {
    /// The matrices of a structure, and the degree of freedom of each of their rows.
    ///
    /// # Errors
    /// If the sizes differ, or a degree of freedom has two rows.
    pub fn new(
        stiffness: SparseSymmetric,
        mass: SparseSymmetric,
        dofs: Vec<Dof>,
    ) -> Result<Self, MatricesError> {
        let sizes = [stiffness.size(), mass.size(), dofs.len()];
        if sizes != [dofs.len(); 3] || dofs.is_empty() {
            let what = format!(
                "the stiffness has {} rows, the mass {}, and {} rows have a degree of freedom",
                sizes[0], sizes[1], sizes[2]
            );
            return Err(MatricesError::inconsistent(what, "expected equal numbers, at least 1"));
        }
        let mut index = HashMap::with_capacity(dofs.len());
        for (row, dof) in dofs.iter().enumerate() {
            if let Some(before) = index.insert(*dof, row) {
                let what = format!("{dof} has the rows {} and {}", before + 1, row + 1);
                return Err(MatricesError::inconsistent(what, "expected one row each"));
            }
        }
        Ok(Self { stiffness, mass, dofs, index, held: Vec::new() })
    }

    /// Number of rows.
    pub fn size(&self) -> usize {
        self.dofs.len()
    }

    /// The stiffness matrix.
    pub fn stiffness(&self) -> &SparseSymmetric {
        &self.stiffness
    }

    /// The mass matrix.
    pub fn mass(&self) -> &SparseSymmetric {
        &self.mass
    }

    /// The degree of freedom of each row.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// The row of a degree of freedom; none if it is held, dependent or not in the mesh.
    pub fn row(&self, dof: Dof) -> Option<usize> {
        self.index.get(&dof).copied()
    }

    /// The row of a degree of freedom.
    ///
    /// # Errors
    /// If there is none; the directions in which the node has rows are listed.
    pub fn require_row(&self, dof: Dof) -> Result<usize, MatricesError> {
        self.row(dof).ok_or_else(|| {
            let of_node = self.dofs.iter().filter(|other| other.node == dof.node);
            let mut directions: Vec<u8> = of_node.map(|other| other.direction).collect();
            directions.sort_unstable();
            let directions: Vec<String> = directions.iter().map(ToString::to_string).collect();
            let remedy = if self.held.contains(&dof) {
                "it is held by a boundary condition".to_owned()
            } else if directions.is_empty() {
                "the node has no rows: it is held, dependent (an equation or a tie), or not in the mesh".to_owned()
            } else {
                format!(
                    "the node has rows in the directions {}; others are held or dependent (an equation or a tie)",
                    directions.join(", ")
                )
            };
            MatricesError::inconsistent(format!("no row of {dof}"), remedy)
        })
    }

    /// Degrees of freedom whose rows were removed, ascending: those that the file marks as held, by diagonals of 1e36 or
    /// more, which Abaqus writes for boundary conditions, and rows of [`Self::hold`].
    pub fn held(&self) -> &[Dof] {
        &self.held
    }

    /// The matrices without the rows of `dofs`, whose displacements are zero. Degrees of freedom that are held already
    /// may be among them.
    ///
    /// # Errors
    /// For a degree of freedom that has no row, and if no row is left.
    ///
    /// ```
    /// use asperity_matrices::{Dof, Matrices, SparseSymmetric};
    ///
    /// let stiffness = SparseSymmetric::from_triplets(2, [(0, 0, 2.0), (0, 1, -1.0), (1, 1, 1.0)]);
    /// let mass = SparseSymmetric::from_triplets(2, [(0, 0, 1.0), (1, 1, 1.0)]);
    /// let dofs = vec![Dof::new(1, 1), Dof::new(2, 1)];
    /// let held = Matrices::new(stiffness, mass, dofs)?.hold(&[Dof::new(1, 1)])?;
    /// assert_eq!(held.stiffness().multiply(&[1.0]), [1.0]);
    /// # Ok::<(), asperity_matrices::MatricesError>(())
    /// ```
    pub fn hold(self, dofs: &[Dof]) -> Result<Self, MatricesError> {
        let mut kept = vec![true; self.size()];
        for dof in dofs {
            if self.held.binary_search(dof).is_err() {
                kept[self.require_row(*dof)?] = false;
            }
        }
        self.restricted(&kept, "no row is left that moves")
    }

    /// The matrices without rows that are marked as held.
    pub(crate) fn without_held(self) -> Result<Self, MatricesError> {
        let kept: Vec<bool> =
            self.stiffness.diagonal().iter().map(|diagonal| *diagonal < 0.999 * HELD).collect();
        self.restricted(&kept, "every row is held, by a diagonal of 1e36")
    }

    fn restricted(self, kept: &[bool], all: &str) -> Result<Self, MatricesError> {
        if kept.iter().all(|kept| *kept) {
            return Ok(self);
        }
        let (mut dofs, mut held) = (Vec::new(), self.held);
        for (dof, kept) in self.dofs.iter().zip(kept) {
            if *kept { dofs.push(*dof) } else { held.push(*dof) }
        }
        held.sort_unstable();
        let [stiffness, mass] = [&self.stiffness, &self.mass].map(|matrix| matrix.restricted(kept));
        if dofs.is_empty() {
            return Err(MatricesError::inconsistent(all, "expected rows that move"));
        }
        Ok(Self { held, ..Self::new(stiffness, mass, dofs)? })
    }

    /// Multiplies entries of stiffness and mass by the two numbers of `factors`, which is given the degrees
    /// of freedom of row and column.
    pub(crate) fn scale(&mut self, factors: impl Fn(Dof, Dof) -> [f64; 2]) {
        let dofs = &self.dofs;
        self.stiffness.scale(|row, column| factors(dofs[row], dofs[column])[0]);
        self.mass.scale(|row, column| factors(dofs[row], dofs[column])[1]);
    }

    /// Stiffness, mass and degrees of freedom.
    pub fn into_parts(self) -> (SparseSymmetric, SparseSymmetric, Vec<Dof>) {
        (self.stiffness, self.mass, self.dofs)
    }
}

/// Stiffness and mass, each read by `read` on a thread of its own.
pub(crate) fn both<T: Send>(
    [stiffness, mass]: [Content; 2],
    read: impl Fn(Content) -> Result<T, MatricesError> + Sync,
) -> Result<[T; 2], MatricesError> {
    std::thread::scope(|scope| {
        let mass = scope.spawn(|| read(mass));
        let stiffness = read(stiffness);
        let mass = mass.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        Ok([stiffness?, mass?])
    })
}

/// The matrix of the entries of a file, with faults in words.
pub(crate) fn assemble(
    file: &str,
    dofs: &[Dof],
    entries: Vec<Entry>,
    triangles: Triangles,
) -> Result<Assembled, MatricesError> {
    if dofs.len() >= MOST_ROWS {
        let what = format!("{file}: {} rows", dofs.len());
        return Err(MatricesError::inconsistent(what, format!("expected less than {MOST_ROWS}")));
    }
    let name = |row: usize| format!("{} ({})", row + 1, dofs[row]);
    let file = file.to_owned();
    SparseSymmetric::assemble(dofs.len(), entries, triangles).map_err(|fault| match fault {
        EntryFault::Twice { row, column } => {
            MatricesError::Twice { file, row: name(row), column: name(column) }
        }
        EntryFault::Asymmetric { row, column, value, partner } => {
            let partner =
                partner.map_or("is not given".to_owned(), |value| format!("is {value:e}"));
            MatricesError::Asymmetric { file, row: name(row), column: name(column), value, partner }
        }
    })
}
