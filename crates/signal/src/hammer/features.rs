//! Features of one hit.

use super::HammerOptions;
use super::band_modes::{self, BandMode};
use super::harmonic_origin::HarmonicTest;
use super::hit_noise::is_prominent;
use super::mode_features::ModeFeatures;
use super::mode_uncertainty::ModeUncertainty;
use crate::dominant::dominant_frequency;
use crate::form::FrfForm;
use crate::harmonics::{Harmonics, find_harmonics, second_harmonic};
use crate::noise::{MeasuredPart, white_density};
use crate::peak::Peak;
use crate::pulse::Pulse;
use crate::response::FrequencyResponse;
use crate::ring_down::{
    Backbone, BackboneOptions, BackboneUncertainty, BandPass, backbone_and_signal,
};
use crate::uncertainty::{
    NoiseDensity, NoiseWindows, PeakUncertainty, peak_uncertainty, ratio_uncertainty,
};
use crate::window::ResponseWindow;

/// Reference of the search for the fundamental.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum FundamentalSearch {
    /// A known frequency near the fundamental, in hertz.
    Frequency(f64),
    /// The [`dominant_frequency`](crate::dominant_frequency) of a band (in hertz) in a form.
    Band((f64, f64), FrfForm),
}

/// Harmonics, damping and backbone of one hit.
#[derive(Debug, Clone, PartialEq)]
pub struct HitFeatures {
    /// Reference frequency of the windows of the search, in hertz.
    pub reference_hz: f64,
    /// Fundamental and second harmonic, not corrected for the windows; no second harmonic unless it
    /// is eight standard deviations of the noise above the minima beside it.
    pub harmonics: Harmonics,
    /// Noise before any window, the source of the uncertainties.
    pub noise: NoiseDensity,
    /// Uncertainty of the fundamental of the windowed signals; `None` for a peak that may be noise.
    pub fundamental_uncertainty: Option<PeakUncertainty>,
    /// Uncertainty of the second harmonic.
    pub second_uncertainty: Option<PeakUncertainty>,
    /// Behaviour of the second harmonic in the decay; `None` without one, and where it is noise.
    pub harmonic_test: Option<HarmonicTest>,
    /// Standard deviation of the ratio of receptances `A2/A1`.
    pub ratio_uncertainty: Option<f64>,
    /// The mode of the fundamental, corrected for the exponential window; empty without a
    /// fundamental.
    pub mode: ModeFeatures,
    /// Standard deviations of the mode.
    pub mode_uncertainty: ModeUncertainty,
    /// Modes in the band of the search, the fundamental among them; none without a
    /// [band](FundamentalSearch::Band).
    pub modes: Vec<BandMode>,
    /// Backbone from the decay of the response without window.
    pub backbone: Option<Backbone>,
    /// Standard deviations of its points due to noise.
    pub backbone_uncertainty: Vec<BackboneUncertainty>,
}

/// The features of a hit; `None` without a reference frequency.
///
/// `response` is windowed and interpolated; `unwindowed` lacks the window of the response, and
/// `measured` is its samples as they were.
pub(super) fn of_hit(
    (response, unwindowed): (&FrequencyResponse, &FrequencyResponse),
    measured: &[f64],
    pulse: &Pulse,
    noise: NoiseDensity,
    options: &HammerOptions,
) -> Option<HitFeatures> {
    let threshold = options.harmonics.force_threshold;
    let reference_hz = match options.fundamental {
        FundamentalSearch::Frequency(frequency) => frequency,
        FundamentalSearch::Band(band, form) => dominant_frequency(response, band, form, threshold)?,
    };
    let mut harmonics = find_harmonics(response, reference_hz, &options.harmonics);
    let fundamental = harmonics.fundamental;
    let first = fundamental.and_then(|peak| reliable(response, &peak, noise));
    let mut second = None;
    if let Some(fundamental) = fundamental
        && options.windows.until_noise
        && options.windows.exponential.is_none()
    {
        harmonics.second = None;
        // A harmonic decays faster than its fundamental, and is noise earlier.
        let (shorter, noise) = until_harmonic_is_noise(unwindowed, fundamental.frequency_hz, noise);
        let response = shorter.as_ref().unwrap_or(response);
        let peak = second_harmonic(response, fundamental.frequency_hz, &options.harmonics);
        if let Some(peak) = peak
            && let Some(sigma) = reliable(response, &peak, noise)
        {
            (harmonics.second, second) = (Some(peak), Some(sigma));
        }
    } else {
        second = harmonics.second.and_then(|peak| reliable(response, &peak, noise));
        if second.is_none() {
            harmonics.second = None;
        }
    }
    let ratio = harmonics.ratio().zip(first.zip(second));
    let mut found = HitFeatures {
        reference_hz,
        noise,
        fundamental_uncertainty: first,
        second_uncertainty: second,
        ratio_uncertainty: ratio.map(|(ratio, (a, b))| ratio_uncertainty(ratio, &a, &b)),
        harmonic_test: None,
        mode: ModeFeatures::default(),
        mode_uncertainty: ModeUncertainty::default(),
        modes: Vec::new(),
        backbone: None,
        backbone_uncertainty: Vec::new(),
        harmonics,
    };
    let Some(peak) = found.harmonics.fundamental else {
        return Some(found);
    };
    let rate = response.sample_rate_hz();
    let begin = ((pulse.base_s.1 * rate).ceil() as usize).min(measured.len());
    let part = MeasuredPart::of(measured);
    let free = &measured[begin..part.measured.max(begin)];
    if found.harmonics.second.is_some() {
        found.harmonic_test = HarmonicTest::of(free, rate, peak.frequency_hz, noise.response);
    }
    let band = BandPass::around(peak.frequency_hz, options.band_part).ok();
    let remaining =
        white_density(&measured[part.measured - part.measured / 10..part.measured], rate);
    let remaining = remaining.filter(|_| options.noise_band_hz.is_none()).unwrap_or(0.0);
    let settings = band.map(|band| BackboneOptions {
        cycles: options.cycles,
        // Other modes that still ring at the end count as noise.
        noise_density: noise.response.max(remaining),
        floor: part.resolved,
        derivatives: options.response_kind.derivatives(),
        ..BackboneOptions::new(band)
    });
    let filtered = settings.and_then(|settings| backbone_and_signal(free, rate, &settings).ok());
    // Between its first and last point the filtered decay is that of the mode, after the ringing
    // of the edges and above the noise.
    let decay = filtered.as_ref().and_then(|(backbone, signal)| {
        let (first, last) = (backbone.points.first()?, backbone.points.last()?);
        let span = (first.time_s * rate) as usize..(last.time_s * rate) as usize;
        Some(signal.get(span)?.iter().map(|value| value.re).collect::<Vec<f64>>())
    });
    if let (Some((backbone, _)), Some(settings)) = (filtered, settings) {
        let uncertainties = backbone.points.iter().map(|point| point.uncertainty(&settings));
        found.backbone_uncertainty = uncertainties.collect();
        found.backbone = Some(backbone);
    }
    let decay = decay.unwrap_or_default();
    let window = options.windows.exponential;
    found.mode = ModeFeatures::of(response, &peak, &decay, window);
    found.mode_uncertainty = ModeUncertainty::of(response, &peak, &noise, window);
    if let Some(settings) = settings {
        let (frequency, density) = (peak.frequency_hz, noise.response);
        found.mode_uncertainty =
            found.mode_uncertainty.with_decrement(&decay, rate, frequency, density, &settings);
    }
    let fundamental = BandMode { peak, features: found.mode, uncertainty: found.mode_uncertainty };
    let responses = (response, unwindowed);
    found.modes = band_modes::modes_of(responses, measured, &noise, &fundamental, options);
    Some(found)
}

/// Uncertainty of a peak that is well above the noise; `None` for one that may be noise.
fn reliable(
    response: &FrequencyResponse,
    peak: &Peak,
    noise: NoiseDensity,
) -> Option<PeakUncertainty> {
    let is_above_noise =
        |sigma: &PeakUncertainty| sigma.is_first_order() && is_prominent(peak, sigma);
    peak_uncertainty(response, peak, noise).filter(is_above_noise)
}

/// A hit whose response ends where the second harmonic is noise, and the noise with that window;
/// no hit where the harmonic has no such end.
fn until_harmonic_is_noise(
    unwindowed: &FrequencyResponse,
    fundamental_hz: f64,
    noise: NoiseDensity,
) -> (Option<FrequencyResponse>, NoiseDensity) {
    let rate = unwindowed.sample_rate_hz();
    // After the fundamental's decay there is no harmonic.
    let end = noise.windows.response.map_or(f64::INFINITY, |window| window.end_s * rate);
    let samples = &unwindowed.samples()[..unwindowed.samples().len().min(end as usize)];
    let window = ResponseWindow::until_noise(samples, rate, 2.0 * fundamental_hz, noise.response);
    let Some(window) = window else {
        return (None, noise);
    };
    let windows = NoiseWindows { response: Some(window), ..noise.windows };
    let response = unwindowed.with_response_window(&window).interpolated();
    (Some(response), NoiseDensity { windows, ..noise })
}
