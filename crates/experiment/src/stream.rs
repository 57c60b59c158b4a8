//! Files as one stream of blocks of force and response, in SI.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use asperity_measure::{Channel, ChannelQuantity, MeasureError, Reader, Record, Samples, open};
use asperity_signal::ResponseKind;
use serde::Serialize;

use crate::error::AnalysisError;
use crate::options::AnalysisOptions;
use crate::select::{Role, choose};

/// Samples that belong together, from somewhere in a record.
pub(super) struct Block {
    /// Whether a record begins with it.
    pub(super) begins: bool,
    /// Time of its first sample \[s\].
    pub(super) start_s: f64,
    /// Force \[N\].
    pub(super) force: Vec<f64>,
    /// Response \[m, m/s or m/s^2\].
    pub(super) response: Vec<f64>,
}

/// What all files share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sampling {
    pub(super) rate_hz: f64,
    pub(crate) route: ResponseKind,
}

/// A channel that was analysed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UsedChannel {
    /// `force` or `response`.
    pub role: &'static str,
    /// Its name in the first file.
    pub name: String,
    /// What it measures.
    pub quantity: String,
    /// Unit in the file.
    pub unit: String,
    /// Unit of the analysis.
    pub si_unit: &'static str,
}

/// Reads files one after the other and tells what was read.
pub(super) struct Stream<'a> {
    options: &'a AnalysisOptions,
    /// Rate and kind of response, once a record was read.
    pub(super) sampling: Option<Sampling>,
    /// The channels of the first record.
    pub(super) channels: Vec<UsedChannel>,
    /// What readers took upon themselves, and what was left out.
    pub(super) notices: BTreeSet<String>,
}

/// What one file held.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FileRead {
    pub(super) format: String,
    pub(super) records: usize,
    pub(super) samples: u64,
}

impl<'a> Stream<'a> {
    pub(super) fn new(options: &'a AnalysisOptions) -> Self {
        Self { options, sampling: None, channels: Vec::new(), notices: BTreeSet::new() }
    }

    /// Hands the blocks of one file to `take`.
    pub(super) fn read(
        &mut self,
        file: &Path,
        take: &mut dyn FnMut(Block, Sampling) -> Result<(), AnalysisError>,
    ) -> Result<FileRead, AnalysisError> {
        let mut reader = open(file, &self.options.reading).map_err(|error| named(error, file))?;
        let mut read = FileRead { format: reader.format().to_string(), records: 0, samples: 0 };
        let mut other_records = 0_usize;
        let mut in_time = false;
        while let Some(record) = reader.next_record().map_err(|error| named(error, file))? {
            if !record.continues {
                in_time = is_in_time(&record);
                if in_time {
                    read.records += 1;
                } else {
                    other_records += 1;
                }
            }
            if in_time {
                let (block, sampling) = self.block(file, read.records, record)?;
                read.samples += block.force.len() as u64;
                take(block, sampling)?;
            }
        }
        self.note(file, &reader, other_records);
        if read.records == 0 {
            return Err(MeasureError::NoSamples {
                file: file.display().to_string(),
                expected: "records in time",
            }
            .into());
        }
        Ok(read)
    }

    fn block(
        &mut self,
        file: &Path,
        number: usize,
        mut record: Record,
    ) -> Result<(Block, Sampling), AnalysisError> {
        self.calibrate(file, &mut record)?;
        let force_at = choose(file, &record, Role::Force, self.options.force.as_ref())?;
        let response_at = choose(file, &record, Role::Response, self.options.response.as_ref())?;
        if self.channels.is_empty() {
            let used = [(Role::Force, force_at), (Role::Response, response_at)];
            self.channels =
                used.map(|(role, place)| UsedChannel::of(role, &record.channels[place])).to_vec();
        }
        let problem =
            |problem| AnalysisError::Record { file: file.to_owned(), record: number, problem };
        let begins = !record.continues;
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
        let (response, response_rate, response_start_s, quantity) = take(response_at)?;
        let apart = (start_s - response_start_s).abs() > 0.5 / rate;
        if rate != response_rate || apart || force.len() != response.len() {
            return Err(problem("force and response are not sampled together"));
        }
        if self.options.flip_force {
            for x in &mut force {
                *x = -*x;
            }
        }
        let route = match quantity {
            ChannelQuantity::Displacement => ResponseKind::Displacement,
            ChannelQuantity::Velocity => ResponseKind::Velocity,
            _ => ResponseKind::Acceleration,
        };
        let sampling = Sampling { rate_hz: rate, route };
        let expected = *self.sampling.get_or_insert(sampling);
        expected.check(file, sampling)?;
        Ok((Block { begins, start_s, force, response }, sampling))
    }

    fn calibrate(&self, file: &Path, record: &mut Record) -> Result<(), AnalysisError> {
        for sensor in &self.options.sensitivities {
            for place in sensor.channel.fitting(record) {
                let channel = &mut record.channels[place];
                if channel.unit.known().is_none() {
                    return Err(AnalysisError::Unit {
                        file: file.to_owned(),
                        channel: channel.name.clone(),
                        text: channel.unit.text().to_owned(),
                    });
                }
                channel.calibrate(&sensor.sensitivity)?;
            }
        }
        Ok(())
    }

    fn note(&mut self, file: &Path, reader: &Reader<'_>, other_records: usize) {
        let name = file.display();
        for notice in reader.notices() {
            self.notices.insert(format!("{name}: {notice}"));
        }
        if other_records > 0 {
            let text = format!("{name}: {other_records} records that are not in time left out");
            self.notices.insert(text);
        }
    }
}

impl Sampling {
    /// Refuses a file that was sampled otherwise than those before.
    fn check(self, file: &Path, found: Self) -> Result<(), AnalysisError> {
        let differs = |quantity, found: String, expected: String| {
            Err(AnalysisError::Differs { file: PathBuf::from(file), quantity, found, expected })
        };
        let name = |route: ResponseKind| {
            let article = if route == ResponseKind::Acceleration { "an" } else { "a" };
            format!("{article} {}", route.name())
        };
        // Rates that were printed differ by their rounding.
        if (found.rate_hz / self.rate_hz - 1.0).abs() > 1e-6 {
            let hertz = |rate: f64| format!("{rate} Hz");
            return differs("the sample rate is", hertz(found.rate_hz), hertz(self.rate_hz));
        }
        if found.route != self.route {
            return differs("the response is", name(found.route), name(self.route));
        }
        Ok(())
    }
}

impl UsedChannel {
    fn of(role: Role, channel: &Channel) -> Self {
        Self {
            role: role.name(),
            name: channel.name.clone(),
            quantity: channel.quantity.to_string(),
            unit: channel.unit.text().to_owned(),
            si_unit: channel.quantity.si_symbol(),
        }
    }
}

fn is_in_time(record: &Record) -> bool {
    let first = record.channels.first();
    first.is_some_and(|channel| channel.abscissa.quantity() == ChannelQuantity::Time)
}

/// Errors of an option of the reader, under the name it has on the command line.
pub(super) fn named(error: MeasureError, file: &Path) -> AnalysisError {
    match error {
        MeasureError::NoSampleRate { .. } => AnalysisError::NoRate { file: file.to_owned() },
        other => other.into(),
    }
}
