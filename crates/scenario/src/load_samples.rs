//! Measured loads: CSV rows of time and a force or the motion of a base.

use std::io::Read;
use std::path::Path;

use csv::{ByteRecord, ReaderBuilder, Terminator, Trim};
use thiserror::Error;

use crate::input_file::{InputError, open_input};
use crate::wording::{brief, count, number};

/// Largest size of a samples file in bytes.
pub const MAX_SAMPLE_BYTES: u64 = 1 << 30;

/// Column of times of a samples file.
const TIME: &str = "time_s";

/// Force, or motion of a base, sampled in time.
///
/// ```
/// use asperity_scenario::LoadSamples;
///
/// let pulse = LoadSamples::from_csv(&b"time_s,force_n\n0,0\n1e-3,8\n2e-3,0\n"[..], "force_n")?;
/// assert_eq!(pulse.peak(), 8.0);
/// assert_eq!(pulse.rescaled(20.0)?.values, [0.0, 20.0, 0.0]);
/// # Ok::<(), asperity_scenario::SamplesError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LoadSamples {
    /// Times in s, strictly increasing.
    pub time_s: Vec<f64>,
    /// Values at these times.
    pub values: Vec<f64>,
}

/// Error of force samples that cannot be used.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SamplesError {
    /// File that cannot be opened or read.
    #[error("{0}")]
    Input(#[from] InputError),
    /// Empty file.
    #[error("the samples file is empty; the header time_s,{0} is expected")]
    Empty(&'static str),
    /// First line that is not the header.
    #[error("line 1 is {}; the header time_s,{column} is expected", brief(found))]
    Header {
        /// The line.
        found: String,
        /// Name of the second column.
        column: &'static str,
    },
    /// Row with another number of columns.
    #[error(
        "line {line} has {}; 2 are expected: time_s,{column}",
        count(*found, "column", "columns")
    )]
    Columns {
        /// Line, from 1.
        line: u64,
        /// Number of columns.
        found: usize,
        /// Name of the second column.
        column: &'static str,
    },
    /// Entry that is not a finite number.
    #[error("line {line}: {column} is {}; a finite number is expected", brief(found))]
    NotANumber {
        /// Line, from 1.
        line: u64,
        /// Column.
        column: &'static str,
        /// Entry.
        found: String,
    },
    /// Time that is not after the one before.
    #[error(
        "line {line}: time_s {} does not come after {}; times must increase",
        number(*time_s), number(*previous_s)
    )]
    TimeNotIncreasing {
        /// Line, from 1.
        line: u64,
        /// Time before in s.
        previous_s: f64,
        /// Time in s.
        time_s: f64,
    },
    /// Too few rows to interpolate between.
    #[error(
        "the samples file has {} after its header; at least 2 are expected",
        count(*.0, "row", "rows")
    )]
    TooFewRows(usize),
    /// Force that is zero throughout and cannot be rescaled to a peak.
    #[error("the force is zero throughout, so it cannot be rescaled to a peak")]
    ZeroForce,
}

impl LoadSamples {
    /// Reads a CSV file with the header `time_s,` and `column` and at least two rows of strictly
    /// increasing times. A byte order mark and either line ending are accepted.
    ///
    /// # Errors
    /// [`SamplesError`] with the line.
    pub fn read(path: &Path, column: &'static str) -> Result<Self, SamplesError> {
        let file = open_input(path, MAX_SAMPLE_BYTES)?;
        Self::from_csv(file, column)
    }

    /// Reads the same from a stream, of which at most [`MAX_SAMPLE_BYTES`] are taken.
    ///
    /// # Errors
    /// [`SamplesError`] with the line.
    pub fn from_csv(stream: impl Read, column: &'static str) -> Result<Self, SamplesError> {
        // Rows end at a line feed; a carriage return before it is white space. A line feed is
        // appended to the last row, so the reader's line after a row is that of the row plus one.
        let stream = stream.take(MAX_SAMPLE_BYTES).chain(&b"\n"[..]);
        let mut reader = ReaderBuilder::new()
            .terminator(Terminator::Any(b'\n'))
            .has_headers(false)
            .flexible(true)
            .trim(Trim::All)
            .from_reader(stream);
        let mut row = ByteRecord::new();
        if !reader.read_byte_record(&mut row)? {
            return Err(SamplesError::Empty(column));
        }
        if !row.iter().eq([TIME, column].map(str::as_bytes)) {
            let entries: Vec<_> = row.iter().map(String::from_utf8_lossy).collect();
            return Err(SamplesError::Header { found: entries.join(","), column });
        }
        let (mut time_s, mut values) = (Vec::new(), Vec::<f64>::new());
        while reader.read_byte_record(&mut row)? {
            if row.iter().eq([b""]) {
                continue;
            }
            let line = reader.position().line() - 1;
            let (Some(time), Some(value), 2) = (row.get(0), row.get(1), row.len()) else {
                return Err(SamplesError::Columns { line, found: row.len(), column });
            };
            let time = finite(time, line, TIME)?;
            let value = finite(value, line, column)?;
            if let Some(&previous_s) = time_s.last()
                && time <= previous_s
            {
                return Err(SamplesError::TimeNotIncreasing { line, previous_s, time_s: time });
            }
            time_s.push(time);
            values.push(value);
        }
        match time_s.len() {
            rows @ 0..2 => Err(SamplesError::TooFewRows(rows)),
            _ => Ok(Self { time_s, values }),
        }
    }

    /// Value of largest magnitude, with its sign.
    pub fn peak(&self) -> f64 {
        let larger = |peak: f64, &value: &f64| if value.abs() > peak.abs() { value } else { peak };
        self.values.iter().fold(0.0, larger)
    }

    /// The same samples, rescaled so that their largest magnitude is `peak`; a negative `peak` reverses
    /// them.
    ///
    /// # Errors
    /// [`SamplesError::ZeroForce`] for samples that are zero throughout.
    pub fn rescaled(mut self, peak: f64) -> Result<Self, SamplesError> {
        let largest = self.peak().abs();
        if largest == 0.0 {
            return Err(SamplesError::ZeroForce);
        }
        for value in &mut self.values {
            *value = *value / largest * peak;
        }
        Ok(self)
    }
}

impl From<csv::Error> for SamplesError {
    fn from(error: csv::Error) -> Self {
        // Rows of any length and any bytes are accepted, so only reading can fail.
        let kind = match error.into_kind() {
            csv::ErrorKind::Io(error) => error.kind(),
            _ => std::io::ErrorKind::InvalidData,
        };
        InputError::Unreadable(kind).into()
    }
}

fn finite(entry: &[u8], line: u64, column: &'static str) -> Result<f64, SamplesError> {
    let value = std::str::from_utf8(entry).ok().and_then(|text| text.parse().ok());
    value.filter(|value: &f64| value.is_finite()).ok_or_else(|| SamplesError::NotANumber {
        line,
        column,
        found: String::from_utf8_lossy(entry).into_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<LoadSamples, SamplesError> {
        LoadSamples::from_csv(text.as_bytes(), "force_n")
    }

    #[test]
    fn plain_crlf_and_byte_order_mark_read_the_same() {
        let plain = read("time_s,force_n\n0,0\n1e-3,-2.5\n").unwrap();
        assert_eq!(plain.time_s, [0.0, 1e-3]);
        assert_eq!(plain.values, [0.0, -2.5]);
        let odd = read("\u{feff}time_s, force_n\r\n0, 0\r\n1e-3,-2.5").unwrap();
        assert_eq!(odd, plain);
        assert_eq!(plain.peak(), -2.5);
        assert_eq!(plain.clone().rescaled(5.0).unwrap().values, [0.0, -5.0]);
    }

    #[test]
    fn errors_name_the_line() {
        let line_of = |text: &str| match read(text) {
            Err(
                SamplesError::Columns { line, .. }
                | SamplesError::NotANumber { line, .. }
                | SamplesError::TimeNotIncreasing { line, .. },
            ) => line,
            other => panic!("{other:?}"),
        };
        assert_eq!(line_of("time_s,force_n\n0,0\n1\n"), 3);
        assert_eq!(line_of("time_s,force_n\r\n0,0\r\n1,x\r\n"), 3);
        assert_eq!(line_of("time_s,force_n\n0,nan\n"), 2);
        assert_eq!(line_of("time_s,force_n\n\n0,0\n\r\n0,1"), 5);
        assert_eq!(read("time_s,force_n\n0,0\n"), Err(SamplesError::TooFewRows(1)));
        assert_eq!(read(""), Err(SamplesError::Empty("force_n")));
        let zero = read("time_s,force_n\n0,0\n1,0\n").unwrap();
        assert_eq!(zero.rescaled(1.0), Err(SamplesError::ZeroForce));
    }
}
