//! Pressures against gaps, as contact solvers write them, as a `table` law.

use std::path::{Path, PathBuf};

use asperity_law::{ContactLaw, LawError, LawSpec, TableSpec, Tabulated, stiffness_from_gaps};
use asperity_scenario::{InputError, read_text};
use thiserror::Error;

/// Most bytes of a table.
const MOST_BYTES: u64 = 16 << 20;

/// Most rows of a table.
const MOST_ROWS: usize = 100_000;

/// Names of the first column, with their units in m; the sign is that of the closure.
const DISTANCES: [(&str, f64); 8] = [
    ("gap_m", -1.0),
    ("gap_mm", -1e-3),
    ("gap_um", -1e-6),
    ("gap_nm", -1e-9),
    ("closure_m", 1.0),
    ("closure_mm", 1e-3),
    ("closure_um", 1e-6),
    ("closure_nm", 1e-9),
];

/// Names of the second column, with their units in Pa.
const PRESSURES: [(&str, f64); 4] =
    [("pressure_pa", 1.0), ("pressure_kpa", 1e3), ("pressure_mpa", 1e6), ("pressure_gpa", 1e9)];

/// A `table` law from pressures against gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportedLaw {
    /// The law, for "laws" of a scenario.
    pub spec: LawSpec,
    /// Rows of the file.
    pub rows: usize,
    /// Rows of zero pressure, left out.
    pub open_rows: usize,
    /// First and last pressure of the law \[Pa\].
    pub pressure_range: (f64, f64),
    /// Largest difference between the closures of law and table from the first row in contact, as
    /// a share of the whole closure.
    pub closure_error: f64,
}

/// A table of pressures against gaps that is not a law.
#[derive(Debug, Error)]
#[error("{}: {fault}", path.display())]
pub struct GapTableError {
    /// The file.
    pub path: PathBuf,
    /// Its fault.
    pub fault: GapTableFault,
}

/// Fault of a table of pressures against gaps.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GapTableFault {
    /// The file cannot be read.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The first line is not the header.
    #[error(
        "line 1 is \"{0}\"; expected the header gap_m,pressure_pa; gap or closure in m, mm, um or \
         nm, pressure in pa, kpa, mpa or gpa"
    )]
    Header(String),
    /// A row is not two finite numbers.
    #[error("line {line} is \"{found}\"; expected two finite numbers")]
    Row {
        /// Line, from 1.
        line: usize,
        /// The line.
        found: String,
    },
    /// A pressure is negative.
    #[error(
        "line {line}: the pressure is {pressure_pa} Pa; expected 0 or more, as compression is positive"
    )]
    Tension {
        /// Line, from 1.
        line: usize,
        /// The pressure \[Pa\].
        pressure_pa: f64,
    },
    /// Gap and pressure do not change in opposite directions.
    #[error(
        "line {line}: {what} from line {previous}; expected a pressure that rises strictly while \
         the gap falls strictly, or the reverse order of all rows"
    )]
    NotMonotone {
        /// Line, from 1.
        line: usize,
        /// The row before it.
        previous: usize,
        /// The fault in words.
        what: &'static str,
    },
    /// The file is too long.
    #[error("the table has more than {MOST_ROWS} rows")]
    TooLong,
    /// The rows do not make a law.
    #[error(transparent)]
    Law(#[from] LawError),
}

/// Reads a CSV file of gaps and mean pressures as a `table` law.
///
/// The header names quantity and unit of both columns: `gap_m` or `closure_m` (also mm, um, nm), then
/// `pressure_pa` (also kpa, mpa, gpa). The pressure is positive in compression and rises strictly as
/// the gap falls strictly; the zero of the gap does not matter, and the rows may have either order.
/// Lines that begin with `#` are comments.
///
/// # Errors
/// [`GapTableError`] for a file that cannot be read or is not such a table.
///
/// ```
/// # use asperity_simulation::gap_table::import_gaps;
/// let folder = tempfile::tempdir()?;
/// let table = folder.path().join("rough.csv");
/// std::fs::write(&table, "gap_um,pressure_mpa\n2.0,0\n1.5,0.1\n1.2,0.272\n0.9,0.739\n0.6,2.009\n")?;
/// let law = import_gaps(&table)?;
/// assert_eq!((law.rows, law.open_rows), (5, 1));
/// assert!((law.pressure_range.1 - 2.009e6).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn import_gaps(path: &Path) -> Result<ImportedLaw, GapTableError> {
    let imported = read_rows(path).and_then(|rows| law(&rows));
    imported.map_err(|fault| GapTableError { path: path.to_owned(), fault })
}

/// Closure \[m\] and pressure \[Pa\] of a line.
struct Row {
    line: usize,
    closure: f64,
    pressure: f64,
}

fn read_rows(path: &Path) -> Result<Vec<Row>, GapTableFault> {
    let text = read_text(path, MOST_BYTES)?;
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let mut lines = lines
        .map(|(number, line)| (number + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let header = lines.next().map(|(_, line)| line).unwrap_or_default();
    let unit = |names: &[(&str, f64)], name: &str| {
        names.iter().find(|known| known.0.eq_ignore_ascii_case(name.trim())).map(|known| known.1)
    };
    let units = header.split_once(',');
    let units = units.and_then(|(x, y)| Some((unit(&DISTANCES, x)?, unit(&PRESSURES, y)?)));
    let Some((metre, pascal)) = units else {
        return Err(GapTableFault::Header(header.chars().take(80).collect()));
    };
    let mut rows = Vec::new();
    for (line, text) in lines {
        let parse = |field: &str| field.trim().parse().ok().filter(|value: &f64| value.is_finite());
        let pair = text.split_once(',').and_then(|(x, y)| Some((parse(x)?, parse(y)?)));
        let Some((distance, pressure)) = pair else {
            return Err(GapTableFault::Row { line, found: text.chars().take(80).collect() });
        };
        if pressure < 0.0 {
            return Err(GapTableFault::Tension { line, pressure_pa: pressure * pascal });
        }
        if rows.len() == MOST_ROWS {
            return Err(GapTableFault::TooLong);
        }
        rows.push(Row { line, closure: distance * metre, pressure: pressure * pascal });
    }
    if let [first, .., last] = rows.as_slice()
        && first.pressure > last.pressure
    {
        rows.reverse();
    }
    for pair in rows.windows(2) {
        let [before, row] = pair else { continue };
        let what = if row.closure <= before.closure {
            "the gap does not fall"
        } else if row.pressure <= before.pressure && before.pressure > 0.0 {
            "the pressure does not rise"
        } else {
            continue;
        };
        return Err(GapTableFault::NotMonotone { line: row.line, previous: before.line, what });
    }
    Ok(rows)
}

fn law(rows: &[Row]) -> Result<ImportedLaw, GapTableFault> {
    let pairs: Vec<(f64, f64)> = rows.iter().map(|row| (row.closure, row.pressure)).collect();
    let points = stiffness_from_gaps(&pairs)?;
    let law = Tabulated::new(&points)?;
    let contact = &pairs[pairs.len() - points.len()..];
    let (first, last) = (contact[0], contact[contact.len() - 1]);
    let error = |row: &(f64, f64)| {
        (law.closure_increment(first.1, row.1 - first.1) - (row.0 - first.0)).abs()
    };
    let closure_error = contact.iter().map(error).fold(0.0, f64::max) / (last.0 - first.0);
    Ok(ImportedLaw {
        spec: TableSpec { points: points.into_iter().map(|(p, k)| [p, k]).collect() }.into(),
        rows: rows.len(),
        open_rows: rows.len() - contact.len(),
        pressure_range: (first.1, last.1),
        closure_error,
    })
}
