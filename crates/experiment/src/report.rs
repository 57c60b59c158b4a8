//! Content of `analysis.json`.

use asperity_signal::{AnalysedHit, HitFeatures, QualityIssue};
use serde::Serialize;

use crate::force_level::ForceLevel;
use crate::modes::Mode;
use crate::second_peak::{HitSecondPeak, SecondPeakReport, name as name_of_origin};
use crate::stream::UsedChannel;

/// Identifier of the format of `analysis.json`.
pub const ANALYSIS_SCHEMA: &str = "asperity/analysis/1";

/// Report of an analysis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnalysisReport {
    /// [`ANALYSIS_SCHEMA`].
    pub schema: &'static str,
    /// Sample rate \[Hz\].
    pub sample_rate_hz: f64,
    /// Channels of force and response in the first file.
    pub channels: Vec<UsedChannel>,
    /// Settings, given or found.
    pub settings: AnalysisSettings,
    /// All hits, in the order of the files.
    pub hits: Vec<HitReport>,
    /// Average of the good hits.
    pub average: AverageReport,
    /// Good hits grouped by force, from the smallest on.
    pub levels: Vec<ForceLevel>,
    /// Peaks near twice the fundamental: harmonic or mode; `None` without any.
    pub second_peak: Option<SecondPeakReport>,
    /// Results over all hits, in words.
    pub conclusions: Vec<String>,
    /// Modes in the band over all responses, in the report of the first.
    pub modes: Vec<Mode>,
    /// Names of the other responses, in the report of the first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_responses: Vec<String>,
    /// Assumptions and omissions.
    pub notices: Vec<String>,
    /// Version and files.
    pub provenance: AnalysisProvenance,
}

/// Settings of an analysis.
#[allow(clippy::struct_excessive_bools, reason = "each is a key of the file format")]
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnalysisSettings {
    /// Trigger level \[N\].
    #[serde(rename = "level_n")]
    pub trigger_level_n: f64,
    /// Robust standard deviation of the force over all files \[N\].
    pub noise_n: f64,
    /// Longest hit \[s\].
    #[serde(rename = "length_s")]
    pub hit_length_s: f64,
    /// Time kept before the trigger \[s\].
    pub pre_trigger_s: f64,
    /// Time after a trigger in which a further impact makes a double hit \[s\].
    pub hold_off_s: f64,
    /// `h1`, `h2` or `hv`.
    pub estimator: &'static str,
    /// Form of the measured response over the force: `receptance` of a displacement, `mobility` of a
    /// velocity, `accelerance` of an acceleration.
    pub measured_form: &'static str,
    /// Form that every `magnitude`, `harmonic_ratio` and peak frequency refers to: `receptance`.
    pub feature_form: &'static str,
    /// Form of the function in `frf.csv`.
    pub frf_form: &'static str,
    /// True with a force window.
    pub force_window: bool,
    /// True where force and response end in noise.
    pub until_noise: bool,
    /// Time constant of the exponential window \[s\]; `None` without one.
    pub exponential_window_s: Option<f64>,
    /// Band of the fundamental \[Hz\]; `None` without a resonance.
    pub band_hz: Option<[f64; 2]>,
    /// True for a given band.
    pub band_given: bool,
    /// True where bad hits were averaged too.
    pub keep_all: bool,
}

/// Results of one hit.
#[allow(clippy::struct_excessive_bools, reason = "each is a key of the file format")]
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct HitReport {
    /// File.
    pub file: String,
    /// Number through all files, from 1.
    pub index: usize,
    /// Record in the file, from 1.
    pub record: usize,
    /// Time of the trigger on the time axis of the record \[s\].
    pub time_s: f64,
    /// Number of samples.
    pub samples: usize,
    /// Largest force, interpolated between the samples \[N\]; `None` without a pulse.
    pub force_peak_n: Option<f64>,
    /// Impulse of the force pulse \[N s\].
    pub impulse_ns: Option<f64>,
    /// Full width of the force pulse at half its height \[s\].
    pub pulse_width_s: Option<f64>,
    /// True for a second impact of the hammer.
    pub double_hit: bool,
    /// True for a saturated signal.
    pub overload: bool,
    /// True for a constant or lost signal.
    pub dropout: bool,
    /// True for a hit in the average.
    pub averaged: bool,
    /// Quality issues, in words.
    #[serde(rename = "verdicts")]
    pub issues: Vec<String>,
    /// Fundamental; `None` without a peak, or for an excluded hit.
    pub fundamental: Option<HitFundamental>,
    /// Time after the trigger at which the response is noise and the features end \[s\]; `None`
    /// where they are of the whole hit.
    pub response_end_s: Option<f64>,
    /// Peak in 1.7 to 2.3 of f1 that is well above the noise.
    pub second_peak: Option<HitSecondPeak>,
    /// Second harmonic: the second peak, where the test decided that it is the harmonic.
    pub second_harmonic: Option<HitSecondHarmonic>,
    /// Harmonic ratio A2/A1, a ratio of receptances.
    pub harmonic_ratio: Option<f64>,
    /// Standard deviation of the ratio due to noise.
    pub harmonic_ratio_uncertainty: Option<f64>,
    /// Time from the first impact to the last of a force that rings \[s\].
    #[serde(skip)]
    pub(crate) ring_s: Option<f64>,
}

/// Most further impacts of a hammer that bounces; more are ringing.
const MOST_BOUNCES: usize = 3;

/// Fundamental of a hit, corrected for an exponential window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HitFundamental {
    /// Frequency f1 \[Hz\].
    pub frequency_hz: f64,
    /// Receptance A1 \[m/N\].
    pub magnitude: f64,
    /// Half-power damping ratio; `None` for a peak that does not fall to half power.
    pub damping_ratio: Option<f64>,
    /// Damping ratio of the circle fit to the mobility.
    pub damping_ratio_circle: Option<f64>,
    /// Damping ratio of the logarithmic decrement of the filtered decay.
    pub damping_ratio_decrement: Option<f64>,
    /// Standard deviation of the frequency due to noise \[Hz\].
    pub frequency_uncertainty_hz: Option<f64>,
    /// Standard deviation of the receptance due to noise \[m/N\].
    pub magnitude_uncertainty: Option<f64>,
    /// Standard deviation of the half-power damping ratio due to noise.
    pub damping_ratio_uncertainty: Option<f64>,
    /// Standard deviation of the damping ratio of the circle fit due to noise.
    pub damping_ratio_circle_uncertainty: Option<f64>,
    /// Standard deviation of the damping ratio of the decrement due to noise.
    pub damping_ratio_decrement_uncertainty: Option<f64>,
    /// Undamped natural frequency of the circle fit \[Hz\].
    pub natural_frequency_hz: Option<f64>,
    /// Standard deviation of the natural frequency due to noise \[Hz\].
    pub natural_frequency_uncertainty_hz: Option<f64>,
    /// Modal constant of the circle fit, real and imaginary \[1/kg\]; for a real mode its reciprocal
    /// is the modal mass.
    pub modal_constant_per_kg: Option<[f64; 2]>,
    /// Standard deviation of its magnitude due to noise \[1/kg\].
    pub modal_constant_uncertainty_per_kg: Option<f64>,
}

/// Second harmonic of a hit, not corrected for an exponential window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HitSecondHarmonic {
    /// Frequency f2 \[Hz\].
    pub frequency_hz: f64,
    /// Receptance A2 \[m/N\].
    pub magnitude: f64,
}

/// Average of the good hits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AverageReport {
    /// Number of averaged hits.
    pub hits: usize,
    /// Numbers of the excluded hits.
    pub excluded: Vec<usize>,
    /// Fundamental; `None` without a peak in the band. It is not corrected for an exponential
    /// window.
    pub fundamental: Option<AverageFundamental>,
    /// Lowest frequency with insufficient force \[Hz\].
    pub first_masked_hz: Option<f64>,
    /// Frequencies of the hits' fundamentals \[Hz\].
    pub frequency_hz: Option<HitStatistics>,
    /// Receptances of the hits' fundamentals \[m/N\].
    pub magnitude: Option<HitStatistics>,
    /// Harmonic ratios A2/A1 of the hits.
    pub harmonic_ratio: Option<HitStatistics>,
}

/// Fundamental of the averaged function.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AverageFundamental {
    /// Frequency of the largest receptance, between the spectral lines too \[Hz\].
    pub frequency_hz: f64,
    /// Receptance there \[m/N\].
    pub magnitude: f64,
    /// Damping ratio from the half-power width.
    pub damping_ratio: Option<f64>,
    /// Damping ratio from the circle fit.
    pub damping_ratio_circle: Option<f64>,
    /// Coherence at the nearest line; `None` for one hit.
    pub coherence: Option<f64>,
}

/// Statistics of a quantity over the hits.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct HitStatistics {
    /// Number of hits with the quantity.
    pub hits: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation, with `n - 1`; `None` for one hit.
    pub standard_deviation: Option<f64>,
    /// Smallest.
    pub smallest: f64,
    /// Largest.
    pub largest: f64,
}

/// Version and files of an analysis.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AnalysisProvenance {
    /// Version of asperity.
    pub version: &'static str,
    /// Settings of the rig that were read; `None` without a file of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<RigFile>,
    /// Files, in their order.
    pub files: Vec<AnalysedFile>,
}

/// File of a rig's settings.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct RigFile {
    /// Name, as given.
    pub file: String,
    /// SHA-256 of the file.
    pub sha256: String,
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

impl HitReport {
    /// Report of a hit, without its number.
    pub(crate) fn new(
        file: String,
        record: usize,
        start_s: f64,
        rate: f64,
        hit: &AnalysedHit,
    ) -> Self {
        let any = |fits: fn(&QualityIssue) -> bool| hit.issues.iter().any(fits);
        let features = hit.features.as_ref();
        let is_noise = features.is_some_and(|found| {
            found.mode.frequency_hz.is_some() && found.fundamental_uncertainty.is_none()
        });
        let doubtful = is_noise.then(|| "the peak at f1 may be noise".to_owned());
        let impacts = || {
            hit.issues.iter().filter_map(|issue| match issue {
                QualityIssue::DoubleHit(double) => Some(double),
                _ => None,
            })
        };
        let last = impacts().map(|double| double.second_s - double.first_s).reduce(f64::max);
        let ring_s = last.filter(|_| impacts().count() > MOST_BOUNCES);
        let rings = ring_s.map(|ring| {
            let further = impacts().count();
            format!("the force rings for {ring:.3} s after the first impact ({further} peaks)")
        });
        let is_told =
            |issue: &&QualityIssue| rings.is_none() || !matches!(issue, QualityIssue::DoubleHit(_));
        Self {
            file,
            index: 0,
            record,
            time_s: start_s + (hit.start + hit.trigger as u64) as f64 / rate,
            samples: hit.samples,
            force_peak_n: hit.pulse.map(|pulse| pulse.refined_peak_n),
            impulse_ns: hit.pulse.map(|pulse| pulse.impulse_n_s),
            pulse_width_s: hit.pulse.map(|pulse| pulse.width_s),
            double_hit: any(|issue| matches!(issue, QualityIssue::DoubleHit(_))),
            overload: any(|issue| {
                matches!(issue, QualityIssue::Overload { .. } | QualityIssue::Clipped { .. })
            }),
            dropout: any(|issue| {
                matches!(issue, QualityIssue::Dropout { .. } | QualityIssue::NotFinite { .. })
            }),
            averaged: hit.is_averaged(),
            issues: rings
                .iter()
                .cloned()
                .chain(hit.issues.iter().filter(is_told).map(ToString::to_string))
                .chain(doubtful)
                .collect(),
            ring_s,
            fundamental: features.and_then(HitFundamental::of),
            response_end_s: hit
                .response_window
                .map(|window| window.end_s + window.taper_s - hit.trigger as f64 / rate),
            second_peak: features.and_then(HitSecondPeak::of),
            second_harmonic: None,
            harmonic_ratio: None,
            harmonic_ratio_uncertainty: None,
        }
    }

    /// Takes the second peak as the second harmonic.
    pub(crate) fn accept_harmonic(&mut self) {
        if let Some(peak) = &self.second_peak {
            self.second_harmonic = Some(HitSecondHarmonic {
                frequency_hz: peak.frequency_hz,
                magnitude: peak.magnitude,
            });
            self.harmonic_ratio = Some(peak.ratio);
            self.harmonic_ratio_uncertainty = peak.ratio_uncertainty;
        }
    }
}

impl HitSecondPeak {
    fn of(found: &HitFeatures) -> Option<Self> {
        let peak = found.harmonics.second?;
        let (sigma, test) = (found.second_uncertainty, found.harmonic_test);
        Some(Self {
            frequency_hz: peak.frequency_hz,
            magnitude: peak.magnitude,
            ratio: found.harmonics.ratio()?,
            frequency_uncertainty_hz: sigma.map(|sigma| sigma.frequency_hz),
            magnitude_uncertainty: sigma.map(|sigma| sigma.magnitude),
            ratio_uncertainty: found.ratio_uncertainty,
            phase_drift_rad: test.map(|test| test.phase_drift),
            amplitude_exponent: test.map(|test| test.exponent),
            decay_cycles: test.map(|test| test.cycles),
            decay_origin: test.and_then(|test| test.origin()).map(name_of_origin),
        })
    }
}

impl HitFundamental {
    fn of(found: &HitFeatures) -> Option<Self> {
        let sigma = found.fundamental_uncertainty;
        // A peak that may be noise has no standard deviations.
        let mode = sigma.map(|_| found.mode_uncertainty).unwrap_or_default();
        Some(Self {
            frequency_hz: found.mode.frequency_hz?,
            magnitude: found.mode.magnitude?,
            damping_ratio: found.mode.damping.half_power,
            damping_ratio_circle: found.mode.damping.circle,
            damping_ratio_decrement: found.mode.damping.decrement,
            frequency_uncertainty_hz: sigma.map(|sigma| sigma.frequency_hz),
            magnitude_uncertainty: mode.magnitude,
            damping_ratio_uncertainty: mode.half_power,
            damping_ratio_circle_uncertainty: mode.circle,
            damping_ratio_decrement_uncertainty: mode.decrement,
            natural_frequency_hz: found.mode.natural_hz,
            natural_frequency_uncertainty_hz: mode.natural_hz,
            modal_constant_per_kg: found.mode.modal_constant.map(|value| [value.re, value.im]),
            modal_constant_uncertainty_per_kg: mode.modal_constant,
        })
    }
}

impl HitStatistics {
    /// Statistics of some values; `None` without any.
    pub(crate) fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.collect();
        let hits = values.len();
        let mean = values.iter().sum::<f64>() / hits as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        (hits > 0).then(|| Self {
            hits,
            mean,
            standard_deviation: (hits > 1).then(|| (squares / (hits as f64 - 1.0)).sqrt()),
            smallest: values.iter().copied().fold(f64::INFINITY, f64::min),
            largest: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        })
    }
}
