//! Local lines of phase and logarithm of the envelope.

use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;

/// Logarithm of the envelope and phase of an analytic signal, computed once for overlapping windows.
pub(crate) struct Polar {
    /// Logarithm of the magnitude, and angle.
    values: Vec<(f64, f64)>,
}

/// Amplitude, frequency and decay rate at the middle of a window.
pub(crate) struct LocalFit {
    pub(crate) amplitude: f64,
    pub(crate) frequency_hz: f64,
    pub(crate) decay_rate: f64,
}

impl Polar {
    pub(crate) fn of(signal: &[Complex64]) -> Self {
        Self { values: signal.iter().map(|value| (value.norm().ln(), value.arg())).collect() }
    }

    /// Least-squares lines over a window; `None` if the signal is zero.
    ///
    /// The phase is taken relative to a carrier, which makes it slow and easy to unwrap; the slopes
    /// over a symmetric window do not depend on curvature.
    pub(crate) fn line(
        &self,
        window: RangeInclusive<usize>,
        rate: f64,
        carrier_hz: f64,
    ) -> Option<LocalFit> {
        let values = self.values.get(window)?;
        let count = values.len() as f64;
        let centre = 0.5 * (count - 1.0);
        let step = TAU * carrier_hz / rate;
        let (mut heights, mut phases) = ((0.0, 0.0), 0.0);
        let mut unwrapped = 0.0;
        let mut before = f64::NAN;
        for (n, &(height, angle)) in values.iter().enumerate() {
            let x = n as f64 - centre;
            let phase = angle - step * x;
            let change = phase - before;
            if change.abs() >= PI {
                unwrapped -= TAU * (change / TAU).round();
            }
            before = phase;
            heights.0 += height;
            heights.1 += x * height;
            phases += x * (phase + unwrapped);
        }
        // sum x^2 of equally spaced points about their middle.
        let square = count * (count * count - 1.0) / 12.0;
        let line = LocalFit {
            amplitude: (heights.0 / count).exp(),
            frequency_hz: carrier_hz + phases / square * rate / TAU,
            decay_rate: -heights.1 / square * rate,
        };
        let finite = line.amplitude > 0.0
            && [line.amplitude, line.frequency_hz, line.decay_rate].iter().all(|x| x.is_finite());
        finite.then_some(line)
    }
}
