//! Matrices of Abaqus: `*MATRIX OUTPUT`.
//!
//! `FORMAT=MATRIX INPUT` writes `node,direction, node,direction, value` a line; `FORMAT=COORDINATE` writes
//! `row column value`, which needs a file of rows. A file has one triangle, in the order of the rows of
//! the program or of its own, or both: its content tells. Internal nodes have numbers below 1. Diagonals of
//! 1e36 in the stiffness mark held degrees of freedom.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use crate::calculix::indexed_entries;
use crate::matrices::{assemble, both};
use crate::matrix_market::BANNER;
use crate::sparse::{Entry, Triangles};
use crate::text::{Content, Fields, Lines, found, number, whole};
use crate::{Dof, Matrices, MatricesError};

/// Accepted lines.
const ACCEPTED: &str = "`node,direction, node,direction, value` with directions from 1 to 6";

pub(crate) fn read(
    contents: [Content; 2],
    rows: Option<Vec<Dof>>,
) -> Result<Matrices, MatricesError> {
    let files = both(contents, |content| read_one(content, rows.as_deref()))?;
    let dofs = match rows {
        Some(rows) => rows,
        None => union(&files),
    };
    let index: Index = dofs.iter().enumerate().map(|(row, dof)| (*dof, row as u32)).collect();
    let [stiffness, mass] = files.map(|mut file| {
        // Rows in the order of appearance become rows of both matrices.
        let to: Option<Vec<u32>> = file.dofs.iter().map(|dof| index.get(dof).copied()).collect();
        let Some(to) = to else {
            let unnamed = file.dofs.iter().find(|dof| !index.contains_key(dof));
            let unnamed = unnamed.map(ToString::to_string).unwrap_or_default();
            let what = format!("{}: {unnamed} is not in the file of rows", file.name);
            return Err(MatricesError::inconsistent(
                what,
                "expected every row, or no file of rows",
            ));
        };
        for entry in &mut file.entries {
            (entry.row, entry.column) = (to[entry.row as usize], to[entry.column as usize]);
        }
        Ok(assemble(&file.name, &dofs, file.entries, Triangles::OneOrBoth)?.matrix)
    });
    Matrices::new(stiffness?, mass?, dofs)
}

/// Entries of a file, with rows numbered by `dofs`.
struct File {
    name: String,
    entries: Vec<Entry>,
    dofs: Vec<Dof>,
}

fn read_one(content: Content, rows: Option<&[Dof]>) -> Result<File, MatricesError> {
    let mut lines = Lines::new(content);
    let mut index = Index::default();
    let (mut entries, mut dofs) = (Vec::new(), Vec::new());
    let (mut last, mut last_row) = (None, 0);
    while let Some(line) = lines.next()? {
        if line.starts_with(b"*") || line.trim_ascii().is_empty() {
            continue;
        }
        let Some((row, column, value)) = labelled(line) else {
            let found = found(line);
            if line.starts_with(BANNER) {
                return Err(lines.malformed(
                    found,
                    format!("{ACCEPTED}; this file has the format matrix_market"),
                ));
            }
            if Fields(line).count() != 3 || !entries.is_empty() {
                return Err(lines.malformed(found, ACCEPTED));
            }
            // The format of coordinates, whose rows have numbers only.
            let Some(rows) = rows else {
                let expected = format!(
                    "{ACCEPTED}; for FORMAT=COORDINATE give a file of rows, with `node.direction` a line"
                );
                return Err(lines.malformed(found, expected));
            };
            lines.step_back();
            let entries = indexed_entries(&mut lines, rows.len())?;
            return Ok(File { name: lines.name, entries, dofs: rows.to_vec() });
        };
        let mut row_of = |dof: Dof| {
            *index.entry(dof).or_insert_with(|| {
                dofs.push(dof);
                (dofs.len() - 1) as u32
            })
        };
        if last != Some(row) {
            (last, last_row) = (Some(row), row_of(row));
        }
        let column = if column == row { last_row } else { row_of(column) };
        entries.push(Entry { row: last_row, column, value });
    }
    lines.check_end()?;
    if entries.is_empty() {
        return Err(lines.ends_early("it has no entries"));
    }
    Ok(File { name: lines.name, entries, dofs })
}

/// An entry with the degrees of freedom of row and column.
fn labelled(line: &[u8]) -> Option<(Dof, Dof, f64)> {
    let mut fields = Fields(line);
    let mut dof = || {
        let (node, direction) = (fields.next()?, fields.next()?);
        Dof::of_numbers(whole(node)?, whole(direction)?)
    };
    let (row, column) = (dof()?, dof()?);
    let value = number(fields.next()?)?;
    fields.next().is_none().then_some((row, column, value))
}

/// The rows of both files: those of mesh nodes by node and direction, then internal ones.
fn union(files: &[File; 2]) -> Vec<Dof> {
    let mut dofs: Vec<Dof> = files.iter().flat_map(|file| &file.dofs).copied().collect();
    dofs.sort_unstable_by_key(|dof| (dof.node < 1, dof.node.abs(), dof.direction));
    dofs.dedup();
    dofs
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

#[cfg(test)]
mod tests {
    use super::*;

    const UPPER: &str = "** a comment\n7,1, 7,1,  4.000e+00\n7,1, 7,2, -1.000e+00\n7,2, 7,2,  5.000e+00\n\
                         7,2, 9,3, -2.000e+00\n9,3, 9,3,  6.000e+00\n";

    fn content(name: &str, text: &str) -> Content {
        Content::of_bytes(name, text.as_bytes().to_vec())
    }

    fn read_text(text: &str, rows: Option<Vec<Dof>>) -> Result<Matrices, MatricesError> {
        read(
            [content("K.mtx", text), content("M.mtx", "9,3,9,3,1.0\n7,1,7,1,1.0\n7,2,7,2,1.0\n")],
            rows,
        )
    }

    #[test]
    fn one_triangle_both_and_coordinates_are_the_same_matrices() {
        let upper = read_text(UPPER, None).unwrap();
        assert_eq!(upper.dofs(), [Dof::new(7, 1), Dof::new(7, 2), Dof::new(9, 3)]);
        assert_eq!(upper.stiffness().get(2, 1), -2.0);
        let both = format!("{UPPER}9,3, 7,2, -2.000e+00\n7,2, 7,1, -1.000e+00\n");
        assert_eq!(read_text(&both, None).unwrap(), upper);
        let rows = upper.dofs().to_vec();
        let coordinates = "1 1 4.000D+00\n 1 2 -1.00\n2 2 5.0\n2 3 -2\n3 3 6.\n";
        let mass = content("M.mtx", "1, 1, 1.0\n2, 2, 1.0\n3, 3, 1.0\n");
        let read = read([content("K.mtx", coordinates), mass], Some(rows.clone())).unwrap();
        assert_eq!(read, upper);
        // In another order of rows.
        let reversed: Vec<Dof> = rows.into_iter().rev().collect();
        let read = read_text(UPPER, Some(reversed)).unwrap();
        assert_eq!(read.stiffness().diagonal(), [6.0, 5.0, 4.0]);
    }

    #[test]
    fn internal_nodes_have_rows_of_their_own() {
        let text =
            format!("{UPPER}9,3, -1,1, 0.500e+00\n-1,1, -1,1, 8.000e+00\n0,9, 0,9, 1.000e+00\n");
        let matrices = read_text(&text, None).unwrap();
        assert_eq!(matrices.size(), 5);
        assert_eq!(matrices.dofs()[3..], [Dof::new(0, 9), Dof::new(-1, 1)]);
        assert_eq!(matrices.stiffness().get(2, 4), 0.5);
        assert_eq!(matrices.mass().diagonal(), [1.0, 1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn faults_are_named_with_file_and_line() {
        let cases = [
            (
                "7,2, 7,2,",
                "7,2, 7,7,",
                "K.mtx, line 4: `7,2, 7,7,  5.000e+00`; expected `node,direction,",
            ),
            ("7,2, 7,2,", "7,2, 7,", "K.mtx, line 4: "),
            ("7,2, 7,2,", "7.5,2, 7,2,", "K.mtx, line 4: "),
            (
                "** a comment",
                "%%MatrixMarket matrix",
                "K.mtx, line 1: `%%MatrixMarket matrix`; expected `node,direction, node,direction, value` with directions from 1 to 6; this file has the format matrix_market",
            ),
            ("** a comment", "1 1 2.0", "K.mtx, line 1: `1 1 2.0`; expected"),
            ("6.000e+00\n", "6.00", "K.mtx ends early, at line 6"),
            (
                "9,3, 9,3",
                "9,3, 7,2",
                "K.mtx: the matrix is not symmetric: the entry of row 2 (node 7 direction 2) and column 3",
            ),
        ];
        for (old, new, expected) in cases {
            let error = read_text(&UPPER.replace(old, new), None).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        let error = read_text(UPPER, Some(vec![Dof::new(7, 1), Dof::new(7, 2)])).unwrap_err();
        assert!(error.to_string().contains("node 9 direction 3 is not in the file of rows"));
    }
}
