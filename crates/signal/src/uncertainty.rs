//! What noise does to a peak.

use crate::peak::Peak;
use crate::response::{Exact, FrequencyResponse};
use realfft::num_complex::Complex64;
use std::f64::consts::TAU;
use std::ops::Range;

/// One-sided spectral densities of the noise near a peak.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NoiseDensity {
    /// Of the force, in N^2 / Hz.
    pub force: f64,
    /// Of the response, in its unit squared per hertz.
    pub response: f64,
    /// Rate `r` at which an exponential window takes the noise down, `exp(-r t)`
    /// from the first sample on, in 1/s; zero without one. The densities are
    /// then those at the first sample.
    pub window_rate: f64,
}

/// Standard deviations of a peak that noise causes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakUncertainty {
    /// Of the peak's frequency, in hertz.
    pub frequency_hz: f64,
    /// Of the peak's magnitude, in m/N.
    pub magnitude: f64,
    /// Of the magnitude over the magnitude.
    pub relative: f64,
    /// Standard deviation of the curvature that noise adds, over the peak's own.
    ///
    /// The first order holds while this is below about 0.1
    /// ([`PeakUncertainty::is_first_order`]). Beyond, noise makes
    /// maxima of its own, the peak picked may be one of them (they are sharp,
    /// so that this ratio stays below one), and the deviations mean nothing. A
    /// record much longer than the decay is mostly noise; shorten or window it.
    pub roughness: f64,
}

/// Largest roughness for which the first order holds.
const ROUGH: f64 = 0.1;

impl PeakUncertainty {
    /// Whether the first order holds: the roughness is below 0.1.
    ///
    /// Where it does not, the peak itself may be noise.
    pub fn is_first_order(&self) -> bool {
        self.roughness < ROUGH
    }
}

/// Standard deviations of a peak's frequency and magnitude, to first order in the noise.
///
/// Noise adds `N` to the transform `X` of the response. The maximum of
/// `ln |X/F|` then moves by its slope's change over its curvature, its height
/// changes by the real part of `N/X`:
///
/// ```text
/// df = -Re(N'/X - N X'/X^2) / (ln |H|)'',     d ln A = Re(N/X),
/// var Re sum n_k g_k = (S rate / 4) sum exp(-2 r t_k) |g_k|^2
/// ```
///
/// and alike for the force, over the samples from its first to its last that
/// is not zero: a [`ForceWindow`](crate::ForceWindow) shortens them. For
/// stationary noise with the given density about the peak, as many cycles long
/// that its real and imaginary parts are alike, and small against `X` in height
/// and in curvature ([`PeakUncertainty::roughness`]).
///
/// `None` if the densities are negative or not finite, or the peak is flat.
pub fn peak_uncertainty(
    response: &FrequencyResponse,
    peak: &Peak,
    noise: NoiseDensity,
) -> Option<PeakUncertainty> {
    uncertainty_of(response, peak, noise)
}

/// [`peak_uncertainty`] of whatever gives the spectra of a hit.
pub(crate) fn uncertainty_of(
    hit: &impl Exact,
    peak: &Peak,
    noise: NoiseDensity,
) -> Option<PeakUncertainty> {
    let response = hit.response();
    let valid = |density: f64| density.is_finite() && density >= 0.0;
    if ![noise.force, noise.response, noise.window_rate].into_iter().all(valid) {
        return None;
    }
    let frequency = peak.frequency_hz;
    // The curve is smooth over 1/T: a small part of that gives its curvature to 1e-3.
    let step = 0.02 / response.duration();
    let slope = |f: f64| 0.5 * hit.power_and_slope(f).1;
    let curvature = (slope(frequency + step) - slope(frequency - step)) / (2.0 * step);
    let terms = hit.transforms_at(frequency);
    let shares = [(terms.response, noise.response), (terms.force, noise.force)];
    let mut variances = [0.0; 3];
    for (term, density) in shares {
        let share = term.variances(density, noise.window_rate, response.sample_rate_hz());
        variances.iter_mut().zip(share).for_each(|(sum, share)| *sum += share);
    }
    let [relative, slope, roughness] = variances.map(f64::sqrt);
    let frequency_hz = slope / curvature.abs();
    (frequency_hz.is_finite() && relative.is_finite()).then_some(PeakUncertainty {
        frequency_hz,
        magnitude: relative * peak.magnitude,
        relative,
        roughness: roughness / curvature.abs(),
    })
}

/// Standard deviation of the ratio `second / first` of two peaks with independent noise.
///
/// Noise is independent at frequencies further apart than one over the record.
pub fn ratio_uncertainty(ratio: f64, first: &PeakUncertainty, second: &PeakUncertainty) -> f64 {
    ratio * first.relative.hypot(second.relative)
}

/// A transform, its derivative with frequency, and the samples it is taken over.
pub(crate) struct Term {
    pub(crate) value: Complex64,
    pub(crate) slope: Complex64,
    pub(crate) samples: Range<usize>,
}

/// Those of the response and of the force at one frequency.
pub(crate) struct Terms {
    pub(crate) response: Term,
    pub(crate) force: Term,
}

impl Term {
    /// Variances of `ln |X|`, its slope and its curvature for white noise that falls.
    fn variances(&self, density: f64, window_rate: f64, rate: f64) -> [f64; 3] {
        if density == 0.0 {
            return [0.0; 3];
        }
        let dt = 1.0 / rate;
        // N/X, its slope and its curvature are sums over the noise with weights
        // dt (a t + b)^n exp(-i w t) / X, n = 0, 1, 2 (but for the curvature of ln X).
        let b = self.slope / self.value * Complex64::new(0.0, -1.0);
        let mut sums = [0.0; 3];
        // exp(-2 r t) by a product: its rounding grows with the samples, to 1e-10.
        let mut weight = (-2.0 * window_rate * self.samples.start as f64 * dt).exp();
        let fall = (-2.0 * window_rate * dt).exp();
        for index in self.samples.clone() {
            let square = (b + TAU * index as f64 * dt).norm_sqr();
            sums[0] += weight;
            sums[1] += weight * square;
            sums[2] += weight * square * square;
            weight *= fall;
        }
        let scale = 0.25 * density * rate * dt * dt / self.value.norm_sqr();
        sums.map(|sum| scale * sum)
    }
}
