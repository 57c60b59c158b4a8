//! Matrices of Abaqus: `*MATRIX OUTPUT`.
//!
//! `FORMAT=MATRIX INPUT` writes `node,direction, node,direction, value` a line; `FORMAT=COORDINATE` writes
//! `row column value`, which needs a file of rows. A file has one triangle, in the order of the rows of
//! the program or of its own, or both: its content tells. Internal nodes have numbers below 1. Diagonals of
//! 1e36 in the stiffness mark held degrees of freedom.

use crate::calculix::indexed_entries;
use crate::labelled::{self, LabelledEntries};
use crate::matrices::both;
use crate::matrix_market::BANNER;
use crate::text::{Content, Fields, Lines, found, number, whole};
use crate::{Dof, Matrices, MatricesError};

/// Accepted lines.
const ACCEPTED: &str = "`node,direction, node,direction, value` with directions from 1 to 6";

pub(crate) fn read(
    contents: [Content; 2],
    rows: Option<Vec<Dof>>,
) -> Result<Matrices, MatricesError> {
    let files = both(contents, |content| read_one(content, rows.as_deref()))?;
    labelled::matrices(files, rows)
}

fn read_one(content: Content, rows: Option<&[Dof]>) -> Result<LabelledEntries, MatricesError> {
    let mut lines = Lines::new(content);
    let mut file = LabelledEntries::new(&lines.name);
    while let Some(line) = lines.next()? {
        if line.starts_with(b"*") || line.trim_ascii().is_empty() {
            continue;
        }
        let Some((row, column, value)) = entry_of(line) else {
            let found = found(line);
            if line.starts_with(BANNER) {
                return Err(lines.malformed(
                    found,
                    format!("{ACCEPTED}; this file has the format matrix_market"),
                ));
            }
            if Fields(line).count() != 3 || !file.is_empty() {
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
            return Ok(LabelledEntries::of_rows(&lines.name, entries, rows));
        };
        file.add(row, column, value);
    }
    lines.check_end()?;
    if file.is_empty() {
        return Err(lines.ends_early("it has no entries"));
    }
    Ok(file)
}

/// An entry with the degrees of freedom of row and column.
fn entry_of(line: &[u8]) -> Option<(Dof, Dof, f64)> {
    let mut fields = Fields(line);
    let mut dof = || {
        let (node, direction) = (fields.next()?, fields.next()?);
        Dof::of_numbers(whole(node)?, whole(direction)?)
    };
    let (row, column) = (dof()?, dof()?);
    let value = number(fields.next()?)?;
    fields.next().is_none().then_some((row, column, value))
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
