//! Noise of the local lines of a backbone.

use super::{BackboneOptions, BackbonePoint};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Instants of a line, and frequencies of the noise on either side.
const INSTANTS: usize = 33;
const FREQUENCIES: usize = 48;
/// Highest frequency of the noise that a line follows, in reciprocals of its length.
const HIGHEST: f64 = 6.0;

/// Standard deviations of one point of a backbone due to noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackboneUncertainty {
    /// Of the frequency, in hertz.
    pub frequency_hz: f64,
    /// Of the decay rate, in 1/s.
    pub decay_rate: f64,
    /// Of the damping ratio.
    pub damping_ratio: f64,
    /// Of the amplitude, over the amplitude.
    pub relative_amplitude: f64,
}

impl BackbonePoint {
    /// Standard deviations due to the noise of the options, to first order in noise over amplitude.
    ///
    /// ```text
    /// var f = S integral (G(f + v) / G(f))^2 |W(v)|^2 dv,
    /// w(t) = 12 t exp(sigma t) / (2 pi A T^3),   |t| <= T / 2,   W its transform
    /// ```
    ///
    /// for a line of the length `T`, with the gain `G` of the band and of an integration to a
    /// displacement, and the noise density `S`; the
    /// decay rate has `2 pi` times this deviation, the amplitude that of `w = exp(sigma t) / (A T)`.
    /// Points closer than `T` share noise. Limiting case: a wide band and no damping give
    /// `sqrt(12 S / (A^2 T^3)) / 2 pi`.
    pub fn uncertainty(&self, options: &BackboneOptions) -> BackboneUncertainty {
        let length = options.cycles / options.band.centre_hz();
        self.uncertainty_over(length, options)
    }

    /// The same of a line of `length` seconds.
    pub(crate) fn uncertainty_over(
        &self,
        length: f64,
        options: &BackboneOptions,
    ) -> BackboneUncertainty {
        let (band, filter) = (&options.band, options.filter());
        let gain = filter.gain(self.frequency_hz);
        let step = length / INSTANTS as f64;
        let instants: Vec<(f64, f64)> = (0..INSTANTS)
            .map(|k| (k as f64 + 0.5) * step - 0.5 * length)
            .map(|t| (t, (self.decay_rate * t).exp() / self.amplitude))
            .collect();
        let highest = band.width_hz().min(HIGHEST / length);
        let spacing = 2.0 * highest / FREQUENCIES as f64;
        let (mut slope, mut mean) = (0.0, 0.0);
        for k in 0..FREQUENCIES {
            let offset = (k as f64 + 0.5) * spacing - highest;
            let (mut first, mut zeroth) = (Complex64::ZERO, Complex64::ZERO);
            let turn = |t: f64| Complex64::from_polar(1.0, -TAU * offset * t);
            let (mut phasor, next) = (turn(instants[0].0), turn(step));
            for (t, relative) in &instants {
                let turned = phasor * (relative * step);
                phasor *= next;
                zeroth += turned / length;
                first += turned * (12.0 * t / length.powi(3));
            }
            let passed = (filter.gain(self.frequency_hz + offset) / gain).powi(2) * spacing;
            slope += passed * first.norm_sqr();
            mean += passed * zeroth.norm_sqr();
        }
        let decay_rate = (options.noise_density * slope).sqrt();
        BackboneUncertainty {
            frequency_hz: decay_rate / TAU,
            decay_rate,
            damping_ratio: decay_rate / self.decay_rate.hypot(TAU * self.frequency_hz),
            relative_amplitude: (options.noise_density * mean).sqrt(),
        }
    }
}
