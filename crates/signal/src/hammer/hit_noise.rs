//! Noise of one hit, and what stands out of it.

use super::HammerOptions;
use crate::noise::{MeasuredPart, band_density, quiet_density};
use crate::peak::Peak;
use crate::uncertainty::{NoiseDensity, NoiseWindows, PeakUncertainty};
use crate::window::DecayEnvelope;

/// Least height of a second harmonic above the minima beside it, in standard deviations of the noise.
const PROMINENCE: f64 = 8.0;

/// True for a peak that is well above the minima beside it.
pub(super) fn is_prominent(peak: &Peak, sigma: &PeakUncertainty) -> bool {
    peak.prominence > PROMINENCE * sigma.relative
}

/// Band of the noise, over the fundamental.
const NOISE_BAND: (f64, f64) = (0.5, 2.5);

/// Parts of a hit that are quiet: of the force, which rests after the pulse at its beginning, and of
/// the response at first.
const QUIET_FORCE: f64 = 0.25;
const QUIET_RESPONSE: f64 = 0.75;

/// Densities of the noise of force and response about a resonance (Hz), and the end of the response's
/// decay with [`HitWindows::until_noise`](super::HitWindows).
pub(super) fn noise_density(
    force: &[f64],
    response: &[f64],
    rate: f64,
    resonance_hz: f64,
    options: &HammerOptions,
) -> NoiseDensity {
    let band = (NOISE_BAND.0 * resonance_hz, NOISE_BAND.1 * resonance_hz);
    // Padding is no noise, and rounding is the least. A force may rest at zero.
    let part = MeasuredPart::of(response);
    let from = |samples: &[f64], begin: f64| {
        let samples = &samples[..part.measured.min(samples.len())];
        let quiet = &samples[(begin as usize).min(samples.len())..];
        quiet_density(quiet, rate, band).unwrap_or(0.0)
    };
    let of_response = |begin: f64| from(response, begin).max(part.rounding_density(rate));
    let measured = part.measured as f64;
    let mut found = NoiseDensity {
        force: from(force, QUIET_FORCE * measured),
        response: of_response(QUIET_RESPONSE * measured),
        windows: NoiseWindows::default(),
    };
    if let Some(band) = options.noise_band_hz {
        found.response = band_density(response, rate, band).ok().flatten().unwrap_or(0.0);
    }
    let envelope = DecayEnvelope::of(response, rate, resonance_hz);
    let window = |density| envelope.as_ref()?.until_noise(response, density);
    let decayed = window(found.response);
    if let (Some(decayed), None) = (decayed, options.noise_band_hz) {
        // All of the response after the decay is noise.
        let begin = (decayed.end_s + decayed.taper_s) * rate;
        found.response = of_response(begin.min(QUIET_RESPONSE * measured));
    }
    if options.windows.until_noise {
        found.windows.response = window(found.response);
    }
    found
}
