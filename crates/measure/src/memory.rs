//! Records in memory, read as those of a file.

use crate::decoding::Records;
use crate::notice::Notices;
use crate::{Abscissa, Channel, Format, MeasureError, Record, Samples};

/// Records in memory, divided into blocks.
pub(crate) struct MemoryRecords<'a> {
    records: std::slice::Iter<'a, Record>,
    /// The record under way, and its samples read so far.
    current: Option<(&'a Record, usize)>,
    /// Most samples of a block.
    block: usize,
}

impl<'a> MemoryRecords<'a> {
    pub(crate) fn new(records: &'a [Record], block: usize) -> Self {
        Self { records: records.iter(), current: None, block }
    }
}

impl Records for MemoryRecords<'_> {
    fn format(&self) -> Format {
        Format::Memory
    }

    fn next_record(&mut self, _: &mut Notices) -> Result<Option<Record>, MeasureError> {
        let next = || self.records.next().map(|record| (record, 0));
        let Some((record, begin)) = self.current.take().or_else(next) else { return Ok(None) };
        let end = record.len().min(begin.saturating_add(self.block));
        if end < record.len() {
            self.current = Some((record, end));
        }
        Ok(Some(Record {
            channels: record.channels.iter().map(|channel| part(channel, begin, end)).collect(),
            continues: record.continues || begin > 0,
            title: record.title.clone(),
            date: record.date.clone(),
        }))
    }
}

/// The samples of a channel from `begin` to `end`, or to its own end.
fn part(channel: &Channel, begin: usize, end: usize) -> Channel {
    let all = channel.samples.len();
    let range = begin.min(all)..end.min(all);
    let samples = match &channel.samples {
        Samples::Real(values) => Samples::Real(values[range].to_vec()),
        Samples::Complex(values) => Samples::Complex(values[range].to_vec()),
    };
    let abscissa = match &channel.abscissa {
        Abscissa::Even { start, step, quantity } => {
            Abscissa::Even { start: start + begin as f64 * step, step: *step, quantity: *quantity }
        }
        Abscissa::Uneven { values, quantity } => {
            let range = begin.min(values.len())..end.min(values.len());
            Abscissa::Uneven { values: values[range].to_vec(), quantity: *quantity }
        }
    };
    Channel {
        name: channel.name.clone(),
        quantity: channel.quantity,
        unit: channel.unit.clone(),
        abscissa,
        samples,
        origin: channel.origin.clone(),
    }
}
