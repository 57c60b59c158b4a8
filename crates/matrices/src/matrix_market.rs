//! Matrix Market exchange format.
//!
//! Source: R. F. Boisvert, R. Pozo, K. A. Remington, "The Matrix Market Exchange Formats: Initial Design",
//! NISTIR 5935, 1996. `coordinate real` and `coordinate integer`, `symmetric` (one triangle) and `general`.

use crate::calculix::indexed_entries;
use crate::matrices::{assemble, both};
use crate::sparse::{SparseSymmetric, Triangles};
use crate::text::{Content, Fields, Lines, found, whole};
use crate::{Dof, Matrices, MatricesError};

/// Start of a file.
pub(crate) const BANNER: &[u8] = b"%%MatrixMarket";

pub(crate) fn read(contents: [Content; 2], dofs: Vec<Dof>) -> Result<Matrices, MatricesError> {
    let [stiffness, mass] = both(contents, |content| read_one(content, &dofs))?;
    Matrices::new(stiffness, mass, dofs)
}

fn read_one(content: Content, dofs: &[Dof]) -> Result<SparseSymmetric, MatricesError> {
    let mut lines = Lines::new(content);
    let triangles = banner(&mut lines)?;
    let announced = size_line(&mut lines, dofs.len())?;
    let entries = indexed_entries(&mut lines, dofs.len())?;
    if entries.len() as u64 != announced {
        let count = entries.len();
        if (count as u64) < announced {
            let missing = format!("{count} entries of {announced}, the number in the size line");
            return Err(lines.ends_early(missing));
        }
        let expected = format!("{announced}, the number in the size line");
        return Err(lines.malformed(format!("{count} entries"), expected));
    }
    Ok(assemble(&lines.name, dofs, entries, triangles)?.matrix)
}

/// The first line.
fn banner(lines: &mut Lines) -> Result<Triangles, MatricesError> {
    const ACCEPTED: &str = "`%%MatrixMarket matrix coordinate real symmetric` (or `general`)";
    let line = lines.next()?.unwrap_or_default();
    let words: Vec<String> =
        Fields(line).map(|word| String::from_utf8_lossy(word).to_lowercase()).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let triangles = match words[..] {
        ["%%matrixmarket", "matrix", "coordinate", "real" | "integer", symmetry] => {
            match symmetry {
                "symmetric" => Some(Triangles::One),
                "general" => Some(Triangles::OneOrBoth),
                _ => None,
            }
        }
        _ => None,
    };
    if let Some(triangles) = triangles {
        return Ok(triangles);
    }
    let (found, known) = (found(line), line.starts_with(BANNER));
    let hint = "; a file of Abaqus, which ends in .mtx too, has the format abaqus";
    Err(lines.malformed(found, format!("{ACCEPTED}{}", if known { "" } else { hint })))
}

/// The number of entries, after the comments.
fn size_line(lines: &mut Lines, size: usize) -> Result<u64, MatricesError> {
    let numbers: Option<Vec<i64>> = loop {
        let Some(line) = lines.next()? else {
            return Err(lines.ends_early("no size line"));
        };
        if !line.starts_with(b"%") && !line.trim_ascii().is_empty() {
            break Fields(line).map(whole).collect();
        }
    };
    match numbers.as_deref() {
        Some(&[rows, columns, entries])
            if usize::try_from(rows) == Ok(size) && columns == rows && entries >= 0 =>
        {
            Ok(entries as u64)
        }
        Some(&[rows, columns, _]) => {
            let found = format!("{rows} rows and {columns} columns");
            Err(lines.malformed(found, format!("{size} of each, as the file of rows names")))
        }
        _ => Err(lines.malformed("no sizes", "`rows columns entries`")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<SparseSymmetric, MatricesError> {
        let dofs = [Dof::new(1, 1), Dof::new(2, 1)];
        read_one(Content::of_bytes("k.mtx", text.as_bytes().to_vec()), &dofs)
    }

    const SYMMETRIC: &str = "%%MatrixMarket matrix coordinate real symmetric\n% comment\n\n2 2 3\n1 1 2\n2 1 -1.5\n2 2 3\n";
    const GENERAL: &str =
        "%%MatrixMarket MATRIX Coordinate Real General\n2 2 4\n1 1 2\n1 2 -1.5\n2 1 -1.5\n2 2 3\n";

    #[test]
    fn symmetric_and_general_are_the_same_matrix() {
        let symmetric = read_text(SYMMETRIC).unwrap();
        assert_eq!(symmetric.get(0, 1), -1.5);
        assert_eq!(read_text(GENERAL).unwrap(), symmetric);
        assert_eq!(read_text(&SYMMETRIC.replace("2 1 -1.5", "1 2 -1.5")).unwrap(), symmetric);
    }

    #[test]
    fn faults_are_named_with_file_and_line() {
        let cases = [
            (SYMMETRIC, "%%Matrix", "%Matrix", "k.mtx, line 1: `%MatrixMarket matrix coordinate"),
            (
                SYMMETRIC,
                "real",
                "complex",
                "k.mtx, line 1: `%%MatrixMarket matrix coordinate complex",
            ),
            (SYMMETRIC, "coordinate", "array", "k.mtx, line 1: "),
            (
                SYMMETRIC,
                "2 2 3\n1",
                "3 3 3\n1",
                "k.mtx, line 4: 3 rows and 3 columns; expected 2 of each",
            ),
            (SYMMETRIC, "2 2 3\n1", "2 2 4\n1", "k.mtx ends early, at line 7: 3 entries of 4"),
            (SYMMETRIC, "2 2 3\n1", "2 2 2\n1", "k.mtx, line 7: 3 entries; expected 2"),
            (SYMMETRIC, "2 2 3\n1", "2 2\n1", "k.mtx, line 4: no sizes"),
            (SYMMETRIC, "2 2 3\n1", "2 2 99999999999999\n1", "k.mtx ends early, at line 7"),
            (
                GENERAL,
                "2 1 -1.5",
                "2 1 -1.4",
                "k.mtx: the matrix is not symmetric: the entry of row 1 (node 1 direction 1) and column 2",
            ),
        ];
        for (text, old, new, expected) in cases {
            let error = read_text(&text.replace(old, new)).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        let error = read_text("5,1, 5,1,  2.0e+00\n").unwrap_err().to_string();
        assert!(error.contains("has the format abaqus"), "{error}");
    }
}
