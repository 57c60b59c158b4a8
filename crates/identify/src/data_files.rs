//! Data files: analyses, receptances, backbones.

use std::collections::BTreeMap;
use std::path::Path;

use asperity_signal::Complex64;
use serde_json::Value;

use crate::error::IdentificationError;
use crate::problem::{HitSpec, Measured, Uncertain};
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

fn read(path: &Path) -> Result<String, IdentificationError> {
    read_text(path, MAX_BYTES)
        .map_err(|source| IdentificationError::Input { path: path.to_owned(), source })
}

fn problem(path: &Path, problem: String, expected: &'static str) -> IdentificationError {
    IdentificationError::File { path: path.to_owned(), problem, expected }
}

/// The averaged hits of an `analysis.json` with their available features, and the number of the
/// other hits.
pub(super) fn analysed_hits(
    path: &Path,
    features: &[String],
) -> Result<(Vec<HitSpec>, usize), IdentificationError> {
    const EXPECTED: &str = "the analysis.json that asperity analyse writes";
    let text = read(path)?;
    let analysis: Value = serde_json::from_str(&text)
        .map_err(|error| problem(path, format!("line {}: {error}", error.line()), EXPECTED))?;
    if analysis.get("schema").and_then(Value::as_str) != Some("asperity/analysis/1") {
        let found = "\"schema\" is not \"asperity/analysis/1\"".to_owned();
        return Err(problem(path, found, EXPECTED));
    }
    let hits = analysis.get("hits").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let mut found = Vec::with_capacity(hits.len());
    let good = |hit: &&Value| hit.get("averaged").and_then(Value::as_bool) == Some(true);
    for hit in hits.iter().filter(good) {
        let number = |pointer: &str| hit.pointer(pointer).and_then(Value::as_f64);
        let Some(peak) = number("/force_peak_n") else { continue };
        let mut measured = BTreeMap::new();
        for feature in features {
            let (value, deviation) = match feature.as_str() {
                "fundamental.frequency_hz" => {
                    ("/fundamental/frequency_hz", Some("/fundamental/frequency_uncertainty_hz"))
                }
                "fundamental.receptance_m_per_n" => {
                    ("/fundamental/magnitude", Some("/fundamental/magnitude_uncertainty"))
                }
                "fundamental.damping_ratio" => ("/fundamental/damping_ratio", None),
                "second_harmonic.frequency_hz" => ("/second_harmonic/frequency_hz", None),
                "second_harmonic.receptance_m_per_n" => ("/second_harmonic/magnitude", None),
                "harmonic_ratio" => ("/harmonic_ratio", Some("/harmonic_ratio_uncertainty")),
                _ => {
                    let text = format!("an analysis has no feature {feature}");
                    return Err(problem(
                        path,
                        text,
                        "features of the fundamental and the harmonic",
                    ));
                }
            };
            let Some(value) = number(value) else { continue };
            let with =
                |standard_deviation| Measured::Uncertain(Uncertain { value, standard_deviation });
            let deviation = deviation.and_then(number).filter(|deviation| *deviation > 0.0);
            measured.insert(feature.clone(), deviation.map_or(Measured::Alone(value), with));
        }
        found.push(HitSpec {
            force_peak_n: Some(peak),
            set: crate::problem::Changes::new(),
            features: measured,
        });
    }
    let left_out = hits.len() - found.len();
    if found.is_empty() {
        return Err(problem(path, "the file has no averaged hit".to_owned(), EXPECTED));
    }
    Ok((found, left_out))
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

/// Amplitudes \[m\] and frequencies \[Hz\] of hit `index` of a `backbone.csv`.
pub(super) fn backbone(
    path: &Path,
    index: Option<usize>,
) -> Result<Vec<(f64, f64)>, IdentificationError> {
    const EXPECTED: &str = "the columns index, amplitude_m and frequency_hz of one hit or more";
    let columns = [&["index"][..], &["amplitude_m"], &["frequency_hz"]];
    let rows = columns_of(path, &columns, EXPECTED)?;
    let wanted = match (index, rows.first()) {
        (Some(index), _) => index as f64,
        (None, Some(first)) if rows.iter().all(|row| row[0] == first[0]) => first[0],
        (None, _) => {
            let text = "the file has several hits".to_owned();
            return Err(problem(path, text, "\"index\", the number of one of them"));
        }
    };
    let points: Vec<(f64, f64)> = rows
        .iter()
        .filter(|row| row[0] == wanted && row.iter().all(|x| !x.is_nan()))
        .step_by(EVERY)
        .map(|row| (row[1], row[2]))
        .collect();
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
fn columns_of<const N: usize>(
    path: &Path,
    names: &[&[&str]; N],
    expected: &'static str,
) -> Result<Vec<[f64; N]>, IdentificationError> {
    let text = read(path)?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let unreadable = |error: csv::Error| problem(path, error.to_string(), expected);
    let header = reader.headers().map_err(unreadable)?.clone();
    let mut places = [0; N];
    for (place, names) in places.iter_mut().zip(names) {
        let found = header.iter().position(|column| names.contains(&column));
        *place = found
            .ok_or_else(|| problem(path, format!("there is no column {}", names[0]), expected))?;
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
