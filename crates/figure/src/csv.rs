//! Tables as CSV text: a header line of column names, then numbers.

use crate::{FigureError, Table};
use std::fmt::Write as _;

impl Table {
    /// The table as CSV with LF line ends: shortest decimals that read back to the same bits, NaN
    /// as an empty field, infinities as `inf` and `-inf`.
    pub fn to_csv(&self) -> String {
        let mut text = self.names().map(quoted).collect::<Vec<_>>().join(",");
        text.push('\n');
        for row in 0..self.rows() {
            for (index, column) in self.columns().iter().enumerate() {
                if index > 0 {
                    text.push(',');
                }
                text.push_str(&shortest(column.values()[row]));
            }
            text.push('\n');
        }
        text
    }

    /// Reads what [`Table::to_csv`] writes; CR LF line ends and spaces around numbers are accepted.
    ///
    /// # Errors
    /// [`FigureError::MissingHeader`], [`FigureError::FieldCount`], [`FigureError::NotANumber`] or
    /// [`FigureError::DuplicateColumn`].
    pub fn from_csv(text: &str) -> Result<Self, FigureError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text.lines();
        let header = lines.next().filter(|line| !line.trim().is_empty());
        let names = split(header.ok_or(FigureError::MissingHeader)?);
        let mut columns = vec![Vec::new(); names.len()];
        for (index, line) in lines.enumerate() {
            let fields = split(line);
            if fields.len() != names.len() {
                return Err(FigureError::FieldCount {
                    line: index + 2,
                    expected: names.len(),
                    found: fields.len(),
                });
            }
            for ((field, name), values) in fields.iter().zip(&names).zip(&mut columns) {
                values.push(number(field).ok_or_else(|| FigureError::NotANumber {
                    line: index + 2,
                    column: name.clone(),
                    field: field.clone(),
                })?);
            }
        }
        let mut table = Self::new();
        for (name, values) in names.into_iter().zip(columns) {
            table.push(name, values)?;
        }
        Ok(table)
    }
}

/// Shortest decimal that reads back to `value`, with an exponent where that is shorter to read.
fn shortest(value: f64) -> String {
    let magnitude = value.abs();
    let mut text = String::new();
    // Writing to a String cannot fail, so the results carry nothing.
    if value.is_nan() {
    } else if magnitude.is_finite() && magnitude != 0.0 && !(1e-5..1e15).contains(&magnitude) {
        let _ = write!(text, "{value:e}");
    } else {
        let _ = write!(text, "{value}");
    }
    text
}

fn number(field: &str) -> Option<f64> {
    match field.trim() {
        "" => Some(f64::NAN),
        trimmed => trimmed.parse().ok(),
    }
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\"").replace(['\n', '\r'], " "))
    } else {
        name.to_owned()
    }
}

fn split(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut inside = false;
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        match (character, inside) {
            ('"', true) if characters.peek() == Some(&'"') => {
                characters.next();
                push(&mut fields, '"');
            }
            ('"', _) => inside = !inside,
            (',', false) => fields.push(String::new()),
            _ => push(&mut fields, character),
        }
    }
    fields
}

fn push(fields: &mut [String], character: char) {
    if let Some(last) = fields.last_mut() {
        last.push(character);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn reads_back_the_same_bits() {
        let values = vec![
            0.1 + 0.2,
            -0.0,
            1e300,
            5e-324,
            f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            1.0 / 3.0,
        ];
        let table = Table::new()
            .with_column("force, measured_n", values.clone())
            .unwrap()
            .with_column("say \"k\"", vec![f64::NAN; values.len()])
            .unwrap();
        let again = Table::from_csv(&table.to_csv()).unwrap();
        assert_eq!(again.names().collect::<Vec<_>>(), table.names().collect::<Vec<_>>());
        for (a, b) in again.column("force, measured_n").unwrap().iter().zip(&values) {
            assert_eq!(a.to_bits(), b.to_bits());
        }
        assert!(again.column("say \"k\"").unwrap().iter().all(|v| v.is_nan()));
    }

    #[test]
    fn a_single_column_keeps_its_empty_rows() {
        let table = Table::new().with_column("a", vec![1.0, f64::NAN, 2.0, f64::NAN]).unwrap();
        assert_eq!(Table::from_csv(&table.to_csv()).unwrap().rows(), 4);
    }

    #[test]
    fn says_where_a_text_is_wrong() {
        assert_eq!(Table::from_csv(""), Err(FigureError::MissingHeader));
        assert!(matches!(
            Table::from_csv("a,b\n1,2\n3\n"),
            Err(FigureError::FieldCount { line: 3, expected: 2, found: 1 })
        ));
        assert!(matches!(Table::from_csv("a\nx\n"), Err(FigureError::NotANumber { line: 2, .. })));
    }

    proptest! {
        #[test]
        fn every_float_survives(values in prop::collection::vec(any::<f64>(), 1..50)) {
            let table = Table::new().with_column("x", values.clone()).unwrap();
            let again = Table::from_csv(&table.to_csv()).unwrap();
            for (a, b) in again.column("x").unwrap().iter().zip(&values) {
                prop_assert!(a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()));
            }
        }
    }
}
