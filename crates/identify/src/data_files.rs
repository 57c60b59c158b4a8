//! Data files: receptances, backbones, and the reading of all.

use std::path::Path;

use asperity_signal::Complex64;

use crate::error::IdentificationError;
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
    path: &Path,
    band: [f64; 2],
    most: usize,
) -> Result<Vec<ReceptanceLine>, IdentificationError> {
    const EXPECTED: &str =
        "the columns frequency_hz, real_m_per_n (or real) and imag_m_per_n (or imag) in m/N";
    let columns = [&["frequency_hz"][..], &["real_m_per_n", "real"], &["imag_m_per_n", "imag"]];
    let rows = columns_of(path, &columns, EXPECTED)?;
    // Lines with too little force are empty, or marked as not valid.
    let counts =
        |row: &&[f64; 3]| (band[0]..=band[1]).contains(&row[0]) && row.iter().all(|x| !x.is_nan());
    let inside: Vec<ReceptanceLine> = rows
        .iter()
        .filter(counts)
        .map(|row| ReceptanceLine {
            frequency_hz: row[0],
            value: Complex64::new(row[1], row[2]),
            deviation: 0.0,
        })
        .collect();
    if inside.is_empty() {
        let text = format!("no valid line lies between {} and {} Hz", band[0], band[1]);
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
    path: &Path,
    index: Option<usize>,
    with_damping: bool,
) -> Result<Vec<BackboneRow>, IdentificationError> {
    const EXPECTED: &str =
        "the columns index, amplitude_m, frequency_hz and, for damping, damping_ratio";
    let third = if with_damping { "damping_ratio" } else { "frequency_hz" };
    let columns = [&["index"][..], &["amplitude_m"], &["frequency_hz"], &[third]];
    let noise = ["frequency_uncertainty_hz", "damping_ratio_uncertainty"];
    let rows: Vec<[f64; 6]> = table(path, &columns, &noise, EXPECTED)?;
    let wanted = match (index, rows.first()) {
        (Some(index), _) => index as f64,
        (None, Some(first)) if rows.iter().all(|row| row[0] == first[0]) => first[0],
        (None, _) => {
            let text = "the file has several hits".to_owned();
            return Err(problem(path, text, "\"index\", the number of one of them"));
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
        return Err(problem(path, text, "amplitudes in m, of a channel whose unit is known"));
    }
    if points.is_empty() {
        return Err(problem(
            path,
            format!("the file has no hit {wanted}"),
            "the number of a hit in it",
        ));
    }
    Ok(points)
}

/// Numbers of some columns of a CSV, each under one of several names; NaN where a field is empty,
/// and in all columns but the first of rows that a column `valid` marks with 0.
pub(super) fn columns_of<const N: usize>(
    path: &Path,
    names: &[&[&str]; N],
    expected: &'static str,
) -> Result<Vec<[f64; N]>, IdentificationError> {
    table(path, names, &[], expected)
}

/// The same with `others` behind, NaN where there is no such column.
fn table<const N: usize>(
    path: &Path,
    names: &[&[&str]],
    others: &[&str],
    expected: &'static str,
) -> Result<Vec<[f64; N]>, IdentificationError> {
    let text = read(path)?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let unreadable = |error: csv::Error| problem(path, error.to_string(), expected);
    let header = reader.headers().map_err(unreadable)?.clone();
    let mut places = [usize::MAX; N];
    let (needed, optional) = places.split_at_mut(names.len());
    for (place, names) in needed.iter_mut().zip(names) {
        let found = header.iter().position(|column| names.contains(&column));
        *place = found
            .ok_or_else(|| problem(path, format!("there is no column {}", names[0]), expected))?;
    }
    for (place, name) in optional.iter_mut().zip(others) {
        *place = header.iter().position(|column| column == *name).unwrap_or(usize::MAX);
    }
    let valid = header.iter().position(|column| column == "valid");
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        let marked = valid.and_then(|place| record.get(place)) == Some("0");
        let mut row = [f64::NAN; N];
        for (index, (number, &place)) in row.iter_mut().zip(&places).enumerate() {
            let text = record.get(place).unwrap_or_default();
            if text.is_empty() || (marked && index > 0) {
                continue;
            }
            let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
            *number = value.ok_or_else(|| {
                let line = record.position().map_or(0, csv::Position::line);
                problem(path, format!("line {line}: \"{text}\" is not a finite number"), expected)
            })?;
        }
        rows.push(row);
    }
    Ok(rows)
}
