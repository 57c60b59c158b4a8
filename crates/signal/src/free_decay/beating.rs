//! Beating of a second mode in the band of a decay.

use crate::fit::orthogonal;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Degree of the polynomials in time of one mode's phase and logarithm of its amplitude.
const DEGREE: i32 = 4;
/// Fewest samples.
const FEWEST: usize = 16;
/// Samples over the width of the band.
const PER_WIDTH: f64 = 4.0;
/// Fewest beats in the decay.
pub(super) const FEWEST_BEATS: f64 = 3.0;
/// Least height of the beat above its noise, in standard deviations.
const ABOVE_NOISE: f64 = 5.0;

/// Largest error of the local decay rates, over their mean.
pub(super) const LARGEST_ERROR: f64 = 0.25;

/// Modulation of a decay by a second mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beating {
    /// Amplitude of the second mode over the amplitude of the first.
    pub ratio: f64,
    /// Frequency of the second mode less the frequency of the first, in hertz.
    pub offset_hz: f64,
    /// Error of the local decay rate due to the beat, over the mean decay rate.
    pub decay_rate_error: f64,
}

impl Beating {
    /// True if the beat changes the local decay rates by less than a quarter of their mean.
    pub fn is_small(&self) -> bool {
        self.decay_rate_error < LARGEST_ERROR
    }
}

/// Conditions of a search for a beat.
pub(super) struct BeatSearch {
    pub(super) sample_rate_hz: f64,
    /// Frequency about which the phase is slow, in hertz.
    pub(super) carrier_hz: f64,
    /// Width of the band, in hertz.
    pub(super) width_hz: f64,
    /// Length of a line of the backbone, in seconds.
    pub(super) line_s: f64,
    pub(super) noise_density: f64,
}

impl BeatSearch {
    /// The strongest beat of an analytic signal that is above the noise; `None` for a decay of fewer
    /// than three beats.
    ///
    /// The signal over a smooth one, with polynomials of the fourth degree in time for its phase and
    /// the logarithm of its amplitude, is `1 + r exp(i 2 pi v t)` for a second mode of the amplitude
    /// ratio `r` at the offset `v`. A line of the length `T` reduces the error `2 pi v r` of the decay
    /// rate by `3 (sin x - x cos x) / x^3`, `x = pi v T`.
    pub(super) fn strongest(&self, signal: &[Complex64], decay_rate: f64) -> Option<Beating> {
        let stride = (self.sample_rate_hz / (PER_WIDTH * self.width_hz)).floor().max(1.0) as usize;
        let step = stride as f64 / self.sample_rate_hz;
        let kept: Vec<Complex64> = signal.iter().step_by(stride).copied().collect();
        let count = kept.len();
        if count < FEWEST || kept.iter().any(|value| value.norm() == 0.0) {
            return None;
        }
        let heights: Vec<f64> = kept.iter().map(|value| value.norm().ln()).collect();
        let mut phases = Vec::with_capacity(count);
        let mut turned = 0.0;
        for (n, value) in kept.iter().enumerate() {
            let phase = value.arg() - TAU * self.carrier_hz * step * n as f64;
            if let Some(before) = phases.last() {
                let change: f64 = phase + turned - before;
                turned -= TAU * (change / TAU).round();
            }
            phases.push(phase + turned);
        }
        let (heights, phases) = (residual(&heights), residual(&phases));
        let hann = |n: usize| 1.0 - (TAU * (n as f64 + 0.5) / count as f64).cos();
        let rest: Vec<Complex64> = heights
            .iter()
            .zip(&phases)
            .enumerate()
            .map(|(n, (height, phase))| {
                (Complex64::from_polar(height.exp(), *phase) - 1.0) * hann(n) / count as f64
            })
            .collect();
        let span = step * count as f64;
        let highest = 0.5 * self.width_hz;
        let lines = (2.0 * highest * span) as i64;
        let strongest = (-lines..=lines)
            .map(|line| line as f64 * 0.5 / span)
            .filter(|offset| offset.abs() * span >= FEWEST_BEATS)
            .map(|offset| {
                let turn = Complex64::from_polar(1.0, -TAU * offset * step);
                let (mut phasor, mut sum) = (Complex64::ONE, Complex64::ZERO);
                for value in &rest {
                    sum += value * phasor;
                    phasor *= turn;
                }
                (offset, sum.norm())
            })
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let (offset_hz, ratio) = strongest?;
        // Mean of the noise over the amplitude; 1.5 for the window.
        let inverse = kept.iter().map(|value| value.norm_sqr().recip()).sum::<f64>() / count as f64;
        let noise = (1.5 * 2.0 * self.noise_density * inverse / span).sqrt();
        if ratio < ABOVE_NOISE * noise {
            return None;
        }
        let x = 0.5 * TAU * offset_hz.abs() * self.line_s;
        let passed = 3.0 * (x.sin() - x * x.cos()).abs() / x.powi(3);
        let error = TAU * offset_hz.abs() * ratio * passed;
        Some(Beating { ratio, offset_hz, decay_rate_error: error / decay_rate.abs() })
    }
}

/// Values at equal distances less their least-squares polynomial.
fn residual(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let x = |n: usize| 2.0 * (n as f64 + 0.5) / count as f64 - 1.0;
    let column = |degree: i32| (0..count).map(|n| x(n).powi(degree)).collect();
    let mut rest = values.to_vec();
    for (own, square) in orthogonal((0..=DEGREE).map(column), &vec![1.0; count]) {
        let share = rest.iter().zip(&own).map(|(a, b)| a * b).sum::<f64>() / square;
        rest.iter_mut().zip(&own).for_each(|(a, b)| *a -= share * b);
    }
    rest
}
