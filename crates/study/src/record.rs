//! Results as CSV text under the column names of the contract.

use std::fmt::Write as _;

use asperity_dynamics::{History, Mode};
use asperity_signal::Frf;

use crate::laws::LawTable;

/// `history.csv`: a row per output sample.
pub fn history_csv(history: &History, interfaces: &[&str]) -> String {
    let mut columns: Vec<(String, &[f64])> = vec![
        ("time_s".to_owned(), &history.time),
        ("force_n".to_owned(), &history.force),
        ("displacement_m".to_owned(), &history.displacement),
        ("acceleration_m_per_s2".to_owned(), &history.acceleration),
    ];
    for (name, columns_of) in interfaces.iter().zip(&history.interfaces) {
        columns.push((format!("{name}:pressure_pa"), &columns_of.pressure));
        columns.push((format!("{name}:closure_m"), &columns_of.closure));
        columns.push((format!("{name}:stiffness_pa_per_m"), &columns_of.stiffness));
    }
    csv(&columns)
}

/// `frf.csv`: a row per frequency.
pub fn frf_csv(frf: &Frf) -> String {
    let real: Vec<f64> = frf.values.iter().map(|value| value.re).collect();
    let imag: Vec<f64> = frf.values.iter().map(|value| value.im).collect();
    csv(&[
        ("frequency_hz".to_owned(), &frf.frequency_hz),
        ("real_m_per_n".to_owned(), &real),
        ("imag_m_per_n".to_owned(), &imag),
        ("magnitude_m_per_n".to_owned(), &frf.magnitude()),
        ("phase_rad".to_owned(), &frf.phase()),
    ])
}

/// `law-<name>.csv`: a row per pressure.
pub fn law_csv(table: &LawTable) -> String {
    csv(&[
        ("pressure_pa".to_owned(), &table.pressure),
        ("stiffness_pa_per_m".to_owned(), &table.stiffness),
        ("closure_m".to_owned(), &table.closure),
        ("energy_j_per_m2".to_owned(), &table.energy),
    ])
}

/// `modes.csv`: the shape of each mode along the stack, a row per place.
pub fn modes_csv(places: &[f64], modes: &[Mode], shapes: &[Vec<f64>]) -> String {
    let mut columns: Vec<(String, &[f64])> = vec![("position_m".to_owned(), places)];
    for (number, (mode, shape)) in modes.iter().zip(shapes).enumerate() {
        columns.push((format!("mode_{}:{:.3}_hz", number + 1, mode.frequency_hz), shape));
    }
    csv(&columns)
}

/// A table of numbers as CSV, each in the fewest digits that read back exactly;
/// numbers that are not finite are left empty.
pub fn csv(columns: &[(String, &[f64])]) -> String {
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    let mut text = String::with_capacity(rows * columns.len() * 20 + 256);
    for (index, (name, _)) in columns.iter().enumerate() {
        text.push_str(if index > 0 { "," } else { "" });
        text.push_str(&quoted(name));
    }
    text.push('\n');
    for row in 0..rows {
        for (index, (_, values)) in columns.iter().enumerate() {
            text.push_str(if index > 0 { "," } else { "" });
            push_number(&mut text, values[row]);
        }
        text.push('\n');
    }
    text
}

/// Appends the shortest text that reads back as `value`; nothing if it is not finite.
pub(crate) fn push_number(text: &mut String, value: f64) {
    if !value.is_finite() {
        return;
    }
    // Writing to a string cannot fail.
    let plain = value == 0.0 || (1e-4..1e15).contains(&value.abs());
    let _ = if plain { write!(text, "{value}") } else { write!(text, "{value:e}") };
}

/// A field as CSV writes it: in quotes where it holds a comma, a quote or a line break.
pub(crate) fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_exactly_and_gaps_stay_empty() {
        let values = [0.0, -1.5, 1.0 / 3.0, 6.02e23, 1.2e-9, f64::NAN, -0.0, 1e15];
        let text = csv(&[("a".to_owned(), &values), ("b,c".to_owned(), &values)]);
        let mut reader = ::csv::Reader::from_reader(text.as_bytes());
        assert_eq!(reader.headers().unwrap(), vec!["a", "b,c"]);
        for (row, value) in reader.records().zip(values) {
            let row = row.unwrap();
            if value.is_nan() {
                assert_eq!(&row[0], "");
            } else {
                assert_eq!(row[0].parse::<f64>().unwrap().to_bits(), value.to_bits());
            }
        }
    }
}
