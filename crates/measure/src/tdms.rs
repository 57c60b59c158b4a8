//! TDMS of National Instruments: objects of a [`TdmsFile`] to channels with axis and unit.
//!
//! | module | contents |
//! |---|---|
//! | `gather`, `waveform`, `axis` | channels sampled together, and their axis |

mod axis;
mod gather;
mod waveform;

use crate::tdms_file::{TdmsFile, TdmsOptions, TdmsPath};

use crate::decoding::Records;
use crate::notice::Notices;
use crate::source::Source;
use crate::{
    ByteStream, Channel, FilePosition, Format, MeasureError, Notice, Origin, ReadOptions, Record,
    Samples,
};

use axis::TdmsAxis;
use gather::{ChannelGroup, TdmsRecord};

/// A TDMS file being read.
pub(crate) struct Tdms<'a> {
    name: String,
    file: TdmsFile<Box<dyn ByteStream + 'a>>,
    records: std::vec::IntoIter<TdmsRecord>,
    /// The parts of the current record with their axes, and its next sample.
    current: Option<(Vec<(ChannelGroup, TdmsAxis)>, u64)>,
    block: u64,
    rate_of_options: Option<f64>,
}

impl<'a> Tdms<'a> {
    pub(crate) fn open(
        source: Source<'a>,
        options: &ReadOptions,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        let (name, stream) = (source.name().to_owned(), source.into_stream());
        let tdms = TdmsOptions { expansion: options.expansion, keep: waveform::is_used };
        let file =
            TdmsFile::open(stream, &tdms).map_err(|error| MeasureError::of_tdms(&name, error));
        let mut file = file?;
        if let Some(offset) = file.cut_off() {
            notices.add(Notice::SegmentCutOff { place: FilePosition::Offset(offset) });
        }
        let records = gather::gather(&name, &mut file, notices)?;
        // Uneven times are kept for every channel.
        for (record, _) in records.iter().flat_map(|record| &record.parts) {
            if axis::times_of(record, file.objects()).is_some() {
                let times = record.samples.saturating_mul(8 * record.channels.len() as u64);
                let reserved = file.reserve(times, "the times");
                reserved.map_err(|error| MeasureError::of_tdms(&name, error))?;
            }
        }
        if records.is_empty() {
            return Err(MeasureError::NoSamples { file: name, expected: "channels of numbers" });
        }
        Ok(Self {
            name,
            file,
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
        let (mut parts, from) = if let Some(current) = self.current.take() {
            current
        } else {
            let Some(record) = self.records.next() else { return Ok(None) };
            let (objects, rate) = (self.file.objects(), self.rate_of_options);
            let mut parts = Vec::with_capacity(record.parts.len());
            for (part, after) in record.parts {
                let axis = TdmsAxis::of(&self.name, &part, objects, rate, notices)?;
                parts.push((part, axis.later(after)));
            }
            (parts, 0)
        };
        let first = &parts[0].0;
        let (title, date) = (first.group.clone(), date_of(first));
        let (mut channels, mut next) = (Vec::new(), None);
        for (part, axis) in &mut parts {
            channels.extend(self.channels(part, axis, from, notices)?);
            if part.samples > from.saturating_add(self.block) {
                next = Some(from + self.block);
            }
        }
        self.current = next.map(|next| (parts, next));
        Ok(Some(Record { channels, continues: from > 0, title, date }))
    }
}

impl Tdms<'_> {
    /// The next block of channels; empty ones after their end.
    fn channels(
        &mut self,
        part: &mut ChannelGroup,
        axis: &mut TdmsAxis,
        from: u64,
        notices: &mut Notices,
    ) -> Result<Vec<Channel>, MeasureError> {
        let count = part.samples.saturating_sub(from).min(self.block);
        let columns = if count > 0 {
            self.file.read(&mut part.selection, count)
        } else {
            Ok(vec![Vec::new(); part.channels.len()])
        };
        let mut columns = columns.map_err(|error| MeasureError::of_tdms(&self.name, error))?;
        let abscissa = axis.abscissa(from, &mut columns, notices);
        let left_out = if let TdmsAxis::Times(times) = &axis { Some(times.slot) } else { None };
        let date = date_of(part);
        let mut channels = Vec::with_capacity(columns.len());
        for (slot, (id, samples)) in part.channels.iter().zip(columns).enumerate() {
            let object = &self.file.objects()[*id];
            let TdmsPath::Channel(_, name) = object.path() else { continue };
            if left_out == Some(slot) {
                continue;
            }
            let heading = waveform::heading(name, object);
            let description = waveform::text(object, "description").unwrap_or_default().to_owned();
            let origin = Origin { description, date: date.clone(), ..Origin::default() };
            let channel = heading.channel(abscissa.clone(), Samples::Real(samples));
            channels.push(Channel { origin, ..channel });
        }
        Ok(channels)
    }
}

fn date_of(part: &ChannelGroup) -> String {
    part.waveform.time.map_or(String::new(), |time| time.to_string())
}
