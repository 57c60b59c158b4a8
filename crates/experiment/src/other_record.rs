//! A channel that is not in the record of the others, and the reason.

use std::path::Path;

use asperity_measure::{Abscissa, Channel, Reader, Record};

use crate::channel::{ChannelRole, ChannelSelector, choose};
use crate::error::AnalysisError;

/// Axis of a record.
#[derive(Debug, Clone)]
pub(crate) struct RecordAxis {
    number: usize,
    rate_hz: Option<f64>,
    start_s: f64,
    samples: usize,
    date: String,
}

impl RecordAxis {
    /// The axis of the first channel of record `number`, from 1.
    pub(crate) fn of(number: usize, record: &Record) -> Option<Self> {
        record.channels.first().map(|channel| Self::of_channel(number, channel))
    }

    pub(crate) fn of_channel(number: usize, channel: &Channel) -> Self {
        Self {
            number,
            rate_hz: channel.sample_rate_hz(),
            start_s: channel.abscissa.at(0).unwrap_or(0.0),
            samples: channel.samples.len(),
            date: channel.origin.date.clone(),
        }
    }

    /// Reason that the channels of two records are not in one.
    pub(crate) fn reason(&self, other: &Self) -> String {
        let rate = |axis: &Self| match axis.rate_hz {
            Some(rate) => format!("{rate} Hz"),
            None => "uneven times".to_owned(),
        };
        let (own, others) = (rate(self), rate(other));
        if own != others {
            return format!("they have different rates: {own} and {others}");
        }
        if !self.date.is_empty() && self.date != other.date && !other.date.is_empty() {
            return format!("their start times differ: {} and {}", self.date, other.date);
        }
        if self.start_s != other.start_s {
            return format!("they start at {} s and {} s", self.start_s, other.start_s);
        }
        if self.samples != other.samples {
            return format!("they have {} and {} samples", self.samples, other.samples);
        }
        "nothing in the file says that they were sampled together".to_owned()
    }
}

/// The error of a channel that is missing in record `first` and is in a later one; else `missing`.
pub(crate) fn in_other_record(
    missing: AnalysisError,
    file: &Path,
    first: &RecordAxis,
    later: impl Iterator<Item = Record>,
    wanted: (Option<&ChannelSelector>, Option<&ChannelSelector>),
) -> AnalysisError {
    let AnalysisError::NoChannel { role, .. } = &missing else { return missing };
    let role = if *role == ChannelRole::Force.name() {
        (ChannelRole::Force, wanted.0)
    } else {
        (ChannelRole::Response, wanted.1)
    };
    let mut number = first.number;
    for record in later {
        number += usize::from(!record.continues);
        if number == first.number {
            continue;
        }
        let found = match choose(file, &record, role.0, role.1) {
            Ok(place) => place,
            Err(AnalysisError::Ambiguous { .. }) => 0,
            Err(_) => continue,
        };
        let channel = &record.channels[found];
        return AnalysisError::OtherRecord {
            file: file.to_owned(),
            role: role.0.name(),
            channel: channel.name.clone(),
            record: number,
            other: first.number,
            reason: first.reason(&RecordAxis::of_channel(number, channel)),
        };
    }
    missing
}

/// Records of a reader up to its first error.
pub(crate) struct Rest<'r, 'a>(pub(crate) &'r mut Reader<'a>);

impl Iterator for Rest<'_, '_> {
    type Item = Record;

    fn next(&mut self) -> Option<Record> {
        self.0.next_record().unwrap_or(None)
    }
}

/// Rates and starts of channels, for a message.
pub(crate) fn axes_in_words<'a>(channels: impl Iterator<Item = &'a Channel>) -> String {
    let one = |channel: &Channel| match &channel.abscissa {
        Abscissa::Even { start, .. } => {
            let rate = channel.sample_rate_hz().unwrap_or(f64::NAN);
            format!("`{}` at {rate:.6} Hz from {start:.6} s", channel.name)
        }
        Abscissa::Uneven { .. } => format!("`{}` at uneven times", channel.name),
    };
    channels.map(one).collect::<Vec<_>>().join(", ")
}
