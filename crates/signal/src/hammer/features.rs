//! Features of one hit.

use super::HammerOptions;
use crate::damping::DampingComparison;
use crate::dominant::dominant_frequency;
use crate::form::FrfForm;
use crate::harmonics::{Harmonics, find_harmonics};
use crate::hit::{Offset, Pulse};
use crate::noise::{band_density, white_density};
use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::ring_down::{Backbone, BackboneOptions, BandPass, backbone_and_signal};
use crate::uncertainty::{NoiseDensity, PeakUncertainty, peak_uncertainty, ratio_uncertainty};
use crate::window::ExponentialWindow;

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
    /// Fundamental and second harmonic, not corrected for the windows.
    pub harmonics: Harmonics,
    /// Noise before any window, the source of the uncertainties.
    pub noise: NoiseDensity,
    /// Uncertainty of the fundamental of the windowed signals; the correction for an
    /// exponential window adds the error of the damping ratio.
    pub fundamental_uncertainty: Option<PeakUncertainty>,
    /// Uncertainty of the second harmonic.
    pub second_uncertainty: Option<PeakUncertainty>,
    /// Standard deviation of the ratio of receptances `A2/A1`.
    pub ratio_uncertainty: Option<f64>,
    /// The mode of the fundamental, corrected for the exponential window; empty without a
    /// fundamental.
    pub mode: ModeFeatures,
    /// Backbone from the decay of the response without window.
    pub backbone: Option<Backbone>,
}

/// The features of a hit; `None` without a reference frequency.
///
/// `response` is windowed and interpolated, `measured` is neither; an exponential
/// window has the value one at sample `trigger`.
pub(super) fn of_hit(
    response: &FrequencyResponse,
    measured: &[f64],
    trigger: usize,
    pulse: &Pulse,
    force_offset: Option<&Offset>,
    options: &HammerOptions,
) -> Option<HitFeatures> {
    let threshold = options.harmonics.force_threshold;
    let reference_hz = match options.fundamental {
        FundamentalSearch::Frequency(frequency) => frequency,
        FundamentalSearch::Band(band, form) => dominant_frequency(response, band, form, threshold)?,
    };
    let harmonics = find_harmonics(response, reference_hz, &options.harmonics);
    let noise = noise(response, measured, force_offset, options);
    let in_windowed = options.windows.exponential.map_or(noise, |window| {
        windowed(noise, window, trigger as f64 / response.sample_rate_hz())
    });
    let uncertainty = |peak| peak_uncertainty(response, peak, in_windowed);
    let first = harmonics.fundamental.as_ref().and_then(uncertainty);
    let second = harmonics.second.as_ref().and_then(uncertainty);
    let ratio = harmonics.ratio().zip(first.zip(second));
    let mut found = HitFeatures {
        reference_hz,
        noise,
        fundamental_uncertainty: first,
        second_uncertainty: second,
        ratio_uncertainty: ratio.map(|(ratio, (a, b))| ratio_uncertainty(ratio, &a, &b)),
        mode: ModeFeatures::default(),
        backbone: None,
        harmonics,
    };
    let Some(peak) = found.harmonics.fundamental else {
        return Some(found);
    };
    let rate = response.sample_rate_hz();
    let begin = ((pulse.base_s.1 * rate).ceil() as usize).min(measured.len());
    let free = &measured[begin..];
    let band = BandPass::around(peak.frequency_hz, options.band_part).ok();
    let settings = band.map(|band| BackboneOptions {
        cycles: options.cycles,
        noise_density: noise.response,
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
    found.backbone = filtered.map(|(backbone, _)| backbone);
    let decay = decay.unwrap_or_default();
    found.mode = ModeFeatures::of(response, &peak, &decay, options.windows.exponential);
    Some(found)
}

/// Frequency, receptance and damping of the mode of a peak, corrected for an exponential window.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ModeFeatures {
    /// Frequency of the peak, in hertz; `None` if the correction needs a damping ratio that was not
    /// found.
    pub frequency_hz: Option<f64>,
    /// Receptance at the peak, in m/N, likewise.
    pub magnitude: Option<f64>,
    /// Damping ratios.
    pub damping: DampingComparison,
}

impl ModeFeatures {
    /// The features of a peak of a response under an exponential window, with the free decay of its
    /// mode as for [`DampingComparison::of`].
    pub fn of(
        response: &FrequencyResponse,
        peak: &Peak,
        decay: &[f64],
        window: Option<ExponentialWindow>,
    ) -> Self {
        let mut damping = DampingComparison::of(response, peak, decay);
        let (frequency, magnitude) = (peak.frequency_hz, peak.magnitude);
        let Some(window) = window else {
            return Self { frequency_hz: Some(frequency), magnitude: Some(magnitude), damping };
        };
        let ratio = damping.circle.or(damping.half_power);
        let corrected = |ratio: f64| window.corrected_damping(frequency, ratio);
        damping.half_power = damping.half_power.map(corrected);
        damping.circle = damping.circle.map(corrected);
        Self {
            frequency_hz: ratio.map(|r| window.corrected_peak_frequency(frequency, r, frequency)),
            magnitude: ratio.map(|r| window.corrected_peak(frequency, r, magnitude)),
            damping,
        }
    }
}

/// Densities of the noise before any window.
fn noise(
    response: &FrequencyResponse,
    measured: &[f64],
    force_offset: Option<&Offset>,
    options: &HammerOptions,
) -> NoiseDensity {
    let rate = response.sample_rate_hz();
    let tail = || white_density(&measured[measured.len() - measured.len() / 10..], rate);
    let found = match options.noise_band_hz {
        Some(band) => band_density(measured, rate, band).ok().flatten(),
        None => tail(),
    };
    let force = force_offset.map_or(0.0, |offset| 2.0 * offset.deviation.powi(2) / rate);
    NoiseDensity { force, response: found.unwrap_or(0.0), window_rate: 0.0 }
}

/// Densities at the first sample of windowed signals; the window has the value one at `trigger_s`.
fn windowed(noise: NoiseDensity, window: ExponentialWindow, trigger_s: f64) -> NoiseDensity {
    let grown = (2.0 * window.rate() * trigger_s).exp();
    NoiseDensity {
        force: noise.force * grown,
        response: noise.response * grown,
        window_rate: window.rate(),
    }
}
