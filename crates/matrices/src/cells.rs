//! Cells of contact patches, and nodal forces, from CSV.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use crate::text::{Content, Fields, Lines, found, number, whole};
use crate::{Dof, MatricesError};

/// A cell of a contact patch: an area with one closure and one pressure.
///
/// Its closure is `d = sum of weight u(dof)`, positive when the faces approach. A pressure `p` on the cell
/// is the force `-weight area p` on each of the degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactCell {
    /// Its name in the file, most often a number.
    pub name: String,
    /// Area in m^2.
    pub area_m2: f64,
    /// Weights of degrees of freedom in the closure.
    pub weights: Vec<CellWeight>,
}

/// The weight of a degree of freedom in the closure of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellWeight {
    /// The body, where there are several.
    pub body: Option<String>,
    /// The degree of freedom.
    pub dof: Dof,
    /// The weight: dimensionless for a displacement, in m for a rotation.
    pub weight: f64,
}

/// A force on a degree of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalForce {
    /// The body, where there are several.
    pub body: Option<String>,
    /// The degree of freedom.
    pub dof: Dof,
    /// The force in N; the moment in N m for a rotation.
    pub force_n: f64,
}

/// Reads cells from CSV with the columns `cell,area_m2,node,direction,weight` and optionally `body`, one
/// weight a row. Cells are in the order of their first rows.
///
/// # Errors
/// [`MatricesError`] names file and line of a missing column, of a text that is no number, of an area that is
/// not positive or differs within a cell, and of a degree of freedom that a cell has twice.
///
/// ```
/// use asperity_matrices::{Dof, read_cells};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("cells.csv");
/// std::fs::write(&path, "cell,area_m2,node,direction,weight\n0,1e-4,5,3,-1\n0,1e-4,164,3,1\n")?;
/// let cells = read_cells(&path)?;
/// assert_eq!((cells[0].area_m2, cells[0].weights[1].dof), (1e-4, Dof::new(164, 3)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_cells(path: &Path) -> Result<Vec<ContactCell>, MatricesError> {
    cells(Content::open(path)?)
}

/// Reads forces from CSV with the columns `node,direction,force_n` and optionally `body`, or from the lines
/// `node,direction,force` after `*CLOAD`, as Abaqus writes them with `*MATRIX OUTPUT, LOAD`; forces are then in N
/// too. Forces on one degree of freedom add up.
///
/// # Errors
/// [`MatricesError`] names file and line of a missing column and of a text that is no number.
pub fn read_loads(path: &Path) -> Result<Vec<NodalForce>, MatricesError> {
    loads(Content::open(path)?)
}

fn cells(content: Content) -> Result<Vec<ContactCell>, MatricesError> {
    let columns = ["cell", "area_m2", "node", "direction", "weight", "body"];
    let mut rows = Rows::new(Lines::new(content), &columns)?;
    let mut cells: Vec<ContactCell> = Vec::new();
    let mut index: HashMap<String, usize> = HashMap::new();
    let mut seen = HashSet::new();
    while rows.next()? {
        let (name, area_m2) = (rows.text("cell"), rows.number("area_m2")?);
        if name.is_empty() {
            return Err(rows.wrong("cell", "the number or the name of a cell"));
        }
        if area_m2 <= 0.0 {
            return Err(rows.wrong("area_m2", "a positive area"));
        }
        let weight =
            CellWeight { body: rows.body()?, dof: rows.dof()?, weight: rows.number("weight")? };
        let cell = *index.entry(name.clone()).or_insert_with(|| {
            cells.push(ContactCell { name: name.clone(), area_m2, weights: Vec::new() });
            cells.len() - 1
        });
        if cells[cell].area_m2 != area_m2 {
            let expected = format!("{}, as in the row before of cell {name}", cells[cell].area_m2);
            return Err(rows.wrong("area_m2", &expected));
        }
        if !seen.insert((cell, weight.body.clone(), weight.dof)) {
            let found = format!("cell {name} has {} twice", weight.dof);
            return Err(rows.lines.malformed(found, "one weight for each degree of freedom"));
        }
        cells[cell].weights.push(weight);
    }
    if cells.is_empty() {
        return Err(rows.lines.ends_early("it has no cells"));
    }
    for cell in &cells {
        if cell.weights.iter().all(|weight| weight.weight == 0.0) {
            let what = format!("{}: every weight of cell {} is zero", rows.lines.name, cell.name);
            return Err(MatricesError::inconsistent(what, "expected weights of a closure"));
        }
    }
    Ok(cells)
}

fn loads(content: Content) -> Result<Vec<NodalForce>, MatricesError> {
    let mut lines = Lines::new(content);
    if lines.next()?.is_some_and(|line| line.starts_with(b"*")) {
        lines.step_back();
        return concentrated(lines);
    }
    lines.step_back();
    let mut rows = Rows::new(lines, &["node", "direction", "force_n", "body"])?;
    let mut loads = Vec::new();
    while rows.next()? {
        loads.push(NodalForce {
            body: rows.body()?,
            dof: rows.dof()?,
            force_n: rows.number("force_n")?,
        });
    }
    Ok(loads)
}

/// Forces after `*CLOAD`.
fn concentrated(mut lines: Lines) -> Result<Vec<NodalForce>, MatricesError> {
    const ACCEPTED: &str = "`node,direction,force` with the number of a node, after *CLOAD";
    let (mut loads, mut within) = (Vec::new(), false);
    while let Some(line) = lines.next()? {
        if line.starts_with(b"**") || line.trim_ascii().is_empty() {
            continue;
        }
        if line.starts_with(b"*") {
            let keyword = line.split(|byte| *byte == b',').next().unwrap_or_default();
            // The imaginary part of a load has no meaning at rest.
            let imaginary = line.to_ascii_uppercase().windows(9).any(|word| word == b"IMAGINARY");
            within = keyword.trim_ascii().eq_ignore_ascii_case(b"*CLOAD") && !imaginary;
            if !within {
                let found = found(line);
                return Err(lines.malformed(found, "*CLOAD with real forces"));
            }
            continue;
        }
        let mut fields = Fields(line);
        let dof = fields.next().and_then(whole).zip(fields.next().and_then(whole));
        let dof = dof.and_then(|(node, direction)| Dof::of_numbers(node, direction));
        let force = fields.next().and_then(number);
        let (Some(dof), Some(force_n), None, true) = (dof, force, fields.next(), within) else {
            let found = found(line);
            return Err(lines.malformed(found, ACCEPTED));
        };
        loads.push(NodalForce { body: None, dof, force_n });
    }
    Ok(loads)
}

/// Rows of a CSV file with named columns.
struct Rows {
    lines: Lines,
    /// Columns in the order of the file.
    columns: Vec<String>,
    fields: Vec<String>,
}

impl Rows {
    /// Reads the header. All of `accepted` are needed, except the last, `body`.
    fn new(mut lines: Lines, accepted: &[&str]) -> Result<Self, MatricesError> {
        let Some(line) = lines.next()? else { return Err(lines.ends_early("it is empty")) };
        let columns = fields(line.strip_prefix("\u{feff}".as_bytes()).unwrap_or(line));
        let known = columns.iter().all(|column| accepted.contains(&column.as_str()));
        let distinct = columns.iter().collect::<HashSet<_>>().len() == columns.len();
        let needed = &accepted[..accepted.len() - 1];
        if !known
            || !distinct
            || needed.iter().any(|name| columns.iter().all(|column| column != name))
        {
            let found = found(line);
            let expected = format!("the columns {}, and perhaps body", needed.join(","));
            return Err(lines.malformed(found, expected));
        }
        Ok(Self { lines, columns, fields: Vec::new() })
    }

    /// Goes to the next row; false at the end.
    fn next(&mut self) -> Result<bool, MatricesError> {
        while let Some(line) = self.lines.next()? {
            if line.trim_ascii().is_empty() {
                continue;
            }
            self.fields = fields(line);
            if self.fields.len() != self.columns.len() {
                let found = found(line);
                let expected = format!("{} fields, as in the header", self.columns.len());
                return Err(self.lines.malformed(found, expected));
            }
            return Ok(true);
        }
        Ok(false)
    }

    fn text(&self, column: &str) -> String {
        let index = self.columns.iter().position(|name| name == column);
        index.map(|index| self.fields[index].clone()).unwrap_or_default()
    }

    fn wrong(&self, column: &str, expected: &str) -> MatricesError {
        let found = format!("{column} is `{}`", self.text(column).escape_debug());
        self.lines.malformed(found, expected)
    }

    fn number(&self, column: &str) -> Result<f64, MatricesError> {
        let value = number(self.text(column).as_bytes());
        value.ok_or_else(|| self.wrong(column, "a number"))
    }

    fn dof(&self) -> Result<Dof, MatricesError> {
        let whole = |column: &str, expected: &str| {
            whole(self.text(column).as_bytes()).ok_or_else(|| self.wrong(column, expected))
        };
        let (node, direction) =
            (whole("node", "the number of a node")?, whole("direction", DIRECTIONS)?);
        Dof::of_numbers(node, direction).ok_or_else(|| self.wrong("direction", DIRECTIONS))
    }

    fn body(&self) -> Result<Option<String>, MatricesError> {
        if !self.columns.iter().any(|column| column == "body") {
            return Ok(None);
        }
        let body = self.text("body");
        if body.is_empty() { Err(self.wrong("body", "the name of a body")) } else { Ok(Some(body)) }
    }
}

const DIRECTIONS: &str = "a direction from 1 to 6";

fn fields(line: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(line);
    text.split(',').map(|field| field.trim().trim_matches('"').to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(text: &str) -> Content {
        Content::of_bytes("c.csv", text.as_bytes().to_vec())
    }

    const CELLS: &str =
        "cell,area_m2,node,direction,weight\n0,1e-4,5,3,-0.25\n0,1e-4,6,3,1.25\n1,2e-4,6,3,1\n";

    #[test]
    fn cells_are_gathered_from_rows() {
        let read = cells(content(CELLS)).unwrap();
        let areas: Vec<f64> = read.iter().map(|cell| cell.area_m2).collect();
        assert_eq!(areas, [1e-4, 2e-4]);
        let expected = CellWeight { body: None, dof: Dof::new(6, 3), weight: 1.25 };
        assert_eq!(read[0].weights[1], expected);
        let text = "\u{feff}body,weight,direction,node,area_m2,cell\r\nupper,-1,3,6,1e-4,a\r\nlower,1,3,6,1e-4,a\r\n";
        let read = cells(content(text)).unwrap();
        assert_eq!(read[0].weights[0].body.as_deref(), Some("upper"));
        assert_eq!(read[0].weights.len(), 2);
    }

    #[test]
    fn faults_of_cells_are_named_with_file_and_line() {
        let cases = [
            (
                ",weight\n",
                ",wait\n",
                "c.csv, line 1: `cell,area_m2,node,direction,wait`; expected the columns cell,area_m2,node,direction,weight, and perhaps body",
            ),
            ("1e-4,6", "0,6", "c.csv, line 3: area_m2 is `0`; expected a positive area"),
            ("1e-4,6", "2e-4,6", "c.csv, line 3: area_m2 is `2e-4`; expected 0.0001"),
            ("6,3,1.25", "5,3,1.25", "c.csv, line 3: cell 0 has node 5 direction 3 twice"),
            (
                "6,3,1.25",
                "6,9,1.25",
                "c.csv, line 3: direction is `9`; expected a direction from 1 to 6",
            ),
            ("6,3,1.25", "6.3,1.25", "c.csv, line 3: `0,1e-4,6.3,1.25`; expected 5 fields"),
            ("6,3,1.25", "6.5,3,1.25", "c.csv, line 3: node is `6.5`"),
            ("1.25", "x", "c.csv, line 3: weight is `x`; expected a number"),
            ("1,2e-4,6,3,1\n", "1,2e-4,6,3,0\n", "c.csv: every weight of cell 1 is zero"),
        ];
        for (old, new, expected) in cases {
            let error = cells(content(&CELLS.replace(old, new))).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn loads_are_forces_on_degrees_of_freedom() {
        let read = loads(content("node,direction,force_n\n164,3,-2.5\n164,3,1\n")).unwrap();
        assert_eq!(read[0], NodalForce { body: None, dof: Dof::new(164, 3), force_n: -2.5 });
        assert_eq!(read.len(), 2);
        let text = "** Assembled nodal loads\n*CLOAD, REAL\n2,3,  5.4e+04\n-2,5, -9.0D+03\n";
        let read = loads(content(text)).unwrap();
        assert_eq!(read[1], NodalForce { body: None, dof: Dof::new(-2, 5), force_n: -9e3 });
        for (old, new, line) in [
            ("2,3,", "TOP,3,", 3),
            ("REAL", "IMAGINARY", 2),
            ("*CLOAD", "*DLOAD", 2),
            ("2,3,", "2,7,", 3),
        ] {
            let error = loads(content(&text.replacen(old, new, 1))).unwrap_err().to_string();
            assert!(error.starts_with(&format!("c.csv, line {line}: ")), "{error}");
        }
        let error = loads(content("")).unwrap_err().to_string();
        assert_eq!(error, "c.csv ends early, at line 0: it is empty");
        let error = loads(content("node,direction\n1,3\n")).unwrap_err().to_string();
        assert!(error.contains("expected the columns node,direction,force_n"), "{error}");
    }
}
