//! Modes of a band in the response to one hit.

use super::hit_noise::{is_prominent, noise_density};
use super::mode_features::ModeFeatures;
use super::mode_uncertainty::ModeUncertainty;
use super::{FundamentalSearch, HammerOptions};
use crate::harmonics::{HarmonicOptions, find_harmonics, peaks_within};
use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::uncertainty::{NoiseDensity, NoiseWindows, peak_uncertainty};

/// Window in which the peak of a mode is found again, over its frequency.
const PEAK_WINDOW: (f64, f64) = (0.98, 1.02);

/// Relative difference of the frequencies of one peak under two windows.
const SAME: f64 = 1e-3;

/// Largest standard deviation of the damping ratio of a mode, over the ratio.
const LARGEST_DEVIATION: f64 = 0.2;

/// A mode in the band of the search, from its own peak.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandMode {
    /// Peak of the receptance, not corrected for an exponential window.
    pub peak: Peak,
    /// Features of the mode, corrected for an exponential window, with those of the circle fit and
    /// without a decrement.
    pub features: ModeFeatures,
    /// Their standard deviations.
    pub uncertainty: ModeUncertainty,
}

impl BandMode {
    /// True with a circle whose damping ratio is little uncertain: the many points of the circle are
    /// less sensitive to noise than the top of the peak.
    fn is_certain(&self) -> bool {
        let ratio = self.features.damping.circle.filter(|_| self.features.natural_hz.is_some());
        let deviation = self.uncertainty.circle.unwrap_or(f64::INFINITY);
        ratio.is_some_and(|ratio| deviation < LARGEST_DEVIATION * ratio)
    }
}

/// The modes whose peaks lie in the band of the search, in the order of frequency: those that are
/// well above the noise and have a circle of little uncertainty.
///
/// Each is analysed until its own decay is noise, so that one that decays slowly is not cut where
/// the fundamental has ended. `noise` is that about the fundamental.
pub(super) fn modes_of(
    (response, unwindowed): (&FrequencyResponse, &FrequencyResponse),
    measured: &[f64],
    noise: &NoiseDensity,
    fundamental: &BandMode,
    options: &HammerOptions,
) -> Vec<BandMode> {
    let FundamentalSearch::Band(band, _) = options.fundamental else {
        return Vec::new();
    };
    let again = HarmonicOptions { fundamental_window: PEAK_WINDOW, ..options.harmonics.clone() };
    let window = options.windows.exponential;
    let rate = response.sample_rate_hz();
    let mode = |peak: Peak| -> Option<BandMode> {
        if (peak.frequency_hz / fundamental.peak.frequency_hz - 1.0).abs() < SAME {
            return fundamental.is_certain().then_some(*fundamental);
        }
        // A faster decay than that of the fundamental may be rough under its window.
        peak_uncertainty(response, &peak, *noise).filter(|sigma| is_prominent(&peak, sigma))?;
        let own = noise_density(unwindowed.force(), measured, rate, peak.frequency_hz, options);
        let windows = NoiseWindows { response: own.windows.response, ..noise.windows };
        let own = NoiseDensity { response: own.response, windows, ..*noise };
        let whole = windows.response.map(|window| unwindowed.with_response_window(&window));
        let response = whole.unwrap_or_else(|| unwindowed.clone()).interpolated();
        let peak = find_harmonics(&response, peak.frequency_hz, &again).fundamental?;
        let sigma = peak_uncertainty(&response, &peak, own)?;
        let features = ModeFeatures::of(&response, &peak, &[], window);
        let uncertainty = ModeUncertainty::of(&response, &peak, &own, window);
        let mode = BandMode { peak, features, uncertainty };
        (is_prominent(&peak, &sigma) && mode.is_certain()).then_some(mode)
    };
    let peaks = peaks_within(response, band, &options.harmonics);
    let mut modes: Vec<BandMode> = peaks.into_iter().filter_map(mode).collect();
    modes.sort_by(|a, b| a.peak.frequency_hz.total_cmp(&b.peak.frequency_hz));
    modes.dedup_by(|a, b| (a.peak.frequency_hz / b.peak.frequency_hz - 1.0).abs() < SAME);
    modes
}
