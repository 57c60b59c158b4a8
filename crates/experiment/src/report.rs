//! `analysis.json`: the answers, under the names of the contract.

use asperity_signal::{AnalysedHit, HitFeatures, QualityIssue};
use serde::Serialize;

use crate::stream::UsedChannel;

/// Identifier of the analysis' format.
pub const ANALYSIS_SCHEMA: &str = "asperity/analysis/1";

/// The analysis of measured hits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnalysisReport {
    /// [`ANALYSIS_SCHEMA`].
    pub schema: &'static str,
    /// Samples per second \[Hz\].
    pub sample_rate_hz: f64,
    /// Force and response, as the first file names them.
    pub channels: Vec<UsedChannel>,
    /// What was decided on the way, by the user or by the data.
    pub settings: Settings,
    /// Every hit, the bad ones too, in the order of the files.
    pub hits: Vec<HitReport>,
    /// The average of the good ones.
    pub average: AverageReport,
    /// What was assumed, snapped or left out.
    pub notices: Vec<String>,
    /// From what it was computed.
    pub provenance: AnalysisProvenance,
}

/// How the hits were cut and transformed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// Trigger level \[N\].
    pub level_n: f64,
    /// Robust deviation of the force over all files \[N\].
    pub noise_n: f64,
    /// Longest hit \[s\].
    pub length_s: f64,
    /// Time kept before the trigger \[s\].
    pub pre_trigger_s: f64,
    /// Time after a trigger without a further hit \[s\].
    pub hold_off_s: f64,
    /// `h1`, `h2` or `hv`.
    pub estimator: &'static str,
    /// Response over force as it was measured: `receptance` of a displacement, `mobility` of a
    /// velocity, `accelerance` of an acceleration.
    pub measured_form: &'static str,
    /// What every `magnitude`, `harmonic_ratio` and frequency of a peak is of: the `receptance`.
    pub feature_form: &'static str,
    /// What `frf.csv` holds.
    pub frf_form: &'static str,
    /// Whether the force was blanked but for the blow.
    pub force_window: bool,
    /// Time constant of the exponential window \[s\]; none without one.
    pub exponential_window_s: Option<f64>,
    /// Where the fundamental was looked for \[Hz\]; none if no resonance was found.
    pub band_hz: Option<[f64; 2]>,
    /// Whether the band was given.
    pub band_given: bool,
    /// Whether bad hits were averaged too.
    pub keep_all: bool,
}

/// One hit.
#[allow(clippy::struct_excessive_bools, reason = "the contract names each of these answers")]
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HitReport {
    /// Its file, as named.
    pub file: String,
    /// Its number, from 1 through all files.
    pub index: usize,
    /// Its record in the file, from 1.
    pub record: usize,
    /// Time of its trigger on the record's axis \[s\].
    pub time_s: f64,
    /// Number of samples.
    pub samples: usize,
    /// Largest force, refined between the samples \[N\]; none if the force cannot be read.
    pub force_peak_n: Option<f64>,
    /// Impulse of the blow \[N s\].
    pub impulse_ns: Option<f64>,
    /// Full width of the blow at half its height \[s\].
    pub pulse_width_s: Option<f64>,
    /// Whether the hammer touched again.
    pub double_hit: bool,
    /// Whether a converter or amplifier was at its limit.
    pub overload: bool,
    /// Whether a signal stood still or was lost.
    pub dropout: bool,
    /// Whether it is in the average.
    pub averaged: bool,
    /// What is wrong with it, in words.
    pub verdicts: Vec<String>,
    /// The fundamental; none without a peak, or if the hit was excluded.
    pub fundamental: Option<HitFundamental>,
    /// The second harmonic; none without a peak.
    pub second_harmonic: Option<HitSecondHarmonic>,
    /// A2/A1.
    pub harmonic_ratio: Option<f64>,
    /// What noise makes of it: one standard deviation.
    pub harmonic_ratio_uncertainty: Option<f64>,
}

/// The fundamental of a hit; an exponential window is undone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HitFundamental {
    /// Frequency f1 \[Hz\].
    pub frequency_hz: f64,
    /// Receptance A1 \[m/N\].
    pub magnitude: f64,
    /// Half-power damping ratio; none where the peak does not fall to half power.
    pub damping_ratio: Option<f64>,
    /// Damping ratio of the circle through the mobility.
    pub damping_ratio_circle: Option<f64>,
    /// Damping ratio by the logarithmic decrement of the filtered decay.
    pub damping_ratio_decrement: Option<f64>,
    /// What noise makes of the frequency: one standard deviation \[Hz\].
    pub frequency_uncertainty_hz: Option<f64>,
    /// What noise makes of the receptance: one standard deviation \[m/N\].
    pub magnitude_uncertainty: Option<f64>,
}

/// The second harmonic of a hit, with an exponential window's effect still in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HitSecondHarmonic {
    /// Frequency f2 \[Hz\].
    pub frequency_hz: f64,
    /// Receptance A2 \[m/N\].
    pub magnitude: f64,
}

/// The average of the good hits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AverageReport {
    /// Hits averaged.
    pub hits: usize,
    /// Numbers of the hits left out.
    pub excluded: Vec<usize>,
    /// Its fundamental; none without a peak in the band. An exponential
    /// window's effect is still in it.
    pub fundamental: Option<AverageFundamental>,
    /// Lowest frequency at which the force has too little content \[Hz\].
    pub first_masked_hz: Option<f64>,
    /// Frequencies of the hits' fundamentals \[Hz\].
    pub frequency_hz: Option<Spread>,
    /// Receptances of the hits' fundamentals \[m/N\].
    pub magnitude: Option<Spread>,
    /// A2/A1 of the hits.
    pub harmonic_ratio: Option<Spread>,
}

/// The fundamental of the averaged function.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AverageFundamental {
    /// Frequency of the largest receptance, by a parabola through three lines \[Hz\].
    pub frequency_hz: f64,
    /// Receptance there \[m/N\].
    pub magnitude: f64,
    /// Damping ratio of the circle through the lines above half power, if there are five.
    pub damping_ratio: Option<f64>,
    /// Coherence at the nearest line; none for one hit.
    pub coherence: Option<f64>,
}

/// How a number differs from hit to hit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Hits that have it.
    pub hits: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation, with `n - 1`; none for one hit.
    pub standard_deviation: Option<f64>,
    /// Smallest.
    pub smallest: f64,
    /// Largest.
    pub largest: f64,
}

/// From what an analysis was computed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AnalysisProvenance {
    /// Version of asperity.
    pub version: &'static str,
    /// The files, in their order.
    pub files: Vec<AnalysedFile>,
}

/// A file that was analysed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AnalysedFile {
    /// As named.
    pub file: String,
    /// Format found.
    pub format: String,
    /// Records in time.
    pub records: usize,
    /// Samples of each of the two channels.
    pub samples: u64,
    /// SHA-256 of its bytes.
    pub sha256: String,
}

impl HitReport {
    /// The numbers of a hit that was cut from a record of a file.
    pub(super) fn new(
        file: String,
        record: usize,
        start_s: f64,
        rate: f64,
        hit: &AnalysedHit,
    ) -> Self {
        let any = |fits: fn(&QualityIssue) -> bool| hit.issues.iter().any(fits);
        let features = hit.features.as_ref();
        let second = features.and_then(|found| found.harmonics.second);
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
            overload: any(|issue| matches!(issue, QualityIssue::Overload { .. })),
            dropout: any(|issue| {
                matches!(issue, QualityIssue::Dropout { .. } | QualityIssue::NotFinite { .. })
            }),
            averaged: hit.is_averaged(),
            verdicts: hit.issues.iter().map(crate::verdict::in_words).collect(),
            fundamental: features.and_then(HitFundamental::of),
            second_harmonic: second.map(|peak| HitSecondHarmonic {
                frequency_hz: peak.frequency_hz,
                magnitude: peak.magnitude,
            }),
            harmonic_ratio: features.and_then(|found| found.harmonics.ratio()),
            harmonic_ratio_uncertainty: features.and_then(|found| found.ratio_uncertainty),
        }
    }
}

impl HitFundamental {
    fn of(found: &HitFeatures) -> Option<Self> {
        let sigma = found.fundamental_uncertainty;
        Some(Self {
            frequency_hz: found.unwindowed_frequency_hz?,
            magnitude: found.unwindowed_magnitude?,
            damping_ratio: found.damping.half_power,
            damping_ratio_circle: found.damping.circle,
            damping_ratio_decrement: found.damping.decrement,
            frequency_uncertainty_hz: sigma.map(|sigma| sigma.frequency_hz),
            magnitude_uncertainty: sigma.map(|sigma| sigma.magnitude),
        })
    }
}

impl Spread {
    /// The spread of the values that there are; none without any.
    pub(super) fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
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
