//! Sources as blocks of force and response in SI units.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use asperity_measure::{
    Channel, ChannelQuantity, DegreeOfFreedom, MeasureError, MeasurementSource, Reader, Record,
    Samples,
};
use asperity_signal::ResponseKind;
use serde::Serialize;

use crate::channel::{ChannelRole, choose, choose_responses};
use crate::error::AnalysisError;
use crate::options::{AnalysisOptions, ChannelSensor};

/// Consecutive samples of a record.
pub(crate) struct SampleBlock {
    /// True for the first block of a record.
    pub(crate) begins_record: bool,
    /// Time of the first sample \[s\].
    pub(crate) start_s: f64,
    /// Force \[N\].
    pub(crate) force: Vec<f64>,
    /// Responses \[m, m/s or m/s^2\].
    pub(crate) responses: Vec<Vec<f64>>,
}

/// Properties of the signals that all files share.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SignalParameters {
    pub(crate) sample_rate_hz: f64,
    /// Quantity of each response.
    pub(crate) responses: Vec<ResponseKind>,
}

/// Analysed channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UsedChannel {
    /// `force` or `response`.
    pub role: &'static str,
    /// Name in the first file.
    pub name: String,
    /// Measured quantity.
    pub quantity: String,
    /// Unit in the file.
    pub unit: String,
    /// Unit of the analysis.
    pub si_unit: &'static str,
    /// Node and direction, where the file tells them.
    #[serde(skip)]
    pub(crate) node: Option<DegreeOfFreedom>,
}

/// Analysed file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AnalysedFile {
    /// Name, as given.
    pub file: String,
    /// Format.
    pub format: String,
    /// Number of time records.
    pub records: usize,
    /// Number of samples of each of the two channels.
    pub samples: u64,
    /// SHA-256 of the file.
    pub sha256: String,
}

/// Reader of sources, one after the other.
pub(crate) struct SampleStream<'a> {
    options: &'a AnalysisOptions,
    /// Properties of the signals, once a record is read.
    pub(crate) signals: Option<SignalParameters>,
    /// Channels of the first record.
    pub(crate) channels: Vec<UsedChannel>,
    /// Assumptions and omissions.
    pub(crate) notices: BTreeSet<String>,
}

impl<'a> SampleStream<'a> {
    pub(crate) fn new(options: &'a AnalysisOptions) -> Self {
        Self { options, signals: None, channels: Vec::new(), notices: BTreeSet::new() }
    }

    /// Calls `take` with the blocks of one source; returns its properties without the hash.
    pub(crate) fn read(
        &mut self,
        source: &MeasurementSource,
        take: &mut dyn FnMut(SampleBlock, &SignalParameters) -> Result<(), AnalysisError>,
    ) -> Result<AnalysedFile, AnalysisError> {
        let file = source.name();
        let mut reader =
            source.open(&self.options.reading).map_err(|error| measure_error(error, file))?;
        let mut read = AnalysedFile {
            file: file.display().to_string(),
            format: reader.format().to_string(),
            records: 0,
            samples: 0,
            sha256: String::new(),
        };
        let mut other_records = 0_usize;
        let mut in_time = false;
        while let Some(record) = reader.next_record().map_err(|error| measure_error(error, file))? {
            if !record.continues {
                in_time = is_in_time(&record);
                if in_time {
                    read.records += 1;
                } else {
                    other_records += 1;
                }
            }
            if in_time {
                let (block, signals) = self.block(file, read.records, record)?;
                read.samples += block.force.len() as u64;
                take(block, &signals)?;
            }
        }
        self.note(file, &reader, other_records);
        if read.records == 0 {
            let (file, expected) = (read.file, "records in time");
            return Err(MeasureError::NoSamples { file, expected }.into());
        }
        Ok(read)
    }

    fn block(
        &mut self,
        file: &Path,
        number: usize,
        mut record: Record,
    ) -> Result<(SampleBlock, SignalParameters), AnalysisError> {
        calibrate(&self.options.sensitivities, file, &mut record)?;
        let force_at = choose(file, &record, ChannelRole::Force, self.options.force.as_ref())?;
        let responses_at = choose_responses(file, &record, &self.options.responses)?;
        if self.channels.is_empty() {
            let used = |role, place: usize| UsedChannel::of(role, &record.channels[place]);
            self.channels.push(used(ChannelRole::Force, force_at));
            let responses = responses_at.iter().map(|at| used(ChannelRole::Response, *at));
            self.channels.extend(responses);
        }
        let problem =
            |problem| AnalysisError::Record { file: file.to_owned(), record: number, problem };
        let begins_record = !record.continues;
        let mut take = |place: usize| -> Result<_, AnalysisError> {
            let channel = &mut record.channels[place];
            let rate = channel.sample_rate_hz();
            let rate = rate.ok_or_else(|| problem("it is not sampled evenly in time"))?;
            let start = channel.abscissa.at(0).unwrap_or(0.0);
            channel.to_si()?;
            let quantity = channel.quantity;
            let empty = Samples::Real(Vec::new());
            let Samples::Real(samples) = std::mem::replace(&mut channel.samples, empty) else {
                return Err(problem("its samples are complex"));
            };
            Ok((samples, rate, start, quantity))
        };
        let (mut force, rate, start_s, _) = take(force_at)?;
        let (mut responses, mut kinds) = (Vec::new(), Vec::new());
        for place in responses_at {
            let (response, response_rate, response_start_s, quantity) = take(place)?;
            let apart = (start_s - response_start_s).abs() > 0.5 / rate;
            if rate != response_rate || apart || force.len() != response.len() {
                return Err(problem("force and response are not sampled together"));
            }
            responses.push(response);
            kinds.push(match quantity {
                ChannelQuantity::Displacement => ResponseKind::Displacement,
                ChannelQuantity::Velocity => ResponseKind::Velocity,
                _ => ResponseKind::Acceleration,
            });
        }
        if self.options.flip_force {
            for x in &mut force {
                *x = -*x;
            }
        }
        let signals = SignalParameters { sample_rate_hz: rate, responses: kinds };
        self.signals.get_or_insert_with(|| signals.clone()).check(file, &signals)?;
        Ok((SampleBlock { begins_record, start_s, force, responses }, signals))
    }

    fn note(&mut self, file: &Path, reader: &Reader<'_>, other_records: usize) {
        let name = file.display();
        for notice in reader.notices() {
            self.notices.insert(format!("{name}: {notice}"));
        }
        if other_records > 0 {
            self.notices.insert(format!(
                "{name}: {other_records} records omitted, which are not time records"
            ));
        }
    }
}

impl SignalParameters {
    /// Checks that a file agrees with the files before it.
    fn check(&self, file: &Path, found: &Self) -> Result<(), AnalysisError> {
        let differs = |quantity, found: String, expected: String| {
            Err(AnalysisError::Differs { file: PathBuf::from(file), quantity, found, expected })
        };
        // Printed rates differ by their rounding.
        if (found.sample_rate_hz / self.sample_rate_hz - 1.0).abs() > 1e-6 {
            let [found, expected] = [found, self].map(|one| format!("{} Hz", one.sample_rate_hz));
            return differs("the sample rate is", found, expected);
        }
        if found.responses.len() != self.responses.len() {
            let [found, expected] = [found, self].map(|one| one.responses.len().to_string());
            return differs("the number of responses is", found, expected);
        }
        let mut pairs = found.responses.iter().zip(&self.responses);
        if let Some((found, expected)) = pairs.find(|(found, expected)| found != expected) {
            let [found, expected] = [found, expected].map(|kind| {
                let article = if *kind == ResponseKind::Acceleration { "an" } else { "a" };
                format!("{article} {}", kind.name())
            });
            return differs("the response is", found, expected);
        }
        Ok(())
    }
}

impl UsedChannel {
    fn of(role: ChannelRole, channel: &Channel) -> Self {
        Self {
            role: role.name(),
            name: channel.name.clone(),
            quantity: channel.quantity.to_string(),
            unit: channel.unit.text().to_owned(),
            si_unit: channel.quantity.si_symbol(),
            node: channel.origin.response.clone(),
        }
    }
}

/// Sources of some files.
pub(crate) fn as_sources(files: &[PathBuf]) -> Vec<MeasurementSource> {
    files.iter().cloned().map(MeasurementSource::from).collect()
}

/// A sentence for each file with the bytes of an earlier one.
pub(crate) fn files_given_twice(files: &[AnalysedFile]) -> Vec<String> {
    let mut sentences = Vec::new();
    for (number, file) in files.iter().enumerate() {
        let same = files[..number].iter().find(|earlier| earlier.sha256 == file.sha256);
        if let Some(earlier) = same {
            sentences.push(format!(
                "{} and {} hold the same bytes: their hits are counted twice, and coherence and \
                 scatter mean nothing",
                earlier.file, file.file
            ));
        }
    }
    sentences
}

/// Converts the channels in volts whose sensors are given, each by the first that fits it.
pub(crate) fn calibrate(
    sensors: &[ChannelSensor],
    file: &Path,
    record: &mut Record,
) -> Result<(), AnalysisError> {
    let mut converted = Vec::new();
    for sensor in sensors {
        for place in sensor.channel.fitting(record) {
            if converted.contains(&place) {
                continue;
            }
            converted.push(place);
            let channel = &mut record.channels[place];
            if channel.unit.known().is_none() {
                return Err(AnalysisError::unit(file, channel));
            }
            channel.calibrate(&sensor.sensitivity)?;
        }
    }
    Ok(())
}

pub(crate) fn is_in_time(record: &Record) -> bool {
    let first = record.channels.first();
    first.is_some_and(|channel| channel.abscissa.quantity() == ChannelQuantity::Time)
}

/// Error of a reader, with the file of a missing sample rate.
pub(crate) fn measure_error(error: MeasureError, file: &Path) -> AnalysisError {
    match error {
        MeasureError::NoSampleRate { .. } => AnalysisError::NoRate(file.to_owned()),
        other => other.into(),
    }
}
