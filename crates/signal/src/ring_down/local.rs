//! Lines through the phase and the logarithm of the envelope over some cycles.

use realfft::num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;

/// Envelope and phase of an analytic signal; windows overlap, so each sample is turned once.
pub(super) struct Polar {
    /// Logarithm of the magnitude, and angle.
    values: Vec<(f64, f64)>,
}

/// What the lines say at the middle of the window.
pub(super) struct Line {
    pub(super) amplitude: f64,
    pub(super) frequency_hz: f64,
    pub(super) decay_rate: f64,
}

impl Polar {
    pub(super) fn of(signal: &[Complex64]) -> Self {
        Self { values: signal.iter().map(|value| (value.norm().ln(), value.arg())).collect() }
    }

    /// Least-squares lines over a window; `None` where the signal vanishes.
    ///
    /// The phase is taken against a carrier, so that it turns slowly and no
    /// turn is lost; slopes of a symmetric window are free of any curvature.
    pub(super) fn line(
        &self,
        window: RangeInclusive<usize>,
        rate: f64,
        carrier_hz: f64,
    ) -> Option<Line> {
        let values = self.values.get(window)?;
        let count = values.len() as f64;
        let centre = 0.5 * (count - 1.0);
        let step = TAU * carrier_hz / rate;
        let (mut heights, mut phases) = ((0.0, 0.0), 0.0);
        let mut turned = 0.0;
        let mut before = f64::NAN;
        for (n, &(height, angle)) in values.iter().enumerate() {
            let x = n as f64 - centre;
            let phase = angle - step * x;
            let change = phase - before;
            if change.abs() >= PI {
                turned -= TAU * (change / TAU).round();
            }
            before = phase;
            heights.0 += height;
            heights.1 += x * height;
            phases += x * (phase + turned);
        }
        // sum x^2 of equally spaced points about their middle.
        let square = count * (count * count - 1.0) / 12.0;
        let line = Line {
            amplitude: (heights.0 / count).exp(),
            frequency_hz: carrier_hz + phases / square * rate / TAU,
            decay_rate: -heights.1 / square * rate,
        };
        let finite = line.amplitude > 0.0
            && [line.amplitude, line.frequency_hz, line.decay_rate].iter().all(|x| x.is_finite());
        finite.then_some(line)
    }
}
