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
use gather::ChannelGroup;

/// A TDMS file being read.
pub(crate) struct Tdms<'a> {
    name: String,
    file: TdmsFile<Box<dyn ByteStream + 'a>>,
    records: std::vec::IntoIter<ChannelGroup>,
    /// The current record, its axis, and its next sample.
    current: Option<(ChannelGroup, TdmsAxis, u64)>,
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
        for record in &records {
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
        let (mut record, mut axis, from) = if let Some(current) = self.current.take() {
            current
        } else {
            let Some(record) = self.records.next() else { return Ok(None) };
            let (objects, rate) = (self.file.objects(), self.rate_of_options);
            let axis = TdmsAxis::of(&self.name, &record, objects, rate, notices)?;
            (record, axis, 0)
        };
        let count = (record.samples - from).min(self.block);
        let columns = self.file.read(&mut record.selection, count);
        let mut columns = columns.map_err(|error| MeasureError::of_tdms(&self.name, error))?;
        let abscissa = axis.abscissa(from, &mut columns, notices);
        let left_out = if let TdmsAxis::Times(times) = &axis { Some(times.slot) } else { None };
        let date = record.waveform.time.map_or(String::new(), |time| time.to_string());
        let mut channels = Vec::with_capacity(columns.len());
        for (slot, (id, samples)) in record.channels.iter().zip(columns).enumerate() {
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
        let title = record.group.clone();
        if from + count < record.samples {
            self.current = Some((record, axis, from + count));
        }
        Ok(Some(Record { channels, continues: from > 0, title, date }))
    }
}
