//! Rows of numbers, in blocks.

use crate::heading::Heading;
use crate::notice::Notices;
use crate::rate::rounding_of;
use crate::source::Source;
use crate::text::dialect::{Dialect, is_passed_over};
use crate::text::labview::LvmSegment;
use crate::{Abscissa, Channel, ChannelUnit, MeasureError, Notice, Samples};

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
    /// Roundings of the tracked columns.
    pub(crate) roundings: Vec<Rounding>,
}

/// Columns that may be an axis, whose rounding is determined.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Tracked {
    None,
    One(usize),
    /// The first of each pair.
    Pairs,
}

impl Tracked {
    /// Index of a column among those tracked.
    fn slot(self, place: usize) -> Option<usize> {
        match self {
            Self::None => None,
            Self::One(one) => (one == place).then_some(0),
            Self::Pairs => place.is_multiple_of(2).then_some(place / 2),
        }
    }
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
}

impl RowReader<'_> {
    /// Reads up to a block of rows; fewer at the end of the segment or file.
    pub(crate) fn read(
        &mut self,
        tracked: Tracked,
        notices: &mut Notices,
    ) -> Result<RowBlock, MeasureError> {
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); self.columns.len()];
        let unknown = Rounding { significant: 1, half_unit: f64::INFINITY };
        let count_tracked =
            if let Tracked::Pairs = tracked { self.columns.len().div_ceil(2) } else { 1 };
        let mut roundings = vec![unknown; count_tracked];
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
            } else if values.first().is_some_and(|column| column.len() == column.capacity()) {
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
        if self.source.remaining() == 0 && !self.is_labview {
            self.line.clear();
        }
        Ok(RowBlock { values, count, roundings })
    }

    /// Appends the numbers of the line and returns the number of columns filled.
    fn read_row(
        &self,
        values: &mut [Vec<f64>],
        tracked: Tracked,
        roundings: &mut [Rounding],
    ) -> Result<usize, MeasureError> {
        let mut place = 0;
        let wrong = |field: &[u8], expected: String| {
            let found = String::from_utf8_lossy(field).into_owned();
            self.source.malformed(self.source.line_place(), "a field", &found, expected)
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
            let Some(value) = self.dialect.number(field) else {
                if field.is_empty() && self.source.remaining() == 0 {
                    return Ok(place);
                }
                return Err(wrong(field, format!("a number for `{}`", column.name())));
            };
            if let Some(rounding) = tracked.slot(place).and_then(|slot| roundings.get_mut(slot))
                && let Ok(printed) = std::str::from_utf8(field)
            {
                let (half_unit, significant) = rounding_of(printed);
                rounding.significant = rounding.significant.max(significant);
                rounding.half_unit = rounding.half_unit.min(half_unit);
            }
            values[place].push(value);
            place += 1;
        }
        Ok(place)
    }

    fn wrong_row(&self, filled: usize) -> MeasureError {
        let found = format!("{filled} columns");
        let expected = format!("{} columns of numbers", self.columns.len());
        self.source.malformed(self.source.line_place(), "a row", &found, expected)
    }
}
