//! Entries whose rows and columns are named by degrees of freedom.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use crate::matrices::assemble;
use crate::sparse::{Entry, Triangles};
use crate::{Dof, Matrices, MatricesError};

/// Entries of a matrix, with rows numbered in the order of appearance.
pub(crate) struct LabelledEntries {
    name: String,
    entries: Vec<Entry>,
    dofs: Vec<Dof>,
    index: Index,
    /// The row of the last entry and its number.
    last: Option<(Dof, u32)>,
}

impl LabelledEntries {
    /// No entries yet; `name` stands for the matrix in errors.
    pub(crate) fn new(name: &str) -> Self {
        let index = Index::default();
        Self { name: name.to_owned(), entries: Vec::new(), dofs: Vec::new(), index, last: None }
    }

    /// Entries with rows numbered by `dofs`.
    pub(crate) fn of_rows(name: &str, entries: Vec<Entry>, dofs: &[Dof]) -> Self {
        Self { entries, dofs: dofs.to_vec(), ..Self::new(name) }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    pub(crate) fn add(&mut self, row: Dof, column: Dof, value: f64) {
        let known = self.last.filter(|(dof, _)| *dof == row);
        let number = known.map_or_else(|| self.number(row), |(_, number)| number);
        self.last = Some((row, number));
        let column = if column == row { number } else { self.number(column) };
        self.entries.push(Entry { row: number, column, value });
    }

    fn number(&mut self, dof: Dof) -> u32 {
        let dofs = &mut self.dofs;
        *self.index.entry(dof).or_insert_with(|| {
            dofs.push(dof);
            (dofs.len() - 1) as u32
        })
    }
}

/// Stiffness and mass of their entries. Rows are `rows`, or those of both matrices: of mesh nodes by node
/// and direction, then internal ones.
pub(crate) fn matrices(
    files: [LabelledEntries; 2],
    rows: Option<Vec<Dof>>,
) -> Result<Matrices, MatricesError> {
    let dofs = rows.unwrap_or_else(|| {
        let mut dofs: Vec<Dof> = files.iter().flat_map(|file| &file.dofs).copied().collect();
        dofs.sort_unstable_by_key(|dof| (dof.node < 1, dof.node.abs(), dof.direction));
        dofs.dedup();
        dofs
    });
    let index: Index = dofs.iter().enumerate().map(|(row, dof)| (*dof, row as u32)).collect();
    let [stiffness, mass] = files.map(|mut file| {
        let to: Option<Vec<u32>> = file.dofs.iter().map(|dof| index.get(dof).copied()).collect();
        let Some(to) = to else {
            let unnamed = file.dofs.iter().find(|dof| !index.contains_key(dof));
            let unnamed = unnamed.map(ToString::to_string).unwrap_or_default();
            let what = format!("{}: {unnamed} is not in the file of rows", file.name);
            let remedy = "expected every row, or no file of rows";
            return Err(MatricesError::inconsistent(what, remedy));
        };
        for entry in &mut file.entries {
            (entry.row, entry.column) = (to[entry.row as usize], to[entry.column as usize]);
        }
        Ok(assemble(&file.name, &dofs, file.entries, Triangles::OneOrBoth)?.matrix)
    });
    Matrices::new(stiffness?, mass?, dofs)
}

type Index = HashMap<Dof, u32, BuildHasherDefault<Multiplicative>>;

/// Hash of numbers by multiplication, for maps with millions of look-ups.
#[derive(Default)]
struct Multiplicative(u64);

impl Hasher for Multiplicative {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.write_i64(i64::from(*byte));
        }
    }

    fn write_u8(&mut self, value: u8) {
        self.write_i64(i64::from(value));
    }

    fn write_i64(&mut self, value: i64) {
        self.0 = (self.0.rotate_left(5) ^ value as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}
