//! Free decays without a measured force: from files to backbones.
//!
//! | module | holds |
//! |---|---|
//! | `signals` | responses of a record, in the unit of their channel |
//! | `report` | `decay.json`, backbones |
//! | `tables` | `decays.csv`, `backbone.csv` |
//! | `outline` | signals to draw |
//! | `conclusion` | results in words |

mod conclusion;
mod outline;
mod report;
mod signals;
mod tables;

pub use outline::DecayOutline;
pub use report::{
    DECAY_SCHEMA, DecayCurve, DecayCurveReport, DecayHarmonicReport, DecayLevel, DecayMode,
    DecayReport, DecaySettings, DecayTrend, MeasuredDecay,
};

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use asperity_measure::{MeasureError, Measurement, MeasurementSource, ReadOptions};
use asperity_signal::{
    DecayOrigin, DecayResonance, FoundDecay, FreeDecay, FreeDecayOptions, find_decays, level_range,
};
use rayon::prelude::*;

use crate::channel::ChannelSelector;
use crate::error::AnalysisError;
use crate::input_size::{MAX_CONVERTED_BYTES, check_size};
use crate::options::{ChannelSensor, FrequencyBand, RigFile};
use crate::report::AnalysisProvenance;
use crate::source_hash::sha256;
use crate::stream::{AnalysedFile, as_sources, files_given_twice, measure_error};
use signals::{DecayChannel, DecaySignals, MAX_FREQUENCY, MIN_CYCLES, ResponseSignal};

/// Band of a search without a band, over the resonance of the first decay.
const DEFAULT_BAND: (f64, f64) = (0.85, 1.15);
/// Half width of the band in which a second mode is searched, over half of the distance to the next resonance.
const NEIGHBOUR: f64 = 6.0;
/// Cycles of the mode after a blow that may be the blow itself.
const PULSE_CYCLES: f64 = 1.5;

/// Options of [`analyse_decays`](crate::analyse_decays).
///
/// ```
/// use asperity_experiment::DecayOptions;
///
/// // One response, and two modes.
/// let options = DecayOptions {
///     responses: vec!["top".into()],
///     bands_hz: vec!["70:90".parse()?, "280:320".parse()?],
///     ..DecayOptions::default()
/// };
/// # assert_eq!(options.bands_hz.len(), 2);
/// # Ok::<(), asperity_experiment::AnalysisError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct DecayOptions {
    /// Properties that the files do not give: sample rate, names, units.
    pub reading: ReadOptions,
    /// Sensors of channels that are in volts.
    pub sensitivities: Vec<ChannelSensor>,
    /// Channels of the responses, of any quantity; empty for all accelerations, velocities and
    /// displacements.
    pub responses: Vec<ChannelSelector>,
    /// Bands with one mode each \[Hz\]; empty for a band about the strongest resonance of the first
    /// decay.
    pub bands_hz: Vec<FrequencyBand>,
    /// Settings of the rig that the options are from, for the provenance.
    pub rig: Option<RigFile>,
}

/// Free decays of some files.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayAnalysis {
    /// Content of `decay.json`.
    pub report: DecayReport,
    /// Backbones: one of each decay, band and response.
    pub curves: Vec<DecayCurve>,
    /// Signals of some records, to be drawn.
    pub outlines: Vec<DecayOutline>,
}

/// Analyses the free decays of some files, without their force.
///
/// In each record the decays are found ([`find_decays`]); in each decay the strongest resonance in
/// each band, over all responses; of each response the frequency, damping and harmonics of that mode
/// over its amplitude ([`FreeDecay`]). Without a band it is that about the strongest resonance of the
/// first decay. One file at a time is held in memory.
///
/// # Errors
/// [`AnalysisError`] for a file that cannot be read, a channel that is not clear, and files without a
/// decay.
///
/// ```
/// use asperity_experiment::{DecayOptions, analyse_decays};
/// use std::fmt::Write as _;
///
/// // 1 % of critical damping at 200 Hz after a blow at 50 ms, as an acceleration.
/// let folder = tempfile::tempdir()?;
/// let file = folder.path().join("blow.csv");
/// let mut text = String::from("time_s,top [m/s^2]\n");
/// for n in 0..8000 {
///     let t = f64::from(n) / 8000.0;
///     let after = (t - 0.05).max(0.0);
///     writeln!(text, "{t},{}", (-12.566 * after).exp() * (1256.6 * after).sin())?;
/// }
/// std::fs::write(&file, text)?;
/// let found = analyse_decays(&[file], &DecayOptions::default())?;
/// let mean = found.report.decays[0].responses[0].mean.ok_or("a decay has a mean")?;
/// assert!((mean.frequency_hz - 200.0).abs() < 0.01 && (mean.damping_ratio - 0.01).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn analyse_decays(
    files: &[PathBuf],
    options: &DecayOptions,
) -> Result<DecayAnalysis, AnalysisError> {
    analyse_decay_sources(&as_sources(files), options, &|_| {})
}

/// Analyses files or records in memory as [`analyse_decays`] does, and reports the number of sources
/// that are done.
///
/// # Errors
/// As [`analyse_decays`].
pub fn analyse_decay_sources(
    sources: &[MeasurementSource],
    options: &DecayOptions,
    progress: &dyn Fn(usize),
) -> Result<DecayAnalysis, AnalysisError> {
    if sources.is_empty() {
        return Err(AnalysisError::NoFile);
    }
    let DecayOptions { reading, sensitivities: sensors, responses, .. } = options;
    let mut found = DecayAccumulator::new(options);
    let mut analysed = Vec::with_capacity(sources.len());
    for (number, source) in sources.iter().enumerate() {
        check_size(std::slice::from_ref(source), MAX_CONVERTED_BYTES)?;
        let path = source.name();
        let Measurement { format, records, notices } =
            source.read(reading).map_err(|error| measure_error(error, path))?;
        let mut file = AnalysedFile {
            file: path.display().to_string(),
            format: format.to_string(),
            records: 0,
            samples: 0,
            sha256: sha256(source, &AtomicBool::new(false))?,
        };
        let name = file.file.clone();
        found.notices.extend(notices.iter().map(|notice| format!("{name}: {notice}")));
        for record in records {
            let Some(signals) =
                DecaySignals::of(path, file.records + 1, record, sensors, responses)?
            else {
                found.other_records += 1;
                continue;
            };
            file.records += 1;
            file.samples += signals.samples() as u64;
            found.take(&name, file.records, &signals)?;
        }
        if file.records == 0 {
            let (file, expected) = (name, "records in time");
            return Err(MeasureError::NoSamples { file, expected }.into());
        }
        analysed.push(file);
        progress(number + 1);
    }
    found.notices.extend(files_given_twice(&analysed));
    let rig = options.rig.clone();
    let version = env!("CARGO_PKG_VERSION");
    let provenance = AnalysisProvenance { version, files: analysed, rig };
    found.finish(provenance)
}

/// Decays of the records read so far.
struct DecayAccumulator<'a> {
    options: &'a DecayOptions,
    bands: Vec<FrequencyBand>,
    decays: Vec<MeasuredDecay>,
    curves: Vec<DecayCurve>,
    outlines: Vec<DecayOutline>,
    channels: Vec<DecayChannel>,
    notices: Vec<String>,
    /// Responses that cannot be analysed, in words.
    left_out: Vec<String>,
    other_records: usize,
    /// Largest level over the quiet one, and fall after it, of the records without a decay.
    evidence: (f64, f64),
}

impl<'a> DecayAccumulator<'a> {
    fn new(options: &'a DecayOptions) -> Self {
        Self {
            options,
            bands: options.bands_hz.clone(),
            decays: Vec::new(),
            curves: Vec::new(),
            outlines: Vec::new(),
            channels: Vec::new(),
            notices: Vec::new(),
            left_out: Vec::new(),
            other_records: 0,
            evidence: (1.0, 1.0),
        }
    }

    /// Finds and analyses the decays of a record.
    fn take(
        &mut self,
        file: &str,
        record: usize,
        signals: &DecaySignals,
    ) -> Result<(), AnalysisError> {
        for signal in &signals.responses {
            if !self.channels.iter().any(|known| known.name == signal.name) {
                self.channels.push(signal.channel());
            }
        }
        self.left_out.extend(signals.left_out.iter().map(|sentence| format!("{file}: {sentence}")));
        let (rate, samples) = (signals.sample_rate_hz, signals.slices());
        let Some(cycle_hz) = signals.cycle_hz()? else { return Ok(()) };
        let found = find_decays(&samples, rate, cycle_hz)?;
        if found.is_empty()
            && let Some((above, fall)) = level_range(&samples, rate, cycle_hz)
        {
            self.evidence = (self.evidence.0.max(above), self.evidence.1.max(fall));
        }
        let first = self.decays.len();
        for place in &found {
            self.add(file, record, signals, place)?;
        }
        self.outlines.extend(DecayOutline::of(signals, &self.decays[first..], &self.outlines));
        Ok(())
    }

    /// Analyses one decay in every band.
    fn add(
        &mut self,
        file: &str,
        record: usize,
        signals: &DecaySignals,
        place: &FoundDecay,
    ) -> Result<(), AnalysisError> {
        let rate = signals.sample_rate_hz;
        if self.bands.is_empty() {
            let length = (place.end - place.onset) as f64 / rate;
            let band = (MIN_CYCLES / length, MAX_FREQUENCY * rate);
            let all =
                DecayResonance::strongest(&signals.parts(place.onset..place.end), rate, band)?;
            let Some(found) = all else { return Ok(()) };
            self.bands.push(FrequencyBand {
                low_hz: DEFAULT_BAND.0 * found.frequency_hz,
                high_hz: DEFAULT_BAND.1 * found.frequency_hz,
            });
        }
        let number = self.decays.len() + 1;
        let mut decay = MeasuredDecay::new(number, file, record, signals, place);
        for (band_number, band) in self.bands.clone().into_iter().enumerate() {
            let wait = match place.origin {
                DecayOrigin::Blow => {
                    (PULSE_CYCLES * 2.0 * rate / (band.low_hz + band.high_hz)).ceil() as usize
                }
                _ => 0,
            };
            let begin = place.onset + wait;
            if begin >= place.end {
                continue;
            }
            let limits = (band.low_hz, band.high_hz.min(0.5 * rate));
            let resonance =
                DecayResonance::strongest(&signals.parts(begin..place.end), rate, limits)?;
            let Some(resonance) = resonance else {
                decay
                    .warnings
                    .push(format!("no resonance in {:.1} to {:.1} Hz", band.low_hz, band.high_hz));
                continue;
            };
            // A band that is given holds the mode alone; the other is about a mode.
            let given = if self.options.bands_hz.is_empty() {
                f64::INFINITY
            } else {
                (resonance.frequency_hz - band.low_hz).max(band.high_hz - resonance.frequency_hz)
            };
            let analyse = |signal: &ResponseSignal| {
                let options = FreeDecayOptions {
                    resonance_hz: resonance.frequency_hz,
                    half_width_hz: resonance.half_width_hz.min(given),
                    search_half_width_hz: (NEIGHBOUR * resonance.half_width_hz).min(given),
                    derivatives: signal.derivatives.unwrap_or(0),
                    noise_density: None,
                };
                FreeDecay::of(&signal.samples[begin..place.end], rate, &options)
            };
            let analysed: Vec<_> = signals.responses.par_iter().map(analyse).collect();
            let start_s = signals.start_s + begin as f64 / rate;
            let first = self.curves.len();
            for (signal, found) in signals.responses.iter().zip(analysed) {
                let found = found?;
                let mut curve = DecayCurve {
                    index: self.curves.len() + 1,
                    decay: number,
                    band: band_number + 1,
                    response: signal.name.clone(),
                    unit: signal.unit.clone(),
                    metres: signal.metres,
                    start_s,
                    points: Vec::new(),
                };
                decay.responses.push(DecayCurveReport::new(&curve, &resonance, &found, signal));
                if found.is_one_mode() {
                    curve.points = found.points;
                }
                self.curves.push(curve);
            }
            decay.warnings.extend(conclusion::disagreement(&self.curves[first..]));
        }
        self.decays.push(decay);
        Ok(())
    }

    fn finish(mut self, provenance: AnalysisProvenance) -> Result<DecayAnalysis, AnalysisError> {
        if self.decays.is_empty() {
            let (above_noise, fall) = self.evidence;
            let records = provenance.files.iter().map(|file| file.records).sum();
            let left_out = self.left_out;
            return Err(AnalysisError::NoDecay { records, above_noise, fall, left_out });
        }
        self.notices.append(&mut self.left_out);
        if self.other_records > 0 {
            let other = self.other_records;
            self.notices.push(format!("{other} records omitted, which are not time records"));
        }
        if let (true, Some(band)) = (self.options.bands_hz.is_empty(), self.bands.first()) {
            self.notices.push(format!(
                "no band given: the mode is the strongest resonance of the first decay, searched in \
                 {:.1} to {:.1} Hz; `band_hz` sets another band, or several",
                band.low_hz, band.high_hz
            ));
        }
        for channel in self.channels.iter().filter(|channel| channel.si_unit.is_none()) {
            let name = &channel.name;
            self.notices.push(format!(
                "`{name}` has no known unit: its amplitudes are as in the file, and there is none in m"
            ));
        }
        self.notices.sort();
        self.notices.dedup();
        let report = DecayReport {
            schema: DECAY_SCHEMA,
            channels: self.channels,
            settings: DecaySettings {
                bands_hz: self.bands.iter().map(|band| [band.low_hz, band.high_hz]).collect(),
                band_given: !self.options.bands_hz.is_empty(),
            },
            conclusions: conclusion::conclusions(&self.decays, &self.curves),
            decays: self.decays,
            notices: self.notices,
            provenance,
        };
        Ok(DecayAnalysis { report, curves: self.curves, outlines: self.outlines })
    }
}
