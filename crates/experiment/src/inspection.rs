//! Content of a measurement file, before any analysis.

use std::path::Path;

use asperity_measure::{Channel, Record, Samples, open};
use serde::Serialize;

use crate::channel::{ChannelRole, choose, choose_responses};
use crate::error::AnalysisError;
use crate::options::AnalysisOptions;
use crate::other_record::RecordAxis;
use crate::stream::{calibrate, measure_error};

/// Identifier of the format of an inspection.
pub const INSPECTION_SCHEMA: &str = "asperity/inspection/1";
/// Most intervals of the outline of a channel.
const INTERVALS: usize = 64;
/// Most records whose channels are described one by one.
const MOST_RECORDS: usize = 100;

/// Content of a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Inspection {
    /// [`INSPECTION_SCHEMA`].
    pub schema: &'static str,
    /// File, as given.
    pub file: String,
    /// Format.
    pub format: String,
    /// Number of records.
    pub records: usize,
    /// Channels of the first records.
    pub channels: Vec<InspectedChannel>,
    /// Channel that an analysis takes as the force, or the reason for none.
    pub force: Choice,
    /// Channel that an analysis takes as the response, or the reason for none.
    pub response: Choice,
    /// Assumptions and omissions of the reader.
    pub notices: Vec<String>,
}

/// Choice of a channel.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// Number of the channel in the file, from 1; the first of several.
    pub channel: Option<usize>,
    /// Numbers of all channels of the role.
    pub channels: Vec<usize>,
    /// Its name, or the reason for none.
    pub text: String,
}

/// Content of one channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InspectedChannel {
    /// Record in the file, from 1.
    pub record: usize,
    /// Number of the channel in the record, from 1.
    pub number: usize,
    /// Name.
    pub name: String,
    /// Quantity.
    pub quantity: String,
    /// Unit in the file; empty without one.
    pub unit: String,
    /// Number of samples.
    pub samples: u64,
    /// Sample rate \[Hz\]; `None` for an axis that is not even in time.
    pub sample_rate_hz: Option<f64>,
    /// Duration \[s\].
    pub duration_s: Option<f64>,
    /// Smallest and largest sample, in the unit of the channel.
    pub range: Option<[f64; 2]>,
    /// Root mean square about the mean, in the unit of the channel.
    pub deviation: Option<f64>,
    /// Samples that are not finite.
    pub not_finite: u64,
    /// Smallest and largest sample of equal intervals, at most 64; complex samples by magnitude.
    pub outline: Vec<[f64; 2]>,
}

/// Describes a file as an analysis with the same options would see it.
///
/// The file is read once in blocks, of any length.
///
/// # Errors
/// [`AnalysisError`] for a file that cannot be read.
pub fn inspect(file: &Path, options: &AnalysisOptions) -> Result<Inspection, AnalysisError> {
    let mut reader = open(file, &options.reading).map_err(|error| measure_error(error, file))?;
    let none = || Choice {
        channel: None,
        channels: Vec::new(),
        text: "the file has no record".to_owned(),
    };
    let mut found = Inspection {
        schema: INSPECTION_SCHEMA,
        file: file.display().to_string(),
        format: reader.format().to_string(),
        records: 0,
        channels: Vec::new(),
        force: none(),
        response: none(),
        notices: Vec::new(),
    };
    let mut open_channels: Vec<Outline> = Vec::new();
    let mut first: Option<RecordAxis> = None;
    while let Some(mut record) = reader.next_record().map_err(|error| measure_error(error, file))? {
        if !record.continues {
            found.records += 1;
            let ended = open_channels.drain(..).map(Outline::finish);
            found.channels.extend(ended);
        }
        if found.records > MOST_RECORDS {
            continue;
        }
        if open_channels.is_empty() {
            let channels = record.channels.iter().enumerate();
            open_channels =
                channels.map(|(at, one)| Outline::new(found.records, at + 1, one)).collect();
        }
        for (outline, channel) in open_channels.iter_mut().zip(&record.channels) {
            outline.push(&channel.samples);
        }
        if found.records == 1 && !record.continues {
            calibrate(&options.sensitivities, file, &mut record)?;
            let force = choose(file, &record, ChannelRole::Force, options.force.as_ref());
            found.force = choice(file, &record, force.map(|place| vec![place]));
            let responses = choose_responses(file, &record, &options.responses);
            found.response = choice(file, &record, responses);
            first = RecordAxis::of(1, &record);
        } else if let Some(first) = &first
            && !record.continues
        {
            found.point_to(file, first, &record, options);
        }
    }
    found.channels.extend(open_channels.into_iter().map(Outline::finish));
    found.notices = reader.notices().iter().map(ToString::to_string).collect();
    Ok(found)
}

impl Inspection {
    /// Tells of a force or a response that the first record lacks and a later one has.
    fn point_to(
        &mut self,
        file: &Path,
        first: &RecordAxis,
        record: &Record,
        options: &AnalysisOptions,
    ) {
        let number = self.records;
        let roles = [
            (ChannelRole::Force, options.force.as_ref(), &mut self.force),
            (ChannelRole::Response, None, &mut self.response),
        ];
        for (role, wanted, known) in roles {
            if known.channel.is_none()
                && !known.text.contains(" is in record ")
                && let Ok(place) = choose(file, record, role, wanted)
            {
                let channel = &record.channels[place];
                let reason = first.reason(&RecordAxis::of_channel(number, channel));
                let name = &channel.name;
                known.text =
                    format!("`{name}` is in record {number}, and the first is not: {reason}");
            }
        }
    }
}

fn choice(file: &Path, record: &Record, found: Result<Vec<usize>, AnalysisError>) -> Choice {
    match found {
        Ok(places) => {
            let names: Vec<&str> =
                places.iter().map(|place| record.channels[*place].name.as_str()).collect();
            let channels: Vec<usize> = places.iter().map(|place| place + 1).collect();
            Choice { channel: channels.first().copied(), text: names.join(", "), channels }
        }
        Err(error) => {
            let text = error.to_string();
            let prefix = format!("{}: ", file.display());
            Choice {
                channel: None,
                channels: Vec::new(),
                text: text.strip_prefix(&prefix).unwrap_or(&text).to_owned(),
            }
        }
    }
}

/// Extremes and moments of a channel whose length is not known before.
struct Outline {
    channel: InspectedChannel,
    /// Samples of an interval.
    width: u64,
    in_last: u64,
    mean: f64,
    square: f64,
}

impl Outline {
    fn new(record: usize, number: usize, channel: &Channel) -> Self {
        Self {
            channel: InspectedChannel {
                record,
                number,
                name: channel.name.clone(),
                quantity: channel.quantity.to_string(),
                unit: channel.unit.text().to_owned(),
                samples: 0,
                sample_rate_hz: channel.sample_rate_hz(),
                duration_s: None,
                range: None,
                deviation: None,
                not_finite: 0,
                outline: Vec::new(),
            },
            width: 1,
            in_last: 0,
            mean: 0.0,
            square: 0.0,
        }
    }

    fn push(&mut self, samples: &Samples) {
        match samples {
            Samples::Real(values) => values.iter().for_each(|value| self.add(*value)),
            Samples::Complex(values) => values.iter().for_each(|value| self.add(value.norm())),
        }
    }

    fn add(&mut self, value: f64) {
        let channel = &mut self.channel;
        channel.samples += 1;
        if !value.is_finite() {
            channel.not_finite += 1;
            return;
        }
        let count = (channel.samples - channel.not_finite) as f64;
        // Welford: one pass without cancellation.
        let difference = value - self.mean;
        self.mean += difference / count;
        self.square += difference * (value - self.mean);
        let outline = &mut channel.outline;
        if self.in_last == self.width || outline.is_empty() {
            if outline.len() == INTERVALS {
                *outline = outline
                    .chunks(2)
                    .map(|pair| {
                        let last = pair[pair.len() - 1];
                        [pair[0][0].min(last[0]), pair[0][1].max(last[1])]
                    })
                    .collect();
                self.width *= 2;
            }
            outline.push([value, value]);
            self.in_last = 0;
        }
        if let Some(last) = outline.last_mut() {
            *last = [last[0].min(value), last[1].max(value)];
        }
        self.in_last += 1;
    }

    fn finish(self) -> InspectedChannel {
        let mut channel = self.channel;
        let count = channel.samples - channel.not_finite;
        channel.range = channel
            .outline
            .iter()
            .copied()
            .reduce(|all, one| [all[0].min(one[0]), all[1].max(one[1])]);
        channel.deviation = (count > 0).then(|| (self.square / count as f64).sqrt());
        channel.duration_s = channel.sample_rate_hz.map(|rate| channel.samples as f64 / rate);
        channel
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write as _;

    /// Verified against counts: a sine over 10 periods, in pieces that do not divide its length, has
    /// the outline of its range, its deviation, and one sample that is not finite.
    #[test]
    fn outlines_do_not_depend_on_the_blocks() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.csv");
        let mut text = String::from("time_s,hammer [N],top [m/s^2]\n");
        for n in 0..1000 {
            let phase = std::f64::consts::TAU * f64::from(n) / 100.0;
            let _ = writeln!(text, "{},{},{}", f64::from(n) * 1e-3, phase.sin(), n % 2);
        }
        std::fs::write(&file, text).unwrap();
        let of = |block: usize| {
            let mut options = AnalysisOptions::default();
            options.reading.block = block;
            inspect(&file, &options).unwrap()
        };
        let found = of(17);
        assert_eq!(found, of(1 << 16));
        assert_eq!((found.records, found.channels.len()), (1, 2));
        assert_eq!((found.force.channel, found.response.channel), (Some(1), Some(2)));
        let hammer = &found.channels[0];
        assert_eq!((hammer.samples, hammer.sample_rate_hz), (1000, Some(1000.0)));
        assert!((hammer.deviation.unwrap() - 0.5_f64.sqrt()).abs() < 1e-9);
        assert_eq!(hammer.range.map(|range| range.map(f64::round)), Some([-1.0, 1.0]));
        assert!(hammer.outline.len() <= INTERVALS && hammer.outline.len() > INTERVALS / 2);
    }
}
