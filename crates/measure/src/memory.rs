//! Records in memory, read as a file.

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelQuantity, ChannelUnit, Complex64, Origin};

    fn channel(abscissa: Abscissa, samples: Samples) -> Channel {
        Channel {
            name: "a".to_owned(),
            quantity: ChannelQuantity::Unknown,
            unit: ChannelUnit::Missing,
            abscissa,
            samples,
            origin: Origin::default(),
        }
    }

    /// Blocks have their own part of samples and axis, also of channels of other lengths; each record
    /// begins anew.
    #[test]
    fn blocks_join_to_the_records() {
        let time = ChannelQuantity::Time;
        let values = vec![0.0, 1.0, 3.0, 4.0];
        let uneven = Abscissa::Uneven { values: values.clone(), quantity: time };
        let complex = values.iter().map(|x| Complex64::new(*x, 1.0)).collect();
        let channels = vec![
            channel(Abscissa::even_time(5.0, 10.0), Samples::Real(vec![1.0, 2.0, 3.0, 4.0, 5.0])),
            channel(uneven, Samples::Complex(complex)),
        ];
        let record = Record { channels, title: "t".to_owned(), ..Record::default() };
        let all = [record.clone(), record.clone()];
        for block in [1, 2, 3, 5, usize::MAX] {
            let mut source = MemoryRecords::new(&all, block);
            let mut parts: Vec<Record> = Vec::new();
            while let Some(part) = source.next_record(&mut Notices::default()).unwrap() {
                parts.push(part);
            }
            assert_eq!(parts.iter().filter(|part| !part.continues).count(), 2);
            let first: Vec<&Record> = parts[..parts.len() / 2].iter().collect();
            let joined: Vec<f64> = first
                .iter()
                .flat_map(|part| part.channels[0].samples.real().unwrap())
                .copied()
                .collect();
            assert_eq!(record.channels[0].samples.real(), Some(&joined[..]));
            let begins: Vec<f64> =
                first.iter().map(|part| part.channels[0].abscissa.at(0).unwrap()).collect();
            let expected = |n: usize| 5.0 + (n * block) as f64 * 0.1;
            assert!(begins.iter().enumerate().all(|(n, at)| (at - expected(n)).abs() < 1e-12));
            let times: Vec<f64> = first
                .iter()
                .flat_map(|part| (0..4).map_while(|n| part.channels[1].abscissa.at(n)))
                .collect();
            assert_eq!(times, values);
            assert_eq!(first.iter().map(|part| part.channels[1].samples.len()).sum::<usize>(), 4);
        }
    }
}
