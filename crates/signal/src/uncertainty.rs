//! Uncertainty of a peak from noise.

use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::spectra::{HitSpectra, SignalTransform};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// One-sided spectral densities of the noise near a peak.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NoiseDensity {
    /// Density of the force noise, in N^2 / Hz.
    pub force: f64,
    /// Density of the response noise, in its unit squared per hertz.
    pub response: f64,
    /// Decay rate `r` of an exponential window `exp(-r t)` from the first sample on, in 1/s; zero
    /// without one. The densities are those at the first sample.
    pub window_rate: f64,
}

/// Standard deviations of a peak caused by noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakUncertainty {
    /// Standard deviation of the frequency, in hertz.
    pub frequency_hz: f64,
    /// Standard deviation of the magnitude, in m/N.
    pub magnitude: f64,
    /// Standard deviation of the magnitude over the magnitude.
    pub relative: f64,
    /// Standard deviation of the curvature of the noise over the curvature of the peak.
    ///
    /// The first order is valid up to about 0.1
    /// ([`PeakUncertainty::is_first_order`]). Above, the noise itself has
    /// maxima, the peak found may be one of them, and the deviations are meaningless. A
    /// record much longer than the decay is mostly noise: shorten or window it.
    pub roughness: f64,
}

/// Largest roughness for which the first order is valid.
const ROUGH: f64 = 0.1;

impl PeakUncertainty {
    /// True if the first order is valid, with a roughness below 0.1; otherwise the peak itself may
    /// be noise.
    pub fn is_first_order(&self) -> bool {
        self.roughness < ROUGH
    }
}

/// Standard deviations of a peak's frequency and magnitude, to first order in the noise.
///
/// Noise adds `N` to the transform `X` of the response. The maximum of
/// `ln |X/F|` moves by the change of its slope over its curvature, and its height
/// changes by the real part of `N/X`:
///
/// ```text
/// df = -Re(N'/X - N X'/X^2) / (ln |H|)'',     d ln A = Re(N/X),
/// var Re sum n_k g_k = (S rate / 4) sum exp(-2 r t_k) |g_k|^2
/// ```
///
/// and likewise for the force, over the samples from its first to its last that
/// is not zero, which a [`ForceWindow`](crate::ForceWindow) shortens. Valid for
/// stationary noise of the given density about the peak in a record of many cycles
/// (equal variances of real and imaginary parts), small against `X` in height
/// and in curvature ([`PeakUncertainty::roughness`]). Without noise the deviations are zero.
///
/// `None` if a density is negative or not finite, or the peak is flat.
///
/// ```
/// use asperity_signal::{
///     FrequencyResponse, HarmonicOptions, NoiseDensity, find_harmonics, peak_uncertainty,
/// };
///
/// // Impulse response of a 1 kg oscillator at 200 Hz with 2 % of critical damping.
/// let (rate, omega, zeta) = (2e4, std::f64::consts::TAU * 200.0, 0.02_f64);
/// let damped = omega * (1.0 - zeta * zeta).sqrt();
/// let displacement: Vec<f64> = (0..20_000)
///     .map(|n| f64::from(n) / rate)
///     .map(|t| (-zeta * omega * t).exp() * (damped * t).sin() / damped)
///     .collect();
/// let mut force = vec![0.0; displacement.len()];
/// force[0] = rate;
/// let hit = FrequencyResponse::from_displacement(&force, &displacement, rate)?;
/// let peak = find_harmonics(&hit, 190.0, &HarmonicOptions::default()).fundamental.ok_or("a peak")?;
/// let noise = NoiseDensity { response: 1e-18, ..NoiseDensity::default() };
/// let found = peak_uncertainty(&hit, &peak, noise).ok_or("a curved peak")?;
/// assert!(found.is_first_order() && found.relative < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn peak_uncertainty(
    response: &FrequencyResponse,
    peak: &Peak,
    noise: NoiseDensity,
) -> Option<PeakUncertainty> {
    let valid = |density: f64| density.is_finite() && density >= 0.0;
    if ![noise.force, noise.response, noise.window_rate].into_iter().all(valid) {
        return None;
    }
    let frequency = peak.frequency_hz;
    // The curve varies over 1/T: a step of 2 % of that gives the curvature to 1e-3.
    let step = 0.02 / response.duration();
    let slope = |f: f64| 0.5 * response.power_and_slope(f).1;
    let curvature = (slope(frequency + step) - slope(frequency - step)) / (2.0 * step);
    let transforms = response.transforms_at(frequency);
    let mut sums = [0.0; 3];
    for (signal, density) in
        [(transforms.response, noise.response), (transforms.force, noise.force)]
    {
        let added = variances(&signal, density, noise.window_rate, response.sample_rate_hz());
        sums.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
    }
    let [relative, slope, roughness] = sums.map(f64::sqrt);
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
/// The noise of two peaks is independent if their frequencies are further apart than `1 / T`.
pub fn ratio_uncertainty(ratio: f64, first: &PeakUncertainty, second: &PeakUncertainty) -> f64 {
    ratio * first.relative.hypot(second.relative)
}

/// Variances of `ln |X|`, its slope and its curvature for white noise under an exponential window.
fn variances(signal: &SignalTransform, density: f64, window_rate: f64, rate: f64) -> [f64; 3] {
    if density == 0.0 {
        return [0.0; 3];
    }
    let dt = 1.0 / rate;
    // N/X, its slope and its curvature are sums over the noise with weights
    // dt (a t + b)^n exp(-i w t) / X, n = 0, 1, 2 (but for the curvature of ln X).
    let b = signal.slope / signal.value * Complex64::new(0.0, -1.0);
    let mut sums = [0.0; 3];
    // exp(-2 r t) by a product: its rounding grows with the samples, to 1e-10.
    let mut weight = (-2.0 * window_rate * signal.samples.start as f64 * dt).exp();
    let factor = (-2.0 * window_rate * dt).exp();
    for index in signal.samples.clone() {
        let square = (b + TAU * index as f64 * dt).norm_sqr();
        sums[0] += weight;
        sums[1] += weight * square;
        sums[2] += weight * square * square;
        weight *= factor;
    }
    let scale = 0.25 * density * rate * dt * dt / signal.value.norm_sqr();
    sums.map(|sum| scale * sum)
}
