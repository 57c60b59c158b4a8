//! Content of `analysis.json`.

use serde::Serialize;

use crate::force_level::ForceLevel;
use crate::hit_report::{HitReport, HitStatistics};
use crate::modes::Mode;
use crate::options::RigFile;
use crate::second_peak::SecondPeakReport;
use crate::stream::{AnalysedFile, UsedChannel};

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
