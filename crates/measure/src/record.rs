//! Records of channels sampled together.

use crate::{Channel, ChannelQuantity, Format, Notice};

/// Channels sampled together: one hit, or one block of a long measurement.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// The channels, in the order of the file.
    pub channels: Vec<Channel>,
    /// True if the record continues the previous record.
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

    /// Number of samples of the longest channel.
    pub fn len(&self) -> usize {
        self.channels.iter().map(|channel| channel.samples.len()).max().unwrap_or(0)
    }

    /// True without samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Sample rate \[Hz\], if all channels have the same.
    pub fn sample_rate_hz(&self) -> Option<f64> {
        let rate = self.channels.first()?.sample_rate_hz()?;
        let same = self.channels.iter().all(|channel| channel.sample_rate_hz() == Some(rate));
        same.then_some(rate)
    }
}

/// The content of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Format of the file.
    pub format: Format,
    /// The records, in the order of the file, not divided into blocks.
    pub records: Vec<Record>,
    /// Assumptions and observations of the reader.
    pub notices: Vec<Notice>,
}

/// The length of channel `index` of joined records.
pub(crate) fn joined_len(parts: &[&Record], index: usize) -> usize {
    parts.iter().map(|part| part.channels[index].samples.len()).sum()
}
