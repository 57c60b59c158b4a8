//! Sources as blocks of force and response in SI units.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use asperity_measure::{
    Channel, ChannelQuantity, DegreeOfFreedom, MeasureError, MeasurementSource, Reader, Record,
    Samples,
};
use asperity_signal::{HighPass, ResponseKind};
use serde::Serialize;

use crate::channel::{
    ChannelRole, ResponseChoice, choose, choose_responses, listed_all, near_channel,
};
use crate::error::AnalysisError;
use crate::line_up::LineUp;
use crate::options::{AnalysisOptions, ChannelSensor};
use crate::other_record::{RecordAxis, Rest, axes_in_words, in_other_record};

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
    /// Notices of readers, with the files that each is about.
    of_files: BTreeMap<String, Vec<String>>,
    /// Channels of the current record.
    current: Option<CurrentRecord>,
}

/// Channels of a record on their way to the analysis.
struct CurrentRecord {
    line_up: LineUp,
    filters: Vec<HighPass>,
    /// Rates and starts of the channels.
    axes: String,
}

impl<'a> SampleStream<'a> {
    pub(crate) fn new(options: &'a AnalysisOptions) -> Self {
        Self {
            options,
            signals: None,
            channels: Vec::new(),
            notices: BTreeSet::new(),
            of_files: BTreeMap::new(),
            current: None,
        }
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
                self.end_record(file, read.records)?;
                in_time = is_in_time(&record);
                if in_time {
                    read.records += 1;
                } else {
                    other_records += 1;
                }
            }
            if in_time {
                let axis = RecordAxis::of(read.records, &record);
                let block = self.block(file, read.records, record).map_err(|error| match axis {
                    Some(axis) => {
                        let response = match &self.options.responses {
                            ResponseChoice::Channels(wanted) => wanted.first(),
                            _ => None,
                        };
                        let wanted = (self.options.force.as_ref(), response);
                        in_other_record(error, file, &axis, Rest(&mut reader), wanted)
                    }
                    None => error,
                });
                if let Some((block, signals)) = block? {
                    read.samples += block.force.len() as u64;
                    take(block, &signals)?;
                }
            }
        }
        self.end_record(file, read.records)?;
        self.note(file, &reader, other_records);
        if read.records == 0 {
            let expected = if other_records > 0 {
                "records in time: functions of frequency are no hits, `asperity convert` reads them"
            } else {
                "records in time"
            };
            let file = read.file;
            return Err(MeasureError::NoSamples { file, expected }.into());
        }
        Ok(read)
    }

    fn block(
        &mut self,
        file: &Path,
        number: usize,
        mut record: Record,
    ) -> Result<Option<(SampleBlock, SignalParameters)>, AnalysisError> {
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
        let places: Vec<usize> = std::iter::once(force_at).chain(responses_at).collect();
        let axes = axes_in_words(places.iter().map(|place| &record.channels[*place]));
        let (mut blocks, mut rates, mut starts) = (Vec::new(), Vec::new(), Vec::new());
        let mut quantities = Vec::new();
        for place in places {
            let channel = &mut record.channels[place];
            let rate = channel.sample_rate_hz();
            rates.push(rate.ok_or_else(|| problem("it is not sampled evenly in time"))?);
            starts.push(channel.abscissa.at(0).unwrap_or(0.0));
            channel.to_si()?;
            quantities.push(channel.quantity);
            let empty = Samples::Real(Vec::new());
            let Samples::Real(samples) = std::mem::replace(&mut channel.samples, empty) else {
                return Err(problem("its samples are complex"));
            };
            blocks.push(samples);
        }
        if !record.continues {
            self.begin_record(file, number, &rates, &starts, axes)?;
        }
        let Some(current) = &mut self.current else { return Ok(None) };
        let rate = current.line_up.rate_hz;
        let mut blocks = current.line_up.push(blocks);
        if blocks[0].is_empty() {
            return Ok(None);
        }
        // The first is the force.
        for (filter, samples) in current.filters.iter_mut().zip(&mut blocks[1..]) {
            filter.filter(samples);
        }
        let begins_record = std::mem::take(&mut current.line_up.is_new);
        let start_s = current.line_up.start_s;
        let mut force = blocks.remove(0);
        let kind = |quantity: &ChannelQuantity| match quantity {
            ChannelQuantity::Displacement => ResponseKind::Displacement,
            ChannelQuantity::Velocity => ResponseKind::Velocity,
            _ => ResponseKind::Acceleration,
        };
        let kinds = quantities[1..].iter().map(kind).collect();
        if self.options.flip_force {
            for x in &mut force {
                *x = -*x;
            }
        }
        let signals = SignalParameters { sample_rate_hz: rate, responses: kinds };
        self.signals.get_or_insert_with(|| signals.clone()).check(file, &signals)?;
        Ok(Some((SampleBlock { begins_record, start_s, force, responses: blocks }, signals)))
    }

    /// Lines up the channels of a record by their starts, and resamples those with a rate of their own.
    fn begin_record(
        &mut self,
        file: &Path,
        number: usize,
        rates: &[f64],
        starts: &[f64],
        axes: String,
    ) -> Result<(), AnalysisError> {
        if starts.iter().any(|start| !start.is_finite()) {
            let (file, problem) = (file.to_owned(), "a start time is not finite");
            return Err(AnalysisError::Record { file, record: number, problem });
        }
        let line_up = LineUp::new(rates, starts);
        let line_up = line_up.ok_or_else(|| not_together(file, number, axes.clone()))?;
        let rate = line_up.rate_hz;
        if line_up.is_resampled() {
            let (exact, band) = (line_up.exact_to_hz(), &axes);
            self.note_file(
                file,
                format!(
                    "{LINED_UP}{band}; resampled at common times with {rate:.6} Hz, exact up to \
                     {exact:.0} Hz"
                ),
            );
        } else if line_up.is_apart() {
            self.note_file(file, format!("{LINED_UP}{axes}"));
        }
        let filter = |corner| (1..starts.len()).map(|_| HighPass::new(corner, rate)).collect();
        let filters: Result<Vec<HighPass>, _> =
            self.options.high_pass_hz.map_or_else(|| Ok(Vec::new()), filter);
        self.current = Some(CurrentRecord { line_up, filters: filters?, axes });
        Ok(())
    }

    /// Ends a record, whose channels must have samples in common.
    fn end_record(&mut self, file: &Path, number: usize) -> Result<(), AnalysisError> {
        match self.current.take() {
            Some(CurrentRecord { line_up, axes, .. }) if line_up.is_new => {
                Err(not_together(file, number, axes))
            }
            _ => Ok(()),
        }
    }

    fn note_file(&mut self, file: &Path, notice: String) {
        let files = self.of_files.entry(notice).or_default();
        let name = file.display().to_string();
        if !files.contains(&name) {
            files.push(name);
        }
    }

    /// An error of a test without a hit, with what was left out of the records.
    pub(crate) fn with_remarks(&self, error: AnalysisError) -> AnalysisError {
        let AnalysisError::NoHit { largest_n, noise_n, .. } = error else { return error };
        let left_out = self.of_files.keys().filter(|notice| notice.starts_with(LINED_UP));
        AnalysisError::NoHit { largest_n, noise_n, remarks: left_out.cloned().collect() }
    }

    /// All notices; each notice of several files once.
    pub(crate) fn all_notices(&self) -> Vec<String> {
        let of_files = self.of_files.iter().map(|(notice, files)| match files.as_slice() {
            [] => notice.clone(),
            [one] => format!("{one}: {notice}"),
            [first, others @ ..] => format!("{first} and {} more: {notice}", others.len()),
        });
        of_files.chain(self.notices.iter().cloned()).collect()
    }

    fn note(&mut self, file: &Path, reader: &Reader<'_>, other_records: usize) {
        for notice in reader.notices() {
            self.note_file(file, notice.to_string());
        }
        if other_records > 0 {
            let text = format!("{other_records} records omitted, which are not time records");
            self.note_file(file, text);
        }
    }
}

/// Beginning of the notice of channels whose starts are apart.
const LINED_UP: &str = "channels lined up by their starts: ";

fn not_together(file: &Path, record: usize, channels: String) -> AnalysisError {
    AnalysisError::NotTogether { file: file.to_owned(), record, channels }
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
        let places = sensor.channel.fitting(record);
        if places.is_empty() {
            let wanted = sensor.channel.to_string();
            return Err(AnalysisError::UnknownChannel {
                file: file.to_owned(),
                option: "sensitivity",
                near: near_channel(record, &wanted),
                wanted,
                channels: listed_all(record),
            });
        }
        for place in places {
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
