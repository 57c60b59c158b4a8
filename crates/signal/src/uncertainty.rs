//! Uncertainty of peaks and damping ratios from noise.

mod linear;

pub(crate) use linear::LogReceptanceTerms;

use crate::damping::half_power_crossings;
use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::spectra::{HitSpectra, SignalTransform};
use crate::window::{ForceWindow, ResponseWindow};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// One-sided spectral densities of the noise near a peak, before any window, and the windows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NoiseDensity {
    /// Density of the force noise, in N^2 / Hz.
    pub force: f64,
    /// Density of the response noise, in its unit squared per hertz.
    pub response: f64,
    /// Windows of the signals.
    pub windows: NoiseWindows,
}

/// Windows through which noise has passed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NoiseWindows {
    /// Decay rate `r` of an exponential window on both signals, in 1/s; zero without one.
    pub exponential_rate: f64,
    /// Time after the first sample at which the exponential window is one, in seconds.
    pub exponential_origin_s: f64,
    /// Window of the force.
    pub force: Option<ForceWindow>,
    /// Window of the response.
    pub response: Option<ResponseWindow>,
}

/// The two signals of a hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Signal {
    Force,
    Response,
}

impl NoiseDensity {
    fn is_valid(&self) -> bool {
        let valid = |value: f64| value.is_finite() && value >= 0.0;
        [self.force, self.response, self.windows.exponential_rate].into_iter().all(valid)
    }

    fn density(&self, signal: Signal) -> f64 {
        match signal {
            Signal::Force => self.force,
            Signal::Response => self.response,
        }
    }
}

impl NoiseWindows {
    /// Value of the windows of a signal at a time after the first sample (seconds).
    fn weight(&self, signal: Signal, time_s: f64) -> f64 {
        let own = match signal {
            Signal::Force => self.force.map_or(1.0, |window| window.weight(time_s)),
            Signal::Response => self.response.map_or(1.0, |window| window.weight(time_s)),
        };
        if self.exponential_rate == 0.0 {
            return own;
        }
        own * (-self.exponential_rate * (time_s - self.exponential_origin_s)).exp()
    }
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
    /// The first order is valid up to about 0.3
    /// ([`PeakUncertainty::is_first_order`]). Above, the noise itself has
    /// maxima, the peak found may be one of them, and the deviations are meaningless. A
    /// record much longer than the decay is mostly noise: shorten or window it.
    pub roughness: f64,
}

/// Largest roughness for which the first order is valid.
const ROUGH: f64 = 0.3;

/// Roughness above which the width of a peak tells its curvature better than its top does.
const SMOOTH: f64 = 0.1;
/// Curvature over the curvature of the width, above which it belongs to a maximum of the noise.
const SHARP: f64 = 2.0;

impl PeakUncertainty {
    /// True if the first order is valid, with a roughness below 0.3; otherwise the peak itself may
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
/// var Re sum n_k g_k = (S rate / 2) sum w_k^2 (Re g_k)^2
/// ```
///
/// with the values `w_k` of the windows, and likewise for the force, over the samples from its
/// first to its last that is not zero. Over many cycles the mean of `(Re g_k)^2` is `|g_k|^2 / 2`.
/// Valid for stationary noise of the given density about the peak, small against `X` in height
/// and in curvature ([`PeakUncertainty::roughness`]). Where noise changes the curvature by more than a
/// tenth, or doubles it, that of one mode of the same half-power width `b` counts, `(ln |H|)'' = -4 / b^2`. Without noise the deviations are zero.
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
    if !noise.is_valid() {
        return None;
    }
    let frequency = peak.frequency_hz;
    // The curve varies over 1/T: a step of 2 % of that gives the curvature to 1e-3.
    let step = 0.02 / response.duration();
    let slope = |f: f64| 0.5 * response.power_and_slope(f).1;
    let mut curvature = (slope(frequency + step) - slope(frequency - step)) / (2.0 * step);
    let transforms = response.transforms_at(frequency);
    let mut sums = [0.0; 3];
    for (transform, signal) in
        [(transforms.response, Signal::Response), (transforms.force, Signal::Force)]
    {
        let sampling = (response.sample_rate_hz(), response.time_origin_s());
        let added = variances(&transform, signal, &noise, frequency, sampling);
        sums.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
    }
    let [relative, slope, roughness] = sums.map(f64::sqrt);
    if let Some(width) = half_power_crossings(response, peak) {
        let of_width = -4.0 / (width.upper_hz - width.lower_hz).powi(2);
        let is_noise = curvature.abs() > SHARP * of_width.abs();
        if is_noise || roughness > SMOOTH * curvature.abs() {
            curvature = of_width;
        }
    }
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

/// Cycles from which the mean over the phase holds.
const MANY_CYCLES: f64 = 50.0;

/// True for a sum over samples of so many cycles that the mean over the phase holds.
fn is_long(samples: usize, frequency_hz: f64, rate: f64) -> bool {
    samples as f64 * frequency_hz / rate > MANY_CYCLES
}

/// Variances of `ln |X|`, its slope and its curvature for white noise under windows.
fn variances(
    transform: &SignalTransform,
    signal: Signal,
    noise: &NoiseDensity,
    frequency_hz: f64,
    (rate, origin_s): (f64, f64),
) -> [f64; 3] {
    let density = noise.density(signal);
    if density == 0.0 {
        return [0.0; 3];
    }
    let dt = 1.0 / rate;
    // N/X, its slope and its curvature are sums over the noise with weights
    // dt (-i (a t + b))^n exp(-i w t) / X, n = 0, 1, 2 (but for the curvature of ln X).
    let b = transform.slope / transform.value * Complex64::new(0.0, -1.0);
    let is_long = is_long(transform.samples.len(), frequency_hz, rate);
    let unit = transform.value.conj() / transform.value.norm();
    let mut sums = [0.0; 3];
    for index in transform.samples.clone() {
        let time = index as f64 * dt;
        let weight = noise.windows.weight(signal, time).powi(2);
        let ramp = b + TAU * time;
        if is_long {
            let square = ramp.norm_sqr();
            sums[0] += 0.5 * weight;
            sums[1] += 0.5 * weight * square;
            sums[2] += 0.5 * weight * square * square;
        } else {
            let phasor = unit * Complex64::from_polar(1.0, -TAU * frequency_hz * (time - origin_s));
            let turned = phasor * ramp;
            sums[0] += weight * phasor.re * phasor.re;
            sums[1] += weight * turned.im * turned.im;
            sums[2] += weight * (turned * ramp).re.powi(2);
        }
    }
    let scale = 0.5 * density * rate * dt * dt / transform.value.norm_sqr();
    sums.map(|sum| scale * sum)
}
