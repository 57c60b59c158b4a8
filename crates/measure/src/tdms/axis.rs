//! Axis of a record.

use crate::tdms_file::{TdmsObject, TdmsPath};

use crate::channel::scale;
use crate::notice::Notices;
use crate::tdms::gather::ChannelGroup;
use crate::tdms::waveform;
use crate::{Abscissa, ChannelQuantity, MeasureError, rate};

/// The axis of a record.
#[derive(Debug)]
pub(crate) enum TdmsAxis {
    /// Start and step, from properties or options.
    Even(f64, f64, ChannelQuantity),
    /// A channel of times.
    Times(Times),
}

/// A channel with the times of the others.
#[derive(Debug)]
pub(crate) struct Times {
    /// Index of the channel.
    pub(crate) slot: usize,
    /// SI value of its unit.
    factor: f64,
    /// Start and step of its first block, if even.
    even: Option<(f64, f64)>,
}

impl TdmsAxis {
    /// The axis from `wf_increment`, else from a channel named time, else from the rate of the options.
    pub(crate) fn of(
        file: &str,
        record: &ChannelGroup,
        objects: &[TdmsObject],
        rate_of_options: Option<f64>,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        if let Some((start, step)) = record.waveform.even {
            return Ok(Self::Even(start, step, record.waveform.quantity));
        }
        if let Some(times) = times_of(record, objects) {
            return Ok(Self::Times(times));
        }
        let rate_hz = rate::of_options(file, rate_of_options, notices)?;
        Ok(Self::Even(0.0, 1.0 / rate_hz, ChannelQuantity::Time))
    }

    /// The axis, with its start later by some seconds.
    pub(crate) fn later(self, seconds: f64) -> Self {
        match self {
            Self::Even(start, step, quantity) => Self::Even(start + seconds, step, quantity),
            times @ Self::Times(_) => times,
        }
    }

    /// The abscissa of a block from sample `from`.
    pub(crate) fn abscissa(
        &mut self,
        from: u64,
        columns: &mut [Vec<f64>],
        notices: &mut Notices,
    ) -> Abscissa {
        match self {
            Self::Even(start, step, quantity) => {
                let (step, quantity) = (*step, *quantity);
                Abscissa::Even { start: *start + from as f64 * step, step, quantity }
            }
            Self::Times(times) => {
                let mut values = std::mem::take(&mut columns[times.slot]);
                scale(&mut values, times.factor);
                times.abscissa(from, values, notices)
            }
        }
    }
}

/// The channel of times of a record without a step: one of several channels, by its name.
pub(crate) fn times_of(record: &ChannelGroup, objects: &[TdmsObject]) -> Option<Times> {
    let times = record.channels.iter().enumerate().find_map(|(slot, id)| {
        let TdmsPath::Channel(_, name) = objects[*id].path() else { return None };
        let heading = waveform::heading(name, &objects[*id]);
        let factor = heading.unit.known().map_or(1.0, |unit| unit.factor());
        let is_time = heading.quantity() == ChannelQuantity::Time;
        is_time.then_some(Times { slot, factor, even: None })
    });
    times.filter(|_| record.waveform.even.is_none() && record.channels.len() > 1)
}

impl Times {
    fn abscissa(&mut self, from: u64, values: Vec<f64>, notices: &mut Notices) -> Abscissa {
        let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        if from == 0 {
            // Times may have single precision.
            let tolerance = |_| f64::from(f32::EPSILON) * largest;
            let exact = rate::even_axis(&values, |_| 0.0, notices);
            self.even = exact.or_else(|| rate::even_axis(&values, tolerance, notices));
        }
        let Some(even) = self.even else {
            return Abscissa::Uneven { values, quantity: ChannelQuantity::Time };
        };
        let tolerance = 4.0 * f64::from(f32::EPSILON) * largest.max(even.1);
        Abscissa::continued(even, from, values, |_| tolerance, notices)
    }
}
