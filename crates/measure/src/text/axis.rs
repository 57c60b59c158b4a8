//! Time column and sample rate of a text.

use crate::channel::scale;
use crate::heading::Heading;
use crate::notice::Notices;
use crate::rate;
use crate::text::labview::HeaderAxis;
use crate::text::rows::{NumberColumn, Rounding};
use crate::{Abscissa, ChannelQuantity, MeasureError, Notice};

/// The axis of the channels.
#[derive(Debug, Clone)]
pub(crate) struct TextAxis {
    /// The column of the axis: time, or a count of samples.
    column: Option<usize>,
    quantity: ChannelQuantity,
    /// SI value of the unit of the column.
    factor: f64,
    even: Option<EvenAxis>,
    rounding: Rounding,
    /// True if start and step were read from the column.
    read: bool,
}

/// An even axis.
#[derive(Debug, Clone, Copy)]
struct EvenAxis {
    start: f64,
    step: f64,
    /// True for a column of exact numbers.
    exact: bool,
}

/// The inputs that determine the axis.
pub(crate) struct AxisFinder<'a> {
    pub(crate) file: &'a str,
    pub(crate) columns: &'a [NumberColumn],
    /// Axis in the header of a LabVIEW segment.
    pub(crate) header: &'a HeaderAxis,
    pub(crate) labview: bool,
    pub(crate) rate_of_options: Option<f64>,
}

/// The possible axis: the column named so, else the first of several.
pub(crate) fn candidate(columns: &[NumberColumn]) -> Option<usize> {
    named(columns).or_else(|| (columns.len() > 1).then_some(0))
}

fn named(columns: &[NumberColumn]) -> Option<usize> {
    columns.iter().position(NumberColumn::is_axis)
}

fn counts_samples(column: &NumberColumn) -> bool {
    const NAMES: [&str; 8] = ["n", "#", "index", "sample", "samples", "point", "no", "nr"];
    let name = column.heading.as_ref().map(|heading| heading.name.to_lowercase());
    name.is_some_and(|name| NAMES.contains(&name.as_str()))
}

impl AxisFinder<'_> {
    /// The axis from the first block of rows.
    pub(crate) fn find(
        &self,
        values: &[Vec<f64>],
        rounding: Rounding,
        notices: &mut Notices,
    ) -> Result<TextAxis, MeasureError> {
        let column = candidate(self.columns);
        let axis = |quantity, factor, even| TextAxis {
            column,
            quantity,
            factor,
            even,
            rounding,
            read: true,
        };
        if let Some(place) = named(self.columns) {
            let heading = self.columns[place].heading.as_ref();
            let quantity = match heading.map(Heading::quantity) {
                Some(ChannelQuantity::Frequency) => ChannelQuantity::Frequency,
                _ => ChannelQuantity::Time,
            };
            let unit = heading.and_then(|heading| heading.unit.known());
            let factor = unit.map_or(1.0, |unit| unit.factor());
            let even = self.by_header(&values[place], rounding, notices);
            let even =
                even.or_else(|| even_axis(&values[place], factor, quantity, rounding, notices));
            return Ok(axis(quantity, factor, even));
        }
        if self.labview && self.header.step > 0.0 {
            let (start, step) = (self.header.start, self.step_of_header(notices));
            let even = EvenAxis { start, step, exact: true };
            return Ok(TextAxis { column: None, ..axis(ChannelQuantity::Time, 1.0, Some(even)) });
        }
        let rising = column.filter(|&place| values[place].len() > 2).and_then(|place| {
            let (quantity, mut ignored) = (ChannelQuantity::Time, Notices::default());
            let even = even_axis(&values[place], 1.0, quantity, rounding, &mut ignored);
            even.map(|even| (place, even))
        });
        if let Some((place, EvenAxis { start, step, .. })) = rising {
            let name = self.columns[place].name();
            let counts = step == 1.0 && start.fract() == 0.0;
            if !counts && !counts_samples(&self.columns[place]) {
                notices.add(Notice::TimeByValues { column: name });
                let even = even_axis(&values[place], 1.0, ChannelQuantity::Time, rounding, notices);
                return Ok(axis(ChannelQuantity::Time, 1.0, even));
            }
            notices.left_out(name, "it counts the samples");
            let even = Some(self.by_rate(notices)?);
            return Ok(TextAxis { read: false, ..axis(ChannelQuantity::Time, 1.0, even) });
        }
        let even = self.by_rate(notices)?;
        Ok(TextAxis { column: None, ..axis(ChannelQuantity::Time, 1.0, Some(even)) })
    }

    fn by_rate(&self, notices: &mut Notices) -> Result<EvenAxis, MeasureError> {
        let rate_hz = rate::of_options(self.file, self.rate_of_options, notices)?;
        Ok(EvenAxis { start: 0.0, step: 1.0 / rate_hz, exact: true })
    }

    /// The axis of a LabVIEW header, with more digits than the column.
    fn by_header(
        &self,
        values: &[f64],
        rounding: Rounding,
        notices: &mut Notices,
    ) -> Option<EvenAxis> {
        let start = *values.first().filter(|_| self.labview && self.header.step > 0.0)?;
        let step = self.step_of_header(notices);
        let tolerance =
            |value, expected: f64| 3.0 * rounding.tolerance(value) + 1e-9 * expected.abs();
        rate::is_even(values, (start, step), tolerance).then_some(EvenAxis {
            start,
            step,
            exact: false,
        })
    }

    fn step_of_header(&self, notices: &mut Notices) -> f64 {
        let uncertainty = rate::uncertainty_of_printed_step(&self.header.step_text);
        rate::snapped_step(self.header.step, uncertainty, notices)
    }
}

impl TextAxis {
    /// The column of the axis.
    pub(crate) fn column(&self) -> Option<usize> {
        self.column
    }

    /// The abscissa of a block from row `from`, removed from the columns.
    pub(crate) fn take_abscissa(
        &self,
        values: &mut [Vec<f64>],
        from: u64,
        notices: &mut Notices,
    ) -> Abscissa {
        let quantity = self.quantity;
        let column = self.column.map(|place| std::mem::take(&mut values[place]));
        // A count of samples is not time.
        let checked = from > 0 && self.read && column.is_some();
        let mut values = column.unwrap_or_default();
        if let Some(EvenAxis { start, step, exact }) = self.even {
            let start = start + from as f64 * step;
            let carries_on = |(index, &value): (usize, &f64)| {
                let expected = start + index as f64 * step;
                let rounding = if exact { 0.0 } else { self.rounding.tolerance(value) };
                let tolerance = 3.0 * self.factor * rounding + 1e-9 * expected.abs();
                (value * self.factor - expected).abs() <= tolerance
            };
            if !checked || values.iter().enumerate().all(carries_on) {
                return Abscissa::Even { start, step, quantity };
            }
            notices.add(Notice::UnevenBlock { sample: from });
        }
        scale(&mut values, self.factor);
        Abscissa::Uneven { values, quantity }
    }
}

/// True for three or more values that rise evenly and do not count the samples.
pub(crate) fn rises_evenly(values: &[f64], rounding: Rounding) -> bool {
    let (time, mut ignored) = (ChannelQuantity::Time, Notices::default());
    let even = (values.len() > 2).then(|| even_axis(values, 1.0, time, rounding, &mut ignored));
    even.flatten().is_some_and(|even| !(even.step == 1.0 && even.start.fract() == 0.0))
}

/// Start and step of an evenly increasing column, exactly or within the rounding of its digits.
fn even_axis(
    values: &[f64],
    factor: f64,
    quantity: ChannelQuantity,
    rounding: Rounding,
    notices: &mut Notices,
) -> Option<EvenAxis> {
    let mut ignored = Notices::default();
    let notices = if quantity == ChannelQuantity::Time { notices } else { &mut ignored };
    let scaled: Vec<f64>;
    let values = if factor == 1.0 {
        values
    } else {
        scaled = values.iter().map(|value| value * factor).collect();
        &scaled
    };
    if let Some((start, step)) = rate::even_axis(values, |_| 0.0, notices) {
        return Some(EvenAxis { start, step, exact: true });
    }
    let tolerance = |value| factor * rounding.tolerance(value / factor);
    let (start, step) = rate::even_axis(values, tolerance, notices)?;
    Some(EvenAxis { start, step, exact: false })
}
