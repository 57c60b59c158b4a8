//! The files of the matrices of a structure, read in each format.

use std::collections::HashMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::error::{MatricesError, Place};
use crate::text::{Content, Fields, Lines};
use crate::{Dof, Matrices, abaqus, calculix, matlab, matrix_market, nastran, npz};

/// Format of files of matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MatricesFormat {
    /// `row column value` a line, one triangle, and `node.direction` a line for the rows.
    Calculix,
    /// `node,direction, node,direction, value` a line, or `row column value` with a file of rows.
    Abaqus,
    /// `%%MatrixMarket matrix coordinate real symmetric` or `general`, with a file of rows.
    MatrixMarket,
    /// `DMIG` entries, in one file for both matrices or one for each.
    Nastran,
    /// Variables `K`, `M` and `dof` (rows of node and direction) of one file.
    Matlab,
    /// Arrays `K`, `M` and `dof`, or `stiffness`, `mass` and `coordinate`, of one file.
    Npz,
}

/// Files of the matrices of a structure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MatrixFiles {
    /// Their format.
    pub format: MatricesFormat,
    /// The file of the stiffness; of everything, for MATLAB and NumPy, and for Nastran if it has both.
    pub stiffness: PathBuf,
    /// The file of the mass; none if the other has it.
    pub mass: Option<PathBuf>,
    /// The file with the node and the direction of each row. Needed for CalculiX, Matrix Market, and
    /// Abaqus with `FORMAT=COORDINATE`; without it, rows of Abaqus and Nastran are in ascending order.
    pub rows: Option<PathBuf>,
}

impl MatricesFormat {
    /// All formats.
    pub const ALL: [Self; 6] =
        [Self::Calculix, Self::Abaqus, Self::MatrixMarket, Self::Nastran, Self::Matlab, Self::Npz];

    /// The format of a file of the stiffness, by its first lines: files that end in `.mtx` are of Matrix Market
    /// or of Abaqus. A file of lines `row column value` is taken as of CalculiX; Abaqus with
    /// `FORMAT=COORDINATE` has the same lines.
    ///
    /// # Errors
    /// If the file cannot be read or is of no known format.
    pub fn detect(path: &Path) -> Result<Self, MatricesError> {
        let content = Content::open(path)?;
        let name = content.name.clone();
        let start = content.start(1 << 12)?;
        if start.starts_with(npz::MARK) {
            return Ok(Self::Npz);
        }
        if start.len() >= 128 && matches!(&start[126..128], b"IM" | b"MI") {
            return Ok(Self::Matlab);
        }
        if start.starts_with(matrix_market::BANNER) {
            return Ok(Self::MatrixMarket);
        }
        let lines = start.split(|byte| *byte == b'\n');
        if lines.clone().any(|line| line.starts_with(b"DMIG")) {
            return Ok(Self::Nastran);
        }
        let first =
            lines.filter(|line| !line.starts_with(b"**")).find(|line| Fields(line).count() > 0);
        match first.map(|line| Fields(line).count()) {
            Some(3) => Ok(Self::Calculix),
            Some(5) => Ok(Self::Abaqus),
            _ => {
                let found = first.map_or("an empty file".to_owned(), crate::text::found);
                let expected = "the start of a matrix of CalculiX, Abaqus, Matrix Market, Nastran, MATLAB or NumPy";
                Err(MatricesError::malformed(&name, Place::Line(1), found, expected))
            }
        }
    }

    /// Its name in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::Calculix => "calculix",
            Self::Abaqus => "abaqus",
            Self::MatrixMarket => "matrix_market",
            Self::Nastran => "nastran",
            Self::Matlab => "matlab",
            Self::Npz => "npz",
        }
    }
}

impl fmt::Display for MatricesFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for MatricesFormat {
    type Err = MatricesError;

    fn from_str(name: &str) -> Result<Self, MatricesError> {
        Self::ALL.into_iter().find(|format| format.name() == name).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            let what = format!("the format of matrices is \"{name}\"");
            MatricesError::inconsistent(what, format!("expected one of {names}"))
        })
    }
}

/// Reads the matrices of a structure. Files may be compressed by gzip.
///
/// # Errors
/// [`MatricesError`] names file and line of content that is not of the format, of rows out of range, of
/// entries that are given twice or are not symmetric, and of files that end early.
///
/// ```no_run
/// use asperity_matrices::{MatricesFormat, MatrixFiles, MatrixUnits, read};
///
/// let mut matrices = read(&MatrixFiles {
///     format: MatricesFormat::Abaqus,
///     stiffness: "lap_STIF1.mtx".into(),
///     mass: Some("lap_MASS1.mtx".into()),
///     rows: None,
/// })?;
/// matrices.convert(MatrixUnits::new(1e-3, 1e3, 1.0)?); // mm, t, s
/// for finding in matrices.findings(None) {
///     println!("{finding}");
/// }
/// # Ok::<(), asperity_matrices::MatricesError>(())
/// ```
pub fn read(files: &MatrixFiles) -> Result<Matrices, MatricesError> {
    let open = |path: &Option<PathBuf>| path.as_deref().map(Content::open).transpose();
    let (mass, rows) = (open(&files.mass)?, open(&files.rows)?);
    contents(files.format, Content::open(&files.stiffness)?, mass, rows)
}

/// Reads the matrices of a structure from files in memory, which errors call stiffness, mass and rows.
///
/// # Errors
/// As [`read()`].
///
/// Two masses and two springs:
/// ```
/// use asperity_matrices::{Dof, MatricesFormat, read_bytes};
///
/// let stiffness = b"1 1 2.0\n1 2 -1.0\n2 2 1.0\n";
/// let mass = b"1 1 0.5\n1 2 0.0\n2 2 0.5\n";
/// let rows = b"12.3\n14.3\n"; // nodes 12 and 14, both along z
/// let matrices = read_bytes(MatricesFormat::Calculix, stiffness, Some(mass), Some(rows))?;
/// assert_eq!(matrices.row(Dof::new(14, 3)), Some(1));
/// assert_eq!(matrices.stiffness().multiply(&[1.0, 1.0]), [1.0, 0.0]);
/// # Ok::<(), asperity_matrices::MatricesError>(())
/// ```
pub fn read_bytes(
    format: MatricesFormat,
    stiffness: &[u8],
    mass: Option<&[u8]>,
    rows: Option<&[u8]>,
) -> Result<Matrices, MatricesError> {
    let content = |name: &str, bytes: &[u8]| Content::of_bytes(name, bytes.to_vec());
    let mass = mass.map(|bytes| content("mass", bytes));
    let rows = rows.map(|bytes| content("rows", bytes));
    contents(format, content("stiffness", stiffness), mass, rows)
}

fn contents(
    format: MatricesFormat,
    stiffness: Content,
    mass: Option<Content>,
    rows: Option<Content>,
) -> Result<Matrices, MatricesError> {
    let rows = rows.map(read_rows).transpose()?;
    let needed = |rows: Option<Vec<Dof>>| {
        rows.ok_or_else(|| {
            let what = format!("no file of rows for the format {format}");
            MatricesError::inconsistent(what, "expected a file with `node.direction` a line")
        })
    };
    if matches!(format, MatricesFormat::Matlab | MatricesFormat::Npz) {
        let arrays = |content: Content| {
            let name = content.name.clone();
            let bytes = content.bytes()?;
            if format == MatricesFormat::Npz {
                npz::read(&name, bytes)
            } else {
                matlab::read(&name, &bytes)
            }
        };
        let mass = mass.map(arrays).transpose()?;
        return arrays(stiffness)?.matrices(mass, rows)?.without_held();
    }
    if format == MatricesFormat::Nastran {
        return nastran::read(stiffness, mass, rows)?.without_held();
    }
    let mass = mass.ok_or_else(|| {
        let what = format!("no file of the mass for the format {format}");
        MatricesError::inconsistent(what, "expected a file each for stiffness and mass")
    })?;
    let matrices = match format {
        MatricesFormat::MatrixMarket => matrix_market::read([stiffness, mass], needed(rows)?),
        MatricesFormat::Abaqus => abaqus::read([stiffness, mass], rows),
        _ => calculix::read([stiffness, mass], needed(rows)?),
    };
    matrices?.without_held()
}

/// Reads the degrees of freedom of rows: `node.direction` a line, or both separated by blanks or a comma.
///
/// The text `12.3` is node 12 and direction 3, never a decimal number.
fn read_rows(content: Content) -> Result<Vec<Dof>, MatricesError> {
    let mut lines = Lines::new(content);
    let mut dofs = Vec::new();
    let mut seen = HashMap::new();
    while let Some(line) = lines.next()? {
        if line.trim_ascii().is_empty() || line.starts_with(b"%") || line.starts_with(b"**") {
            continue;
        }
        let Some(dof) = dof_of_line(line) else {
            let found = crate::text::found(line);
            let expected = "a node and a direction from 1 to 6, such as 12.3";
            return Err(lines.malformed(found, expected));
        };
        if let Some(before) = seen.insert(dof, lines.line) {
            let found = format!("{dof}, as in line {before}");
            return Err(lines.malformed(found, "each degree of freedom once"));
        }
        dofs.push(dof);
    }
    lines.check_end()?;
    if dofs.is_empty() {
        return Err(lines.ends_early("it has no rows"));
    }
    Ok(dofs)
}

fn dof_of_line(line: &[u8]) -> Option<Dof> {
    let mut fields = Fields(line);
    let first = fields.next()?;
    let (node, direction) = match first.iter().position(|byte| *byte == b'.') {
        Some(point) => (&first[..point], &first[point + 1..]),
        None => (first, fields.next()?),
    };
    if fields.next().is_some() || !direction.iter().all(u8::is_ascii_digit) {
        return None;
    }
    Dof::of_numbers(crate::text::whole(node)?, crate::text::whole(direction)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str) -> Result<Vec<Dof>, MatricesError> {
        read_rows(Content::of_bytes("a.dof", text.as_bytes().to_vec()))
    }

    #[test]
    fn a_row_is_a_node_and_a_direction_and_no_decimal_number() {
        let expected = [(12, 3), (120, 3), (12, 1), (-4, 1), (7, 2)];
        let expected: Vec<Dof> = expected.iter().map(|&(node, dir)| Dof::new(node, dir)).collect();
        assert_eq!(rows("12.3\n120.3\n 12.1\r\n-4,1\n7 2\n").unwrap(), expected);
        for wrong in
            ["12.10", "12.0", "12.7", "12", "12.", ".3", "12.3.1", "1e1.2", "12.-1", "12.3 4"]
        {
            let error = rows(&format!("1.1\n{wrong}\n1.2\n")).unwrap_err().to_string();
            assert!(error.starts_with(&format!("a.dof, line 2: `{wrong}`; expected")), "{error}");
        }
    }

    #[test]
    fn a_row_given_twice_is_refused_with_its_lines() {
        let error = rows("1.1\n1.2\n1.1\n").unwrap_err().to_string();
        assert_eq!(
            error,
            "a.dof, line 3: node 1 direction 1, as in line 1; expected each degree of freedom once"
        );
    }

    #[test]
    fn formats_have_names() {
        for format in MatricesFormat::ALL {
            assert_eq!(format.name().parse::<MatricesFormat>().unwrap(), format);
        }
        let error = "ansys".parse::<MatricesFormat>().unwrap_err().to_string();
        assert!(error.contains("calculix, abaqus, matrix_market, nastran, matlab, npz"), "{error}");
    }
}
