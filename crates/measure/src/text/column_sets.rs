//! Columns with a common time column; a text may have a time column for each channel.
//!
//! In LabVIEW files with `X_Columns` `Multi` columns are pairs of abscissa and channel, with start and
//! step of the channel in the header. In other texts several columns that are named time, or that rise
//! evenly without a name, are the times of the channels that names or places say.

use crate::notice::Notices;
use crate::text::Text;
use crate::text::axis::{TextAxis, candidate, rises_evenly};
use crate::text::rows::{NumberColumn, Rounding};
use crate::time_match::{TimeVectors, Vector, time_vectors};
use crate::{Abscissa, Channel, ChannelQuantity, MeasureError};

/// Columns of the reader that share an axis, by their places there.
pub(crate) struct ColumnSet {
    places: Vec<usize>,
    /// None before the first block.
    axis: Option<TextAxis>,
}

/// Columns tracked at least for times that have no name.
const FEWEST_UNNAMED: usize = 4;

impl Text<'_> {
    /// The sets of the columns, by headings and the first block.
    pub(crate) fn column_sets(
        &mut self,
        values: &[Vec<f64>],
        roundings: &[Rounding],
        notices: &mut Notices,
    ) -> Result<Vec<ColumnSet>, MeasureError> {
        let columns = &self.reader.columns;
        let set = |places: Vec<usize>| ColumnSet { places, axis: None };
        if columns.is_empty() {
            return Ok(Vec::new());
        }
        if self.has_pairs() {
            if !columns.len().is_multiple_of(2) {
                let found = format!("{} columns", columns.len());
                let expected = "pairs of columns, as X_Columns is Multi";
                let last = self.reader.source.line_place();
                return Err(self.reader.source.malformed(last, "a row", &found, expected));
            }
            return Ok((0..columns.len()).step_by(2).map(|at| set(vec![at, at + 1])).collect());
        }
        let all = || set((0..columns.len()).collect());
        let times = self.times(values, roundings);
        if times.len() < 2 {
            return Ok(vec![all()]);
        }
        let names: Vec<String> = columns.iter().map(NumberColumn::name).collect();
        let mut vectors = Vec::with_capacity(columns.len());
        for (at, name) in names.iter().enumerate() {
            let own = times.contains(&at).then_some(values[at].as_slice());
            vectors.push(Vector { name, length: values[at].len(), times: own });
        }
        match time_vectors(self.reader.source.name(), &vectors)? {
            TimeVectors::OfEach(time_of) => {
                let of = |time: usize| {
                    let others =
                        (0..columns.len()).filter(|at| time_of[*at] == time && *at != time);
                    set(std::iter::once(time).chain(others).collect())
                };
                Ok(times.iter().copied().map(of).collect())
            }
            TimeVectors::First(others) => {
                for other in &others {
                    notices.left_out(names[*other].as_str(), "a second time of the same samples");
                }
                Ok(vec![set((0..columns.len()).filter(|at| !others.contains(at)).collect())])
            }
        }
    }

    /// Places of the columns that are times: named so and rising, or, without a name, rising evenly.
    fn times(&self, values: &[Vec<f64>], roundings: &[Rounding]) -> Vec<usize> {
        let columns = &self.reader.columns;
        let is_named = |at: &usize| {
            let heading = columns[*at].heading.as_ref();
            heading.is_some_and(|heading| heading.quantity() == ChannelQuantity::Time)
        };
        let rises = |at: &usize| {
            values[*at].len() > 1 && values[*at].windows(2).all(|pair| pair[1] > pair[0])
        };
        let named: Vec<usize> = (0..columns.len()).filter(|at| is_named(at) && rises(at)).collect();
        if !named.is_empty() || columns.iter().any(NumberColumn::is_axis) {
            return named;
        }
        let rises_evenly = |at: &usize| rises_evenly(&values[*at], roundings[*at]);
        let rising: Vec<usize> = (0..columns.len()).filter(rises_evenly).collect();
        if columns.len() < FEWEST_UNNAMED || rising.first() != Some(&0) { vec![] } else { rising }
    }

    /// Channels of a set with their places, whose values are taken.
    pub(crate) fn channels_of(
        &mut self,
        set: &mut ColumnSet,
        values: &mut [Vec<f64>],
        roundings: &[Rounding],
        notices: &mut Notices,
    ) -> Result<Vec<(usize, Channel)>, MeasureError> {
        let mut own: Vec<Vec<f64>> =
            set.places.iter().map(|place| std::mem::take(&mut values[*place])).collect();
        let columns: Vec<NumberColumn> =
            set.places.iter().map(|place| self.reader.columns[*place].clone()).collect();
        let axis = if let Some(axis) = set.axis.take() {
            axis
        } else {
            let header = self.segment.axis(if self.has_pairs() { set.places[0] + 1 } else { 0 });
            let rounding = roundings[set.places[candidate(&columns).unwrap_or(0)]];
            self.finder(&columns, &header).find(&own, rounding, notices)?
        };
        let abscissa = axis.take_abscissa(&mut own, self.rows, notices);
        if self.has_pairs() && matches!(abscissa, Abscissa::Uneven { .. }) {
            let expected = "an even step in every block up to this line";
            let (quantity, name) = ("the X column of a channel", columns[1].name());
            let (found, last) = (format!("uneven for {name}"), self.reader.source.line_place());
            return Err(self.reader.source.malformed(last, quantity, &found, expected));
        }
        let left_out = axis.column();
        set.axis = Some(axis);
        let channels = columns.iter().zip(own).enumerate();
        let kept = channels.filter(|(at, _)| left_out != Some(*at));
        Ok(kept
            .map(|(at, (column, samples))| {
                (set.places[at], column.channel(samples, abscissa.clone()))
            })
            .collect())
    }
}
