//! Tables of data, from files or in place: receptances, backbones, and the reading of all.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use asperity_signal::Complex64;

use crate::error::IdentificationError;
use crate::problem::{Cell, TableRef};
use asperity_scenario::read_text;

/// Largest size of a data file, in bytes.
const MAX_BYTES: u64 = 1 << 28;

/// Stride of the points of a backbone: neighbouring points share three quarters of their samples.
const EVERY: usize = 4;

/// A receptance at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ReceptanceLine {
    pub(super) frequency_hz: f64,
    /// In m/N.
    pub(super) value: Complex64,
    /// Standard deviation of each part from noise \[m/N\]; 0 if not known.
    pub(super) deviation: f64,
}

pub(super) fn read(path: &Path) -> Result<String, IdentificationError> {
    read_text(path, MAX_BYTES)
        .map_err(|source| IdentificationError::Input { path: path.to_owned(), source })
}

pub(super) fn problem(path: &Path, problem: String, expected: &'static str) -> IdentificationError {
    IdentificationError::File { path: path.to_owned(), problem, expected }
}

/// The lines of an `frf.csv` in a band, at most `most` of them, evenly spaced.
pub(super) fn frf(
    table: &TableSource<'_>,
    band: [f64; 2],
    most: usize,
) -> Result<Vec<ReceptanceLine>, IdentificationError> {
    const EXPECTED: &str =
        "the columns frequency_hz, real_m_per_n (or real) and imag_m_per_n (or imag) in m/N";
    let columns = [&["frequency_hz"][..], &["real_m_per_n", "real"], &["imag_m_per_n", "imag"]];
    let rows = table.columns(&columns, EXPECTED)?;
    // Lines with too little force are empty, or marked as not valid.
    let counts = |row: &&[f64; 3]| row.iter().all(|x| !x.is_nan());
    let inside = rows.iter().filter(counts).map(|row| ReceptanceLine {
        frequency_hz: row[0],
        value: Complex64::new(row[1], row[2]),
        deviation: 0.0,
    });
    some_lines(&table.path, inside, band, most)
}

/// The lines in a band, at most `most` of them, evenly spaced.
pub(super) fn some_lines(
    path: &Path,
    lines: impl Iterator<Item = ReceptanceLine>,
    [low, high]: [f64; 2],
    most: usize,
) -> Result<Vec<ReceptanceLine>, IdentificationError> {
    let inside: Vec<ReceptanceLine> =
        lines.filter(|line| (low..=high).contains(&line.frequency_hz)).collect();
    if inside.is_empty() {
        let text = format!("no valid line lies between {low} and {high} Hz");
        return Err(problem(path, text, "lines inside band_hz"));
    }
    let every = inside.len().div_ceil(most);
    Ok(inside.into_iter().step_by(every).collect())
}

/// A point of a backbone, with the standard deviations due to noise where the file has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BackboneRow {
    /// In m.
    pub(super) amplitude: f64,
    pub(super) frequency_hz: f64,
    /// Equal to the frequency where damping was not asked for.
    pub(super) damping_ratio: f64,
    /// 0 where it is not known.
    pub(super) frequency_deviation_hz: f64,
    /// 0 where it is not known.
    pub(super) ratio_deviation: f64,
}

/// Points of hit `index` of a `backbone.csv`, with damping ratios where asked for.
pub(super) fn backbone(
    table: &TableSource<'_>,
    index: Option<usize>,
    with_damping: bool,
) -> Result<Vec<BackboneRow>, IdentificationError> {
    const EXPECTED: &str =
        "the columns index, amplitude_m, frequency_hz and, for damping, damping_ratio";
    let third = if with_damping { "damping_ratio" } else { "frequency_hz" };
    let columns = [&["index"][..], &["amplitude_m"], &["frequency_hz"], &[third]];
    let noise = ["frequency_uncertainty_hz", "damping_ratio_uncertainty"];
    let rows: Vec<[f64; 6]> = table.rows(&columns, &noise, EXPECTED)?;
    let wanted = match (index, rows.first()) {
        (Some(index), _) => index as f64,
        (None, Some(first)) if rows.iter().all(|row| row[0] == first[0]) => first[0],
        (None, _) => {
            let text = "the file has several hits".to_owned();
            return Err(table.problem(text, "\"index\", the number of one of them"));
        }
    };
    let known = |deviation: f64| if deviation.is_nan() { 0.0 } else { deviation };
    let points: Vec<BackboneRow> = rows
        .iter()
        .filter(|row| row[0] == wanted && row[..4].iter().all(|x| !x.is_nan()))
        .step_by(EVERY)
        .map(|row| BackboneRow {
            amplitude: row[1],
            frequency_hz: row[2],
            damping_ratio: row[3],
            frequency_deviation_hz: known(row[4]),
            ratio_deviation: known(row[5]),
        })
        .collect();
    if points.is_empty() && rows.iter().any(|row| row[0] == wanted) {
        let text = format!("amplitude_m is empty for hit {wanted}");
        return Err(table.problem(text, "amplitudes in m, of a channel whose unit is known"));
    }
    if points.is_empty() {
        let text = format!("the file has no hit {wanted}");
        return Err(table.problem(text, "the number of a hit in it"));
    }
    Ok(points)
}

/// A table of data.
#[derive(Debug)]
pub(super) struct TableSource<'a> {
    /// The file, or the place in the problem.
    path: PathBuf,
    columns: Option<&'a BTreeMap<String, Vec<Cell>>>,
}

impl<'a> TableSource<'a> {
    /// The table of the data at `place`, whose problem is in `folder`.
    pub(super) fn new(place: &str, folder: &Path, table: &'a TableRef) -> Self {
        match table {
            TableRef::File(file) => Self { path: folder.join(file), columns: None },
            TableRef::InPlace(columns) => {
                Self { path: PathBuf::from(format!("{place}/file")), columns: Some(columns) }
            }
        }
    }

    /// An error in the contents of the table.
    pub(super) fn problem(&self, problem: String, expected: &'static str) -> IdentificationError {
        self::problem(&self.path, problem, expected)
    }

    /// Numbers of some columns, each under one of several names; NaN where a field is empty, and in
    /// all columns but the first of rows that a column `valid` marks with 0.
    pub(super) fn columns<const N: usize>(
        &self,
        names: &[&[&str]; N],
        expected: &'static str,
    ) -> Result<Vec<[f64; N]>, IdentificationError> {
        self.rows(names, &[], expected)
    }

    /// Numbers of the columns `names`, then of the optional columns `others`, NaN where there is none.
    fn rows<const N: usize>(
        &self,
        names: &[&[&str]],
        others: &[&str],
        expected: &'static str,
    ) -> Result<Vec<[f64; N]>, IdentificationError> {
        let table = match self.columns {
            Some(columns) => self.in_place(columns, expected)?,
            None => self.read(expected)?,
        };
        let place_of = |known: &dyn Fn(&str) -> bool| table.header.iter().position(|it| known(it));
        let mut places = [None; N];
        let (needed, optional) = places.split_at_mut(names.len());
        for (place, names) in needed.iter_mut().zip(names) {
            let found = place_of(&|column| names.contains(&column));
            let missing = || self.problem(format!("there is no column {}", names[0]), expected);
            *place = Some(found.ok_or_else(missing)?);
        }
        for (place, name) in optional.iter_mut().zip(others) {
            *place = place_of(&|column| column == *name);
        }
        let valid = place_of(&|column| column == "valid");
        let mut rows = Vec::with_capacity(table.rows.len());
        for (line, cells) in &table.rows {
            let marked = valid.and_then(|place| cells.get(place)).is_some_and(|cell| cell == "0");
            let mut row = [f64::NAN; N];
            for (index, (number, place)) in row.iter_mut().zip(places).enumerate() {
                let text = place.and_then(|place| cells.get(place)).map_or("", String::as_str);
                if text.is_empty() || (marked && index > 0) {
                    continue;
                }
                let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
                *number = value.ok_or_else(|| {
                    let problem = format!("{line}: \"{text}\" is not a finite number");
                    self.problem(problem, expected)
                })?;
            }
            rows.push(row);
        }
        Ok(rows)
    }

    /// The cells of the file.
    fn read(&self, expected: &'static str) -> Result<Cells, IdentificationError> {
        let text = read(&self.path)?;
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
        let unreadable = |error: csv::Error| self.problem(error.to_string(), expected);
        let texts = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        let header = texts(reader.headers().map_err(unreadable)?);
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(unreadable)?;
            let line = record.position().map_or(0, csv::Position::line);
            rows.push((format!("line {line}"), texts(&record)));
        }
        Ok(Cells { header, rows })
    }

    /// The cells of columns in place.
    fn in_place(
        &self,
        columns: &BTreeMap<String, Vec<Cell>>,
        expected: &'static str,
    ) -> Result<Cells, IdentificationError> {
        let count = columns.values().map(Vec::len).max().unwrap_or_default();
        if let Some((name, column)) = columns.iter().find(|(_, column)| column.len() != count) {
            let text = format!("column {name} has {} rows, others {count}", column.len());
            return Err(self.problem(text, expected));
        }
        let row = |n: usize| {
            let cells = columns.values().map(|column| match &column[n] {
                Cell::Number(number) => number.to_string(),
                Cell::Truth(truth) => u8::from(*truth).to_string(),
                Cell::Text(text) => text.clone(),
                Cell::Empty(()) => String::new(),
            });
            (format!("row {}", n + 1), cells.collect())
        };
        let rows = (0..count).map(row).collect();
        Ok(Cells { header: columns.keys().cloned().collect(), rows })
    }
}

/// A table as texts, each row with its place in words.
struct Cells {
    header: Vec<String>,
    rows: Vec<(String, Vec<String>)>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn table(value: &serde_json::Value) -> TableRef {
        serde_json::from_value(value.clone()).unwrap()
    }

    fn message(value: &serde_json::Value) -> String {
        let table = table(value);
        let source = TableSource::new("/data/3", Path::new("folder"), &table);
        backbone(&source, None, true).unwrap_err().to_string()
    }

    /// A table in place and a file with the same cells, some empty or marked, give the same rows.
    #[test]
    fn a_table_in_place_equals_a_file() {
        let folder = std::env::temp_dir().join(format!("asperity-table-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let csv = "frequency_hz,real,imag,valid,unit\n800,1e-7,-2e-8,1,m/N\n801,,0,1,m/N\n\
                   802,2.5e-7,-1e-8,0,m/N\n803,0.1,0.30000000000000004,1,m/N\n";
        std::fs::write(folder.join("frf.csv"), csv).unwrap();
        let file = table(&json!("frf.csv"));
        let columns = table(&json!({
            "frequency_hz": [800, 801, 802, 803],
            "real": [1e-7, null, 2.5e-7, 0.1],
            "imag": [-2e-8, 0, -1e-8, 0.300_000_000_000_000_04],
            "valid": [true, true, false, true],
            "unit": ["m/N", "m/N", "m/N", "m/N"],
        }));
        let [of_file, in_place] = [&file, &columns]
            .map(|it| frf(&TableSource::new("/data/0", &folder, it), [1.0, 1e3], 10).unwrap());
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(of_file, in_place);
        assert_eq!(of_file.len(), 2);
    }

    #[test]
    fn faults_of_tables_in_place_name_their_place() {
        let missing = message(&json!({"index": [1], "amplitude_m": [1e-7]}));
        assert!(missing.contains("/data/3/file") && missing.contains("frequency_hz"), "{missing}");
        let short = message(&json!({"index": [1], "amplitude_m": [1e-7, 2e-7]}));
        assert!(short.contains("column index has 1 rows, others 2"), "{short}");
        let text = message(&json!({
            "index": [1], "amplitude_m": ["much"], "frequency_hz": [900], "damping_ratio": [0.03]
        }));
        assert!(text.contains("row 1: \"much\" is not a finite number"), "{text}");
    }
}
