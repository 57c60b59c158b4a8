//! Matrices of Nastran: DMIG entries of a punch file or of bulk data.
//!
//! Source: MSC Nastran, "Quick Reference Guide", bulk data entry DMIG. A header `DMIG, name, 0, form, type` is
//! followed by columns `DMIG, name, node, direction, , node, direction, value`, in small fields of 8, large fields
//! of 16 characters, or free fields with commas. Fields are fixed columns: numbers may touch. Scalar
//! points, the modal coordinates of a reduced model, have the direction 0.

use crate::error::Place;
use crate::labelled::{self, LabelledEntries};
use crate::text::{Content, Lines, found, number, whole};
use crate::{Dof, Matrices, MatricesError};

/// Stiffness and mass; of one file if there is none of the mass.
pub(crate) fn read(
    stiffness: Content,
    mass: Option<Content>,
    rows: Option<Vec<Dof>>,
) -> Result<Matrices, MatricesError> {
    let name = stiffness.name.clone();
    let mut first = read_all(stiffness)?;
    let stiffness = take(&name, &mut first, 'K')?;
    let mass = match mass {
        None => take(&name, &mut first, 'M')?,
        Some(mass) => take(&mass.name.clone(), &mut read_all(mass)?, 'M')?,
    };
    labelled::matrices([stiffness, mass], rows)
}

/// A matrix of a file.
struct Dmig {
    name: String,
    entries: LabelledEntries,
}

/// The matrix whose name starts with `letter`, or the only one.
fn take(
    file: &str,
    matrices: &mut Vec<Dmig>,
    letter: char,
) -> Result<LabelledEntries, MatricesError> {
    let with: Vec<usize> =
        (0..matrices.len()).filter(|index| matrices[*index].name.starts_with(letter)).collect();
    let index = match (with.as_slice(), matrices.len()) {
        (&[index], _) => index,
        ([], 1) => 0,
        _ => {
            let names: Vec<&str> = matrices.iter().map(|matrix| matrix.name.as_str()).collect();
            let what = match names.join(", ") {
                names if names.is_empty() => format!("{file}: no matrix (DMIG)"),
                names => format!("{file}: the matrices {names}"),
            };
            let remedy = format!(
                "expected one whose name starts with {letter}, such as {letter}AAX, or one alone"
            );
            return Err(MatricesError::inconsistent(what, remedy));
        }
    };
    Ok(matrices.swap_remove(index).entries)
}

fn read_all(content: Content) -> Result<Vec<Dmig>, MatricesError> {
    const ACCEPTED: &str =
        "`DMIG` with name, node, direction, and entries of node, direction, value";
    let mut lines = Lines::new(content);
    let mut matrices: Vec<Dmig> = Vec::new();
    // The column that is being read: its matrix and degree of freedom.
    let mut open: Option<(usize, Dof)> = None;
    while let Some(line) = lines.next()? {
        if line.starts_with(b"$") || line.trim_ascii().is_empty() {
            continue;
        }
        let Some(fields) = fields(line) else {
            if line.starts_with(b"DMIG") || line.starts_with(b"*") {
                let found = found(line);
                return Err(lines.malformed(found, "ASCII characters"));
            }
            // A title or another entry.
            open = None;
            continue;
        };
        let continues = fields[0].is_empty() || fields[0].starts_with(['+', '*']);
        let groups = if continues {
            if open.is_some() { &fields[1..] } else { continue }
        } else if fields[0].trim_end_matches('*').trim_end().eq_ignore_ascii_case("DMIG") {
            let field = |index: usize| fields.get(index).map_or("", String::as_str);
            let name = field(1).to_uppercase();
            let position = matrices.iter().position(|matrix| matrix.name == name);
            if field(2) == "0" {
                let (form, kind) = (field(3), field(4));
                let fault = match (form, kind) {
                    _ if name.is_empty() || position.is_some() => Some("a new name of the matrix"),
                    ("1" | "6", "1" | "2") => None,
                    _ => Some(
                        "a square or symmetric matrix (form 1 or 6) of real numbers (type 1 or 2)",
                    ),
                };
                if let Some(expected) = fault {
                    let found = found(line);
                    return Err(lines.malformed(found, expected));
                }
                let entries = LabelledEntries::new(&format!("{}, matrix {name}", lines.name));
                matrices.push(Dmig { name, entries });
                open = None;
                continue;
            }
            let column = dof(field(2), field(3));
            let (Some(position), Some(column)) = (position, column) else {
                let found = found(line);
                return Err(
                    lines.malformed(found, format!("{ACCEPTED}, after a header of the matrix"))
                );
            };
            open = Some((position, column));
            fields.get(5..).unwrap_or_default()
        } else {
            // Another entry of the bulk data.
            open = None;
            continue;
        };
        for group in groups.chunks(4) {
            let [node, direction, value, ..] = group else { continue };
            if node.is_empty() && direction.is_empty() && value.is_empty() {
                continue;
            }
            let (Some((matrix, column)), Some(row), Some(value)) =
                (open, dof(node, direction), real(value))
            else {
                let found = found(line);
                return Err(lines.malformed(found, ACCEPTED));
            };
            matrices[matrix].entries.add(row, column, value);
        }
    }
    if let Some(empty) = matrices.iter().find(|matrix| matrix.entries.is_empty()) {
        let (file, place) = (lines.name.clone(), Place::Line(lines.line));
        let missing = format!("the matrix {} has no entries", empty.name);
        return Err(MatricesError::EndsEarly { file, place, missing });
    }
    Ok(matrices)
}

/// The fields of a line, the first with the name of the entry or the mark of a continuation.
fn fields(line: &[u8]) -> Option<Vec<String>> {
    let text = std::str::from_utf8(line).ok().filter(|text| text.is_ascii())?.trim_end();
    if text.contains(',') {
        return Some(text.split(',').map(|field| field.trim().to_owned()).collect());
    }
    let first = &text[..text.len().min(8)];
    let width = if first.contains('*') { 16 } else { 8 };
    // The last ten columns are the name of the continuation.
    let rest = text.get(8..text.len().min(72)).unwrap_or_default();
    let rest =
        (0..rest.len()).step_by(width).map(|start| &rest[start..rest.len().min(start + width)]);
    Some(std::iter::once(first).chain(rest).map(|field| field.trim().to_owned()).collect())
}

/// A node and a direction; the direction of a scalar point is 0 or blank.
fn dof(node: &str, direction: &str) -> Option<Dof> {
    let node = whole(node.as_bytes()).filter(|node| *node > 0)?;
    match direction {
        "" | "0" => Some(Dof::new(node, 0)),
        _ => Dof::of_numbers(node, whole(direction.as_bytes())?),
    }
}

/// A real number of Nastran: `1.5`, `1.5E+3`, `1.5D+3`, `1.5 D+3` or `1.5+3`.
fn real(field: &str) -> Option<f64> {
    let text: String = field.chars().filter(|c| !c.is_whitespace()).collect();
    let has_exponent = text.contains(['e', 'E', 'd', 'D']);
    let sign = text.get(1..).and_then(|rest| rest.find(['+', '-'])).filter(|_| !has_exponent);
    match sign {
        Some(at) => number(format!("{}e{}", &text[..=at], &text[at + 1..]).as_bytes()),
        None => number(text.as_bytes()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The punch of a program: large fields that touch, a scalar point, both matrices, and other entries.
    const PUNCH: &str = "\
$ TITLE = Zylinder für Prüfung
BEGIN BULK
DMIG    KAAX           0       6       2       0                       3
DMIG*   KAAX                          21               2
*                     21               2 4.000000000D+00
*                     22               2-1.000000000D+00
DMIG*   KAAX                          22               2
*                     22               2 5.000000000D+00
DMIG*   KAAX                         101               0
*                    101               0 9.000000000D+08
GRID          21       0      0.      0.      0.
+             99      99
DMIG    MAAX           0       6       2       0                       3
DMIG*   MAAX                          21               2
*                     21               2 1.000000000D+00
DMIG*   MAAX                          22               2
*                     22               2 1.500000000D+00
*                    101               0 2.5 D-01
DMIG*   MAAX                         101               0
*                    101               0 1.000000000D+00
ENDDATA
";

    fn read_text(stiffness: &str, mass: Option<&str>) -> Result<Matrices, MatricesError> {
        let content = |name, text: &str| Content::of_bytes(name, text.as_bytes().to_vec());
        read(content("k.pch", stiffness), mass.map(|mass| content("m.pch", mass)), None)
    }

    #[test]
    fn a_punch_file_has_both_matrices() {
        let matrices = read_text(PUNCH, None).unwrap();
        assert_eq!(matrices.dofs(), [Dof::new(21, 2), Dof::new(22, 2), Dof::new(101, 0)]);
        let stiffness: Vec<_> = matrices.stiffness().triplets().collect();
        assert_eq!(stiffness, [(0, 0, 4.0), (1, 0, -1.0), (1, 1, 5.0), (2, 2, 9e8)]);
        assert_eq!(matrices.mass().get(2, 1), 0.25);
    }

    #[test]
    fn small_and_free_fields_are_the_same() {
        let small = "\
DMIG    STIF    0       6       1
DMIG    STIF    21      2               21      2       4.
+       22      2       -1.0
DMIG    STIF    22      2               22      2       5.+0
DMIG    STIF    101                     101             9.+8
";
        let free = "DMIG,STIF,0,1,1\nDMIG,STIF,21,2,,21,2,4.\n,22,2,-1.\nDMIG,STIF,22,2,,22,2,5.\n,21,2,-1.\n\
                    DMIG,STIF,101,,,101,,9.0E+08\n";
        let expected = read_text(PUNCH, None).unwrap();
        for text in [small, free] {
            assert_eq!(read_text(text, Some(PUNCH)).unwrap(), expected);
        }
    }

    #[test]
    fn faults_are_named_with_file_and_line() {
        let cases = [
            (
                "DMIG    KAAX           0       6       2",
                "DMIG    KAAX           0       6       4",
                "k.pch, line 3: ",
            ),
            (
                "DMIG    KAAX           0       6       2",
                "DMIG    KAAX           0       9       2",
                "k.pch, line 3: ",
            ),
            (
                "DMIG    KAAX           0       6",
                "DMIG    KBBX           0       6",
                "k.pch, line 4: ",
            ),
            ("2 4.000000000D+00", "2 4.00000000xD+00", "k.pch, line 5: "),
            ("2-1.000000000D+00", "8-1.000000000D+00", "k.pch, line 6: "),
            ("DMIG    MAAX           0", "DMIG    KAAX           0", "k.pch, line 13: "),
        ];
        for (old, new, expected) in cases {
            let error = read_text(&PUNCH.replacen(old, new, 1), None).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
        let error = read_text("$ nothing\n", None).unwrap_err().to_string();
        assert_eq!(
            error,
            "k.pch: no matrix (DMIG); expected one whose name starts with K, such as KAAX, or one alone"
        );
        let both = PUNCH.replace("MAAX", "K2GG");
        let error = read_text(&both, None).unwrap_err().to_string();
        assert!(error.starts_with("k.pch: the matrices KAAX, K2GG; expected one"), "{error}");
    }
}
