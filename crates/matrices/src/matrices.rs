//! Stiffness and mass with the degree of freedom of each row, and the files that hold them.

use std::collections::HashMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::error::{MatricesError, Place};
use crate::sparse::{Assembled, Entry, EntryFault, MOST_ROWS, SparseSymmetric, Triangles};
use crate::text::{Content, Fields, Lines};
use crate::{Dof, abaqus, calculix, matlab, matrix_market, nastran, npz};

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
    fn without_held(self) -> Result<Self, MatricesError> {
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
