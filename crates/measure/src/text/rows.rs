//! Rows of numbers, in blocks.

use crate::error::excerpt;
use crate::heading::Heading;
use crate::notice::Notices;
use crate::rate::rounding_of;
use crate::source::{Source, decode_text};
use crate::text::dialect::{Dialect, is_passed_over};
use crate::text::labview::LvmSegment;
use crate::{
    Abscissa, Channel, ChannelQuantity, ChannelUnit, FilePosition, InvalidCells, MeasureError,
    Notice, Samples,
};

/// A column of numbers.
#[derive(Debug, Clone)]
pub(crate) struct NumberColumn {
    /// Index among the fields of a row, from zero.
    pub(crate) index: usize,
    pub(crate) heading: Option<Heading>,
}

impl NumberColumn {
    /// The channel of its samples.
    pub(crate) fn channel(&self, samples: Vec<f64>, abscissa: Abscissa) -> Channel {
        let unit = self.heading.as_ref().map_or(ChannelUnit::Missing, |h| h.unit.clone());
        Heading { name: self.name(), unit }.channel(abscissa, Samples::Real(samples))
    }

    /// True if the heading says that the column is time, frequency or another abscissa.
    pub(crate) fn is_axis(&self) -> bool {
        self.heading.as_ref().is_some_and(|heading| {
            matches!(heading.quantity(), ChannelQuantity::Time | ChannelQuantity::Frequency)
                || heading.name == "X_Value"
        })
    }

    /// Name of the heading, or one made from the index.
    pub(crate) fn name(&self) -> String {
        match &self.heading {
            Some(heading) if !heading.name.is_empty() => heading.name.clone(),
            _ => format!("column {}", self.index + 1),
        }
    }
}

/// A block of rows, by columns.
pub(crate) struct RowBlock {
    pub(crate) values: Vec<Vec<f64>>,
    pub(crate) count: usize,
    /// Rounding of each column, of use for those tracked.
    pub(crate) roundings: Vec<Rounding>,
}

/// Rounding of the printed numbers of a column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rounding {
    /// Most significant digits.
    significant: u32,
    /// Smallest half unit of a last digit.
    half_unit: f64,
}

impl Rounding {
    /// Largest rounding error of a number of the column, for a fixed number of decimals or of digits.
    pub(crate) fn tolerance(self, value: f64) -> f64 {
        let digits = f64::from(self.significant.min(17));
        // For zero this is minus infinity, and its power zero.
        let magnitude = value.abs().log10().floor();
        let by_digit = 0.5 * 10f64.powf(magnitude + 1.0 - digits);
        by_digit.max(self.half_unit).max(2.0 * f64::EPSILON * value.abs())
    }
}

/// Reader of rows.
pub(crate) struct RowReader<'a> {
    pub(crate) source: Source<'a>,
    pub(crate) dialect: Dialect,
    pub(crate) is_labview: bool,
    pub(crate) columns: Vec<NumberColumn>,
    /// The last line read, where it is no row.
    pub(crate) line: Vec<u8>,
    /// Most rows of a block.
    pub(crate) block: usize,
    pub(crate) invalid_cells: InvalidCells,
    /// Number of cells that were no numbers, with the place and the column of the first.
    pub(crate) invalid: Option<(u64, FilePosition, String)>,
    /// Columns that have ended, where columns may be of different lengths.
    pub(crate) ended: Option<Vec<bool>>,
}

impl RowReader<'_> {
    /// Reads up to a block of rows, and the rounding of the columns `tracked`; fewer rows at the end of
    /// the segment or file.
    pub(crate) fn read(
        &mut self,
        tracked: &[usize],
        notices: &mut Notices,
    ) -> Result<RowBlock, MeasureError> {
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); self.columns.len()];
        let unknown = Rounding { significant: 1, half_unit: f64::INFINITY };
        let mut roundings = vec![unknown; self.columns.len()];
        let mut count = 0;
        // The line that begins the next segment is kept.
        let ended = self.is_labview && LvmSegment::opens(&self.line);
        while count < self.block && !ended {
            let before = self.source.position();
            if !self.source.read_line(&mut self.line)? {
                break;
            }
            if is_passed_over(&self.line) {
                self.line.clear();
                continue;
            }
            if self.is_labview && LvmSegment::opens(&self.line) {
                break;
            }
            if count == 0 {
                let width = (self.source.position() - before).max(1);
                let left = self.source.remaining() / width + 2;
                let room = usize::try_from(left).unwrap_or(usize::MAX).min(self.block);
                for column in &mut values {
                    column.reserve_exact(room);
                }
            } else if values.iter().any(|column| column.len() == column.capacity()) {
                // In steps of an eighth, which limits unused memory.
                for column in &mut values {
                    column.reserve_exact(column.len() / 8 + 8);
                }
            }
            let filled = self.read_row(&mut values, tracked, &mut roundings)?;
            if filled < values.len() {
                if self.source.remaining() > 0 {
                    return Err(self.wrong_row(filled));
                }
                for column in &mut values {
                    column.truncate(count);
                }
                notices.add(Notice::RowCutOff { place: self.source.line_place() });
                break;
            }
            self.line.clear();
            count += 1;
        }
        if self.source.remaining() == 0 {
            if !self.is_labview {
                self.line.clear();
            }
            if let Some((count, place, channel)) = self.invalid.take() {
                let overload = self.invalid_cells == InvalidCells::Overload;
                let taken = if overload { "overloads" } else { "dropouts" };
                notices.add(Notice::InvalidCells { count, taken, place, channel });
            }
        }
        Ok(RowBlock { values, count, roundings })
    }

    /// Appends the numbers of the line and returns the number of columns filled.
    fn read_row(
        &mut self,
        values: &mut [Vec<f64>],
        tracked: &[usize],
        roundings: &mut [Rounding],
    ) -> Result<usize, MeasureError> {
        let mut place = 0;
        let source = &self.source;
        let wrong = |field: &[u8], expected: String| {
            let found = String::from_utf8_lossy(field).into_owned();
            source.malformed(source.line_place(), "a field", &found, expected)
        };
        for (index, field) in self.dialect.fields(&self.line).enumerate() {
            let Some(column) = self.columns.get(place) else {
                // The last column of LabVIEW is a comment.
                if field.is_empty() || self.is_labview {
                    continue;
                }
                return Err(wrong(field, format!("nothing after {} columns", self.columns.len())));
            };
            if index < column.index {
                continue;
            }
            if let Some(ended) = &mut self.ended {
                if field.is_empty() {
                    ended[place] = true;
                    place += 1;
                    continue;
                }
                if ended[place] {
                    return Err(wrong(field, format!("nothing more for `{}`", column.name())));
                }
            }
            let value = if let Some(value) = self.dialect.number(field) {
                value
            } else if field.is_empty() && self.source.remaining() == 0 {
                return Ok(place);
            } else {
                let at = self.source.line_place();
                if self.invalid_cells == InvalidCells::Refuse || column.is_axis() {
                    return Err(MeasureError::InvalidCell {
                        file: self.source.name().to_owned(),
                        place: at,
                        found: excerpt(&decode_text(field).0).trim_matches('`').to_owned(),
                        channel: column.name(),
                    });
                }
                let first = self.invalid.get_or_insert_with(|| (0, at, column.name()));
                first.0 += 1;
                let beyond = if field.starts_with(b"-") && !is_dashes(field) { -1.0 } else { 1.0 };
                // Nothing was measured in an empty cell.
                let overload = self.invalid_cells == InvalidCells::Overload && !field.is_empty();
                if overload { beyond * f64::INFINITY } else { f64::NAN }
            };
            if tracked.contains(&place)
                && let Some(rounding) = roundings.get_mut(place)
                && let Ok(printed) = std::str::from_utf8(field)
            {
                let (half_unit, significant) = rounding_of(printed);
                rounding.significant = rounding.significant.max(significant);
                rounding.half_unit = rounding.half_unit.min(half_unit);
            }
            values[place].push(value);
            place += 1;
        }
        if let Some(ended) = &mut self.ended
            && place > 0
        {
            ended[place..].fill(true);
            return Ok(values.len());
        }
        Ok(place)
    }

    fn wrong_row(&self, filled: usize) -> MeasureError {
        let found = format!("{filled} columns");
        let expected = format!("{} columns of numbers", self.columns.len());
        self.source.malformed(self.source.line_place(), "a row", &found, expected)
    }
}

/// True for a text of dashes only.
fn is_dashes(field: &[u8]) -> bool {
    field.iter().all(|byte| *byte == b'-')
}
