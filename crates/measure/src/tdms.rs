//! TDMS of National Instruments.
//!
//! Source: National Instruments, "TDMS File Format Internal Structure". A file
//! is a sequence of segments, each with raw data and the metadata changed since the segment
//! before. A first pass reads lead-ins and metadata; samples are
//! then read in blocks, together for the channels of common chunks.
//!
//! Linear and polynomial scales are applied; a channel with another scale is
//! rejected, since its samples would not be in its unit, and so is raw data of the
//! driver NI-DAQmx, whose format depends on the device.
//!
//! | module | contents |
//! |---|---|
//! | `segment`, `index` | segments, and the first pass |
//! | `property`, `object` | properties and objects of the metadata |
//! | `extent`, `chunk_group` | positions of samples, and reading them |
//! | `gather`, `waveform`, `axis` | channels sampled together, and their axis |
//! | `scale` | raw samples to samples in the unit of the channel |

mod axis;
mod chunk_group;
mod extent;
mod gather;
mod index;
mod object;
mod property;
mod scale;
mod segment;
mod waveform;

use crate::decoding::Budget;
use crate::decoding::Records;
use crate::notice::Notices;
use crate::source::Source;
use crate::{
    Channel, ChannelQuantity, FilePosition, Format, MeasureError, Origin, ReadOptions, Record,
    Samples,
};

use axis::TdmsAxis;
use gather::ChannelGroup;
use index::TdmsIndex;
use object::ObjectPath;
use object::TdmsObject;

/// Buffers of the source and of interleaved rows.
const BUFFERS: u64 = 1 << 17;

/// A TDMS file being read.
pub(crate) struct Tdms<'a> {
    source: Source<'a>,
    objects: Vec<TdmsObject>,
    records: std::vec::IntoIter<ChannelGroup>,
    /// The current record, its axis, and its next sample.
    current: Option<(ChannelGroup, TdmsAxis, u64)>,
    block: u64,
    rate_of_options: Option<f64>,
}

impl<'a> Tdms<'a> {
    pub(crate) fn open(
        mut source: Source<'a>,
        options: &ReadOptions,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        let mut budget = Budget::new(&source, options);
        budget.take(BUFFERS, FilePosition::Offset(0), "the buffers")?;
        let TdmsIndex { objects, mut budget, .. } = TdmsIndex::read(&mut source, budget, notices)?;
        let records = gather::gather(&source, &objects, &mut budget, notices)?;
        if records.is_empty() {
            let file = source.name().to_owned();
            return Err(MeasureError::NoSamples { file, expected: "channels of numbers" });
        }
        Ok(Self {
            source,
            objects,
            records: records.into_iter(),
            current: None,
            block: options.block as u64,
            rate_of_options: options.sample_rate_hz,
        })
    }
}

impl Records for Tdms<'_> {
    fn format(&self) -> Format {
        Format::Tdms
    }

    fn next_record(&mut self, notices: &mut Notices) -> Result<Option<Record>, MeasureError> {
        let (source, objects) = (&mut self.source, &self.objects);
        let (mut record, mut axis, from) = if let Some(current) = self.current.take() {
            current
        } else {
            let Some(record) = self.records.next() else { return Ok(None) };
            let axis = TdmsAxis::of(source, &record, objects, self.rate_of_options, notices)?;
            (record, axis, 0)
        };
        let count = (record.samples - from).min(self.block);
        let column = || Vec::with_capacity(count as usize);
        let mut columns: Vec<Vec<f64>> = record.members.iter().map(|_| column()).collect();
        for chunk_group in &mut record.chunk_groups {
            chunk_group.read(source, objects, count, &mut columns)?;
        }
        for (member, column) in record.members.iter().zip(&mut columns) {
            member.scales.apply(column);
        }
        let abscissa = axis.abscissa(from, &mut columns, notices);
        let left_out = if let TdmsAxis::Times(times) = &axis { Some(times.slot) } else { None };
        let date = record.waveform.time.map_or(String::new(), |time| time.to_string());
        let mut channels = Vec::with_capacity(columns.len());
        for (slot, (member, samples)) in record.members.iter().zip(columns).enumerate() {
            let object = &objects[member.object];
            let ObjectPath::Channel(_, name) = &object.path else { continue };
            if left_out == Some(slot) {
                continue;
            }
            let heading = waveform::heading(name, &object.properties);
            let description = waveform::text(&object.properties, "description");
            channels.push(Channel {
                name: heading.name,
                quantity: ChannelQuantity::Unknown,
                unit: heading.unit,
                abscissa: abscissa.clone(),
                samples: Samples::Real(samples),
                origin: Origin {
                    description: description.unwrap_or_default().to_owned(),
                    date: date.clone(),
                    ..Origin::default()
                },
            });
        }
        let title = record.group.clone();
        if from + count < record.samples {
            self.current = Some((record, axis, from + count));
        }
        Ok(Some(Record { channels, continues: from > 0, title, date }))
    }
}
