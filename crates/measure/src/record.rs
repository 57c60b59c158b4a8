//! Channels sampled together, and all that a file holds.

use crate::{Channel, ChannelQuantity, Format, Notice};

/// Channels sampled together: one hit, or one block of a long measurement.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// The channels, in the order of the file.
    pub channels: Vec<Channel>,
    /// Whether it carries on where the record before it ended.
    pub continues: bool,
    /// Title of the measurement, if the file gives one.
    pub title: String,
    /// Date of the measurement as written, if the file gives one.
    pub date: String,
}

impl Record {
    /// The first channel of a quantity.
    pub fn of_quantity(&self, quantity: ChannelQuantity) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.quantity == quantity)
    }

    /// The channel of a name.
    pub fn named(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// Samples of each channel; of the longest, should they differ.
    pub fn len(&self) -> usize {
        self.channels.iter().map(|channel| channel.samples.len()).max().unwrap_or(0)
    }

    /// Whether it has no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Samples per second, where every channel has the same.
    pub fn sample_rate_hz(&self) -> Option<f64> {
        let rate = self.channels.first()?.sample_rate_hz()?;
        let same = self.channels.iter().all(|channel| channel.sample_rate_hz() == Some(rate));
        same.then_some(rate)
    }
}

/// All that a file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// The format found.
    pub format: Format,
    /// The records, in the order of the file, none of them in blocks.
    pub records: Vec<Record>,
    /// What was snapped, assumed or odd.
    pub notices: Vec<Notice>,
}
