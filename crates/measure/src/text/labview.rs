//! Headers of LabVIEW measurement files (`.lvm`).
//!
//! Source: National Instruments, "Specification for the LabVIEW Measurement
//! File (.lvm)". A file header gives separator and decimal mark; each segment
//! has a header with the start, the step and the units of its channels, a line
//! of column names, and rows whose last column is a comment.

use crate::MeasureError;
use crate::arrays::{check_channels, most_channels};
use crate::source::{Source, decode_text};
use crate::text::dialect::Dialect;

/// Start of the first line of such a file.
pub(crate) const MARK: &[u8] = b"LabVIEW Measurement";

const END: &[u8] = b"***End_of_Header***";

/// The header of the file.
#[derive(Debug, Clone)]
pub(crate) struct FileHeader {
    pub(crate) dialect: Dialect,
    /// True if rows begin with an abscissa: `X_Columns` is not `No`.
    pub(crate) has_abscissa: bool,
    /// True if every channel has its own abscissa: `X_Columns` is `Multi`.
    pub(crate) many_abscissae: bool,
    pub(crate) description: String,
    pub(crate) date: String,
}

/// Axis of a channel in the header of a segment.
#[derive(Debug, Clone, Default)]
pub(crate) struct HeaderAxis {
    /// Abscissa of the first sample.
    pub(crate) start: f64,
    /// Step; zero if none is given.
    pub(crate) step: f64,
    /// The step as printed.
    pub(crate) step_text: String,
}

/// The header of a segment.
#[derive(Debug, Clone, Default)]
pub(crate) struct LvmSegment {
    /// Start and step for each channel, or one for all.
    axes: Vec<HeaderAxis>,
    /// Names of all columns, the abscissa first.
    pub(crate) names: Vec<String>,
    /// Units of the channels.
    pub(crate) units: Vec<String>,
}

impl FileHeader {
    /// Reads the header from the start of the file.
    pub(crate) fn read(source: &mut Source<'_>) -> Result<Self, MeasureError> {
        let mut header = Self {
            dialect: Dialect { delimiter: b'\t', decimal: b'.' },
            has_abscissa: true,
            many_abscissae: false,
            description: String::new(),
            date: String::new(),
        };
        let mut line = Vec::new();
        lines_to_end(source, &mut line, |line| {
            let text = decode_text(line).0;
            let (key, value) = text.split_once(['\t', ',', ';']).unwrap_or((&text, ""));
            let value = value.trim_end_matches(['\t', ',', ';']);
            match key.trim() {
                "Separator" if value.eq_ignore_ascii_case("comma") => {
                    header.dialect.delimiter = b',';
                }
                "Decimal_Separator" if text.contains("Decimal_Separator\t,") => {
                    header.dialect.decimal = b',';
                }
                "X_Columns" => {
                    header.has_abscissa = !value.eq_ignore_ascii_case("no");
                    header.many_abscissae = value.eq_ignore_ascii_case("multi");
                }
                "Description" => value.trim().clone_into(&mut header.description),
                "Date" => value.trim().clone_into(&mut header.date),
                _ => {}
            }
        })?;
        Ok(header)
    }
}

impl LvmSegment {
    /// Reads the header of a segment and its line of names; none at the end of
    /// the file. `line` is the first line, if it has been read already.
    pub(crate) fn read(
        source: &mut Source<'_>,
        line: &mut Vec<u8>,
        dialect: Dialect,
    ) -> Result<Option<Self>, MeasureError> {
        while line.trim_ascii().is_empty() {
            if !source.read_line(line)? {
                return Ok(None);
            }
        }
        let mut segment = Self::default();
        // Too many fields are rejected with the line of names.
        let most = most_channels(source) as usize + 1;
        let mut keep = |line: &[u8]| {
            let mut fields = dialect.fields(line);
            let first = fields.next();
            let mut fields = fields.take(most);
            match first {
                Some(b"Delta_X") => segment.each_axis(&mut fields, |axis, field| {
                    axis.step = dialect.number(field).unwrap_or(0.0);
                    axis.step_text = String::from_utf8_lossy(field).into_owned();
                }),
                Some(b"X0") => segment.each_axis(&mut fields, |axis, field| {
                    axis.start = dialect.number(field).unwrap_or(0.0);
                }),
                Some(b"Y_Unit_Label") => {
                    segment.units = fields.map(|field| decode_text(field).0.into_owned()).collect();
                }
                _ => {}
            }
        };
        keep(line);
        lines_to_end(source, line, &mut keep)?;
        source.read_line(line)?;
        check_channels(source, dialect.fields(line).count() as u64)?;
        segment.names =
            dialect.fields(line).map(|field| decode_text(field).0.into_owned()).collect();
        line.clear();
        Ok(Some(segment))
    }

    /// The axis of the channel in `column`.
    pub(crate) fn axis(&self, column: usize) -> HeaderAxis {
        // The tag of a header line is in the column of the abscissa.
        self.axes.get(column.saturating_sub(1)).cloned().unwrap_or_default()
    }

    fn each_axis(
        &mut self,
        fields: &mut dyn Iterator<Item = &[u8]>,
        set: impl Fn(&mut HeaderAxis, &[u8]),
    ) {
        for (place, field) in fields.enumerate() {
            if place == self.axes.len() {
                self.axes.push(HeaderAxis::default());
            }
            set(&mut self.axes[place], field);
        }
    }

    /// True for a line that begins another segment.
    pub(crate) fn opens(line: &[u8]) -> bool {
        line.starts_with(b"Channels") || line.starts_with(b"***Start_Special***")
    }
}

fn lines_to_end(
    source: &mut Source<'_>,
    line: &mut Vec<u8>,
    mut each: impl FnMut(&[u8]),
) -> Result<(), MeasureError> {
    loop {
        if !source.read_line(line)? {
            let place = source.line_place();
            let expected = "***End_of_Header***";
            return Err(source.malformed(place, "a LabVIEW header", "cut off", expected));
        }
        if line.starts_with(END) {
            return Ok(());
        }
        each(line);
    }
}
