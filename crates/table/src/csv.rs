//! CSV text (RFC 4180, but for its line ends, which are LF).

use std::borrow::Cow;
use std::fmt::{self, Write as _};

/// CSV text, written field by field.
///
/// ```
/// let mut csv = asperity_table::CsvWriter::with_header(["name", "force_n", "ratio"]);
/// csv.text("a,b").number(1e-5).number(None).end_row();
/// assert_eq!(csv.into_string(), "name,force_n,ratio\n\"a,b\",1e-5,\n");
/// ```
#[derive(Debug, Clone, Default)]
pub struct CsvWriter {
    text: String,
    row_start: usize,
    fields: usize,
}

impl CsvWriter {
    /// Text that starts with a row of column names.
    pub fn with_header<T: AsRef<str>>(names: impl IntoIterator<Item = T>) -> Self {
        let mut csv = Self::default();
        for name in names {
            csv.text(name.as_ref());
        }
        csv.end_row();
        csv
    }

    /// Appends a field of text, as [`quoted`] writes it.
    pub fn text(&mut self, field: &str) -> &mut Self {
        self.separate();
        self.text.push_str(&quoted(field));
        self
    }

    /// Appends a number: the shortest decimal that reads back to the same bits, with an exponent
    /// below 1e-4 and from 1e15 on. Nothing, NaN and infinities are an empty field.
    pub fn number(&mut self, value: impl Into<Option<f64>>) -> &mut Self {
        self.separate();
        if let Some(value) = value.into().filter(|value| value.is_finite()) {
            // Writing to a string cannot fail.
            let _ = write!(self.text, "{}", Decimal(value));
        }
        self
    }

    /// Appends several numbers.
    pub fn numbers<T: Into<Option<f64>>>(
        &mut self,
        values: impl IntoIterator<Item = T>,
    ) -> &mut Self {
        for value in values {
            self.number(value);
        }
        self
    }

    /// Ends the row. An empty field that is the only one of its row is written as `""`, since
    /// readers skip blank lines.
    pub fn end_row(&mut self) {
        if self.fields == 1 && self.text.len() == self.row_start {
            self.text.push_str("\"\"");
        }
        self.text.push('\n');
        self.row_start = self.text.len();
        self.fields = 0;
    }

    /// The text, with an LF at the end of each row.
    pub fn into_string(self) -> String {
        self.text
    }

    fn separate(&mut self) {
        if self.fields > 0 {
            self.text.push(',');
        }
        self.fields += 1;
    }
}

/// A number as text: the shortest decimal that reads back to the same bits, with an exponent below
/// 1e-4 and from 1e15 on; `nan`, `inf` or `-inf` if it is not finite.
///
/// ```
/// use asperity_table::Decimal;
/// assert_eq!(format!("{} {}", Decimal(0.25), Decimal(1e-5)), "0.25 1e-5");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decimal(pub f64);

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = self.0;
        if value == 0.0 || (1e-4..1e15).contains(&value.abs()) {
            write!(f, "{value}")
        } else if value.is_nan() {
            f.write_str("nan")
        } else {
            write!(f, "{value:e}")
        }
    }
}

/// Characters that make a spreadsheet run a cell that starts with them as a formula.
const FORMULA: [char; 7] = ['=', '+', '-', '@', '\t', '\r', '\n'];

/// A field of CSV text, in quotes if it contains a comma, a quote or a line break.
///
/// A text that a spreadsheet would run, since it starts with `=`, `+`, `-`, `@`, a tab or a line
/// break and is not a number, gets an apostrophe before it, which spreadsheets take as the mark of a
/// text. So does a text that already starts with apostrophes before such a character; [`unquoted`]
/// reverses both.
///
/// ```
/// use asperity_table::{quoted, unquoted};
/// assert_eq!(quoted("=1+2"), "'=1+2");
/// assert_eq!(quoted("-1.5e3"), "-1.5e3");
/// assert_eq!(unquoted("'=1+2"), "=1+2");
/// ```
pub fn quoted(field: &str) -> Cow<'_, str> {
    let is_formula = starts_formula(field) && field.parse::<f64>().is_err();
    let mark = if is_formula { "'" } else { "" };
    if field.contains([',', '"', '\n', '\r', '\t']) {
        Cow::Owned(format!("\"{mark}{}\"", field.replace('"', "\"\"")))
    } else if is_formula {
        Cow::Owned(format!("{mark}{field}"))
    } else {
        Cow::Borrowed(field)
    }
}

/// A text that was read from CSV, without the apostrophe that [`quoted`] puts before one that a
/// spreadsheet would run.
pub fn unquoted(field: &str) -> &str {
    field.strip_prefix('\'').filter(|rest| starts_formula(rest)).unwrap_or(field)
}

fn starts_formula(field: &str) -> bool {
    field.trim_start_matches('\'').starts_with(FORMULA)
}

/// Columns as CSV text, without copying them into a [`Table`](crate::Table).
///
/// A column shorter than the longest ends in empty fields.
///
/// ```
/// let text = asperity_table::columns_to_csv([("time_s", [0.0, 0.5]), ("force_n", [0.0, 32.0])]);
/// assert_eq!(text, "time_s,force_n\n0,0\n0.5,32\n");
/// ```
pub fn columns_to_csv<N: AsRef<str>, V: AsRef<[f64]>>(
    columns: impl IntoIterator<Item = (N, V)>,
) -> String {
    let (names, columns): (Vec<N>, Vec<V>) = columns.into_iter().unzip();
    let mut csv = CsvWriter::with_header(&names);
    let rows = columns.iter().map(|values| values.as_ref().len()).max().unwrap_or(0);
    csv.text.reserve(rows * columns.len() * 20);
    for row in 0..rows {
        csv.numbers(columns.iter().map(|values| values.as_ref().get(row).copied())).end_row();
    }
    csv.into_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Header and numbers of a text, read with the `csv` crate; NaN for an empty field.
    fn read(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
        let mut reader = ::csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().unwrap().iter().map(str::to_owned).collect();
        let number = |field: &str| {
            if field.is_empty() { f64::NAN } else { field.parse().unwrap() }
        };
        let row =
            |row: ::csv::Result<::csv::StringRecord>| row.unwrap().iter().map(number).collect();
        (header, reader.records().map(row).collect())
    }

    #[test]
    fn text_is_quoted_where_needed() {
        let names = ["force, measured_n", "say \"k\"", "two\nlines"];
        assert_eq!(read(&columns_to_csv(names.map(|name| (name, [1.0])))).0, names);
    }

    #[test]
    fn no_text_starts_like_a_formula_and_each_reads_back() {
        for (text, written) in [
            ("=cmd|' /C calc'!A0", "'=cmd|' /C calc'!A0"),
            ("@SUM(1,2)", "\"'@SUM(1,2)\""),
            ("-guide", "'-guide"),
            ("+", "'+"),
            ("\t=1", "\"'\t=1\""),
            ("\r=1", "\"'\r=1\""),
            ("'=1", "''=1"),
            ("'tis", "'tis"),
            ("guide-sample", "guide-sample"),
            ("-1e5", "-1e5"),
            ("+3", "+3"),
        ] {
            assert_eq!(quoted(text), written);
            let mut csv = CsvWriter::with_header(["name", "x"]);
            csv.text(text).number(1.0).end_row();
            let text_read = csv.into_string();
            let mut reader = ::csv::Reader::from_reader(text_read.as_bytes());
            let row = reader.records().next().unwrap().unwrap();
            assert_eq!(unquoted(&row[0]), text);
        }
    }

    #[test]
    fn a_single_column_keeps_its_empty_rows() {
        let text = columns_to_csv([("a", [1.0, f64::NAN, f64::INFINITY, 2.0])]);
        assert_eq!(text, "a\n1\n\"\"\n\"\"\n2\n");
        assert_eq!(read(&text).1.len(), 4);
    }

    proptest! {
        #[test]
        fn every_finite_number_reads_back_to_the_same_bits(
            values in prop::collection::vec(any::<f64>(), 1..50)
        ) {
            let (_, rows) = read(&columns_to_csv([("x", &values), ("y", &values)]));
            for (row, x) in rows.iter().zip(&values) {
                prop_assert!(row[1].to_bits() == x.to_bits() || (row[1].is_nan() && !x.is_finite()));
            }
        }
    }
}
