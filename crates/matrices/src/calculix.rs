//! Matrices of CalculiX: `*FREQUENCY, SOLVER=MATRIXSTORAGE`.
//!
//! Each line of `.sti` and `.mas` is `row column value`; rows count from 1. One triangle is written, with
//! every diagonal, and zeros where the other matrix has entries. There is no header, so that a missing
//! diagonal is the sign of a file that ends early.

use crate::matrices::{assemble, both};
use crate::sparse::{Entry, SparseSymmetric, Triangles};
use crate::text::{Content, Fields, Lines, found, number, whole};
use crate::{Dof, Matrices, MatricesError};

pub(crate) fn read(contents: [Content; 2], dofs: Vec<Dof>) -> Result<Matrices, MatricesError> {
    let [stiffness, mass] = both(contents, |content| read_one(content, &dofs))?;
    Matrices::new(stiffness, mass, dofs)
}

fn read_one(content: Content, dofs: &[Dof]) -> Result<SparseSymmetric, MatricesError> {
    let mut lines = Lines::new(content);
    let entries = indexed_entries(&mut lines, dofs.len())?;
    let assembled = assemble(&lines.name, dofs, entries, Triangles::One)?;
    if let Some(row) = assembled.without_diagonal {
        let missing = format!(
            "row {} of {} ({}) has no entry on the diagonal; is the file whole, and is the file of rows its own?",
            row + 1,
            dofs.len(),
            dofs[row]
        );
        return Err(lines.ends_early(missing));
    }
    Ok(assembled.matrix)
}

/// The remaining entries `row column value` of a text, of a matrix of `size` rows.
pub(crate) fn indexed_entries(lines: &mut Lines, size: usize) -> Result<Vec<Entry>, MatricesError> {
    let mut entries = Vec::new();
    while let Some(line) = lines.next()? {
        match entry_of(line, size) {
            Ok(entry) => entries.push(entry),
            Err(_) if line.trim_ascii().is_empty() => {}
            Err(expected) => {
                let found = found(line);
                return Err(lines.malformed(found, expected(size)));
            }
        }
    }
    lines.check_end()?;
    Ok(entries)
}

/// The entry of a line, or the content accepted in a matrix of some size.
fn entry_of(line: &[u8], size: usize) -> Result<Entry, fn(usize) -> String> {
    let mut fields = Fields(line);
    let mut index = || fields.next().and_then(whole);
    let (row, column) = (index(), index());
    let value = fields.next().and_then(number);
    let (Some(row), Some(column), Some(value), None) = (row, column, value, fields.next()) else {
        return Err(|_| "`row column value`".to_owned());
    };
    let within =
        |index: i64| u32::try_from(index - 1).ok().filter(|index| (*index as usize) < size);
    let (Some(row), Some(column)) = (within(row), within(column)) else {
        return Err(|size| format!("rows and columns from 1 to {size}, the number of rows named"));
    };
    Ok(Entry { row, column, value })
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIFFNESS: &str =
        "1 1  4.0e+00\n1 2 -1.0e+00\n2 2  5.0e+00\n2 3 -2.0e+00\n3 3  6.0e+00\n";

    fn read_text(stiffness: &str) -> Result<Matrices, MatricesError> {
        let mass = "1 1  1.0e+00\n1 2  0.0e+00\n2 2  1.0e+00\n2 3  0.0e+00\n3 3  1.0e+00\n";
        let content = |name, text: &str| Content::of_bytes(name, text.as_bytes().to_vec());
        let dofs = vec![Dof::new(7, 1), Dof::new(7, 2), Dof::new(9, 3)];
        read([content("a.sti", stiffness), content("a.mas", mass)], dofs)
    }

    #[test]
    fn the_upper_triangle_is_read_and_zeros_are_dropped() {
        let matrices = read_text(STIFFNESS).unwrap();
        let stiffness: Vec<_> = matrices.stiffness().triplets().collect();
        let expected = [(0, 0, 4.0), (1, 0, -1.0), (1, 1, 5.0), (2, 1, -2.0), (2, 2, 6.0)];
        assert_eq!(stiffness, expected);
        assert_eq!(matrices.mass().stored(), 3);
        assert_eq!(matrices.row(Dof::new(9, 3)), Some(2));
        assert_eq!(matrices.row(Dof::new(9, 1)), None);
    }

    #[test]
    fn faults_are_named_with_file_and_line() {
        let cases = [
            (
                "2 2  5.0e+00",
                "2 4  5.0e+00",
                "a.sti, line 3: `2 4  5.0e+00`; expected rows and columns from 1 to 3",
            ),
            (
                "2 2  5.0e+00",
                "0 2  5.0e+00",
                "a.sti, line 3: `0 2  5.0e+00`; expected rows and columns from 1 to 3",
            ),
            ("2 2  5.0e+00", "2 2", "a.sti, line 3: `2 2`; expected `row column value`"),
            (
                "2 2  5.0e+00",
                "2 2  *******",
                "a.sti, line 3: `2 2  *******`; expected `row column value`",
            ),
            ("2 2  5.0e+00", "2 2  NaN", "a.sti, line 3: `2 2  NaN`; expected `row column value`"),
            (
                "2 2  5.0e+00",
                "2 2  1.0 2.0",
                "a.sti, line 3: `2 2  1.0 2.0`; expected `row column value`",
            ),
            (
                "3 3  6.0e+00\n",
                "",
                "a.sti ends early, at line 4: row 3 of 3 (node 9 direction 3) has no entry",
            ),
            ("6.0e+00\n", "6.0", "a.sti ends early, at line 5: the last line is shorter"),
            (
                "2 2  5.0e+00",
                "1 2  5.0e+00",
                "a.sti: the entry of row 2 (node 7 direction 2) and column 1 (node 7 direction 1) is given twice",
            ),
            (
                "2 2  5.0e+00",
                "2 2  5.0e+00\n2 1 -1.0e+00",
                "a.sti: the entry of row 2 (node 7 direction 2) and column 1",
            ),
        ];
        for (old, new, expected) in cases {
            let error = read_text(&STIFFNESS.replace(old, new)).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
