//! RIFF WAVE, with samples as fractions of the converter's full scale.

use hound::{SampleFormat, WavReader};

use crate::decoding::Records;
use crate::heading::Heading;
use crate::notice::Notices;
use crate::source::Source;
use crate::{
    Abscissa, ChannelQuantity, ChannelUnit, FilePosition, Format, MeasureError, ReadOptions,
    Record, Samples,
};

/// A WAVE file being read.
pub(crate) struct Wav<'a> {
    file: String,
    reader: WavReader<Source<'a>>,
    next: u64,
    frames: u64,
    block: u64,
}

impl<'a> Wav<'a> {
    pub(crate) fn open(source: Source<'a>, options: &ReadOptions) -> Result<Self, MeasureError> {
        let (file, length) = (source.name().to_owned(), source.len());
        let reader = WavReader::new(source).map_err(|error| wrong(&file, &error))?;
        let spec = reader.spec();
        let malformed = |quantity, found: String, expected: &str| {
            MeasureError::malformed(&file, FilePosition::Offset(20), quantity, found, expected)
        };
        if spec.channels == 0 || u64::from(spec.channels) > 256.max(length / 128) {
            let found = spec.channels.to_string();
            return Err(malformed("the number of channels", found, "1 to 256"));
        }
        if spec.sample_rate == 0 {
            return Err(malformed("the sample rate", "0".into(), "a positive rate"));
        }
        let frames = u64::from(reader.len() / u32::from(spec.channels));
        let bytes = frames * u64::from(spec.channels) * u64::from(spec.bits_per_sample.div_ceil(8));
        if bytes > length {
            return Err(MeasureError::Truncated {
                file,
                place: FilePosition::Offset(0),
                quantity: "the samples",
                needed: bytes,
                available: length,
            });
        }
        if frames == 0 {
            return Err(MeasureError::NoSamples { file, expected: "a chunk `data`" });
        }
        Ok(Self { file, reader, next: 0, frames, block: options.block as u64 })
    }
}

fn wrong(file: &str, error: &hound::Error) -> MeasureError {
    let found = error.to_string();
    let (place, expected) = (FilePosition::Offset(0), "PCM or IEEE float samples");
    MeasureError::malformed(file, place, "the WAVE file", found, expected)
}

impl Records for Wav<'_> {
    fn format(&self) -> Format {
        Format::Wav
    }

    fn next_record(&mut self, _: &mut Notices) -> Result<Option<Record>, MeasureError> {
        let spec = self.reader.spec();
        let count = (self.frames - self.next).min(self.block) as usize;
        if count == 0 {
            return Ok(None);
        }
        let channels = usize::from(spec.channels);
        let mut columns: Vec<Vec<f64>> = (0..channels).map(|_| Vec::with_capacity(count)).collect();
        let taken = count * channels;
        let file = &self.file;
        let mut put = |index: usize, sample: Result<f64, hound::Error>| {
            columns[index % channels].push(sample.map_err(|error| wrong(file, &error))?);
            Ok::<(), MeasureError>(())
        };
        match spec.sample_format {
            SampleFormat::Float => {
                for (index, sample) in self.reader.samples::<f32>().take(taken).enumerate() {
                    put(index, sample.map(f64::from))?;
                }
            }
            SampleFormat::Int => {
                let full_scale = 2f64.powi(i32::from(spec.bits_per_sample) - 1);
                for (index, sample) in self.reader.samples::<i32>().take(taken).enumerate() {
                    put(index, sample.map(|sample| f64::from(sample) / full_scale))?;
                }
            }
        }
        let rate = f64::from(spec.sample_rate);
        let abscissa = Abscissa::even_time(self.next as f64 / rate, rate);
        let unit = ChannelUnit::si(ChannelQuantity::FullScale);
        let channels = columns.into_iter().enumerate().map(|(index, values)| {
            let heading = Heading { name: format!("channel {}", index + 1), unit: unit.clone() };
            heading.channel(abscissa.clone(), Samples::Real(values))
        });
        let channels = channels.collect();
        let continues = self.next > 0;
        self.next += count as u64;
        Ok(Some(Record { channels, continues, ..Record::default() }))
    }
}
