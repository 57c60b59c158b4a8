//! Columns of numbers and their text.
//!
//! One number convention for every table that asperity writes: the fewest digits that read back
//! exactly, an empty field where there is no number.

use std::fmt::Write as _;

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
pub fn push_number(text: &mut String, value: f64) {
    if !value.is_finite() {
        return;
    }
    // Writing to a string cannot fail.
    let plain = value == 0.0 || (1e-4..1e15).contains(&value.abs());
    let _ = if plain { write!(text, "{value}") } else { write!(text, "{value:e}") };
}

/// A field as CSV writes it: in quotes where it holds a comma, a quote or a line break.
pub fn quoted(field: &str) -> String {
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
