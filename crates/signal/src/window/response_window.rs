//! A window that ends a response where it is noise.

use num_complex::Complex64;
use std::f64::consts::PI;

use crate::ring_down::{BandPass, analytic_signal};
use crate::transform::transform_at;

/// A window that keeps a response until it has decayed into noise, and sets the rest to zero.
///
/// ```text
/// w = 1 until `end_s`, (1 + cos(pi (t - end_s) / taper_s)) / 2 over the taper, 0 after it
/// ```
///
/// A record much longer than the decay adds noise to every line of the transform and nothing to the
/// resonance; the largest value of `|H|` is then a maximum of the noise.
///
/// ```
/// use asperity_signal::ResponseWindow;
///
/// let window = ResponseWindow { end_s: 2e-3, taper_s: 2e-3 };
/// let mut response = [1.0, -1.0, 1.0, -1.0, 1.0];
/// window.apply(&mut response, 1e3);
/// assert_eq!(response[..3], [1.0, -1.0, 1.0]);
/// assert!((response[3] + 0.5).abs() < 1e-12 && response[4] == 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResponseWindow {
    /// Beginning of the taper, after the first sample, in seconds.
    pub end_s: f64,
    /// Length of the taper, in seconds.
    pub taper_s: f64,
}

/// Half width of the band of the decay, over its centre.
const BAND: f64 = 0.3;
/// Cycles over which the envelope is averaged.
const CYCLES: f64 = 4.0;
/// Mean square envelope at the end of the decay, over the mean square envelope of the noise.
const ABOVE_NOISE: f64 = 4.0;
/// Part of a resonance beyond the window, over the standard deviation of its noise.
const CUT: f64 = 0.3;
/// Length of the taper, over the length of the decay.
const TAPER: f64 = 0.3;

/// Envelope of the band about a resonance.
pub(crate) struct DecayEnvelope {
    sample_rate_hz: f64,
    frequency_hz: f64,
    band: BandPass,
    /// Samples of an interval.
    width: usize,
    /// Mean square envelope of each interval.
    powers: Vec<f64>,
}

impl DecayEnvelope {
    pub(crate) fn of(response: &[f64], sample_rate_hz: f64, frequency_hz: f64) -> Option<Self> {
        let band = BandPass::around(frequency_hz, BAND).ok()?;
        let signal = analytic_signal(response, sample_rate_hz, Some(&band)).ok()?;
        let width = (CYCLES * sample_rate_hz / frequency_hz).ceil() as usize;
        let power = |part: &[Complex64]| {
            part.iter().map(Complex64::norm_sqr).sum::<f64>() / part.len() as f64
        };
        let powers = signal.chunks(width).map(power).collect();
        Some(Self { sample_rate_hz, frequency_hz, band, width, powers })
    }

    /// [`ResponseWindow::until_noise`] of the samples of the envelope.
    pub(crate) fn until_noise(
        &self,
        response: &[f64],
        noise_density: f64,
    ) -> Option<ResponseWindow> {
        let (powers, rate) = (&self.powers, self.sample_rate_hz);
        let noise = 2.0 * noise_density * self.band.noise_width_hz();
        let largest = (0..powers.len()).max_by(|&a, &b| powers[a].total_cmp(&powers[b]))?;
        let is_noise = |power: &f64| *power <= ABOVE_NOISE * noise;
        let last = largest + powers[largest..].iter().position(is_noise)?.checked_sub(1)?;
        if last == largest || last + 1 >= powers.len() {
            return None;
        }
        let time = |part: usize| (part as f64 + 0.5) * self.width as f64 / rate;
        let (begin, faded) = (time(largest), time(last));
        let decay_rate = 0.5 * (powers[largest] / powers[last]).ln() / (faded - begin);
        let value = transform_at(&response[..(last + 1) * self.width], rate, self.frequency_hz);
        let deviation = 0.5 * (noise_density * faded).sqrt() / value.norm();
        let end_s = (begin - (CUT * deviation).ln() / decay_rate).max(faded);
        let taper_s = TAPER * (end_s - begin);
        let duration = response.len() as f64 / rate;
        (end_s + taper_s < duration).then_some(ResponseWindow { end_s, taper_s })
    }
}

impl ResponseWindow {
    /// The window of a resonance; `None` if the record ends before it has decayed into noise.
    ///
    /// The envelope of the band about the resonance, averaged over four cycles, falls from its
    /// largest value at `t0` with a mean decay rate `r` to twice the noise. The part of the
    /// transform that a window cuts at `t` is `exp(-r (t - t0))`, and the noise in it has a
    /// relative standard deviation `s(t) = sqrt(S t) / (2 |X|)`; the window ends where the first is
    /// 0.3 of the second, which leaves the frequency and the height unchanged within the noise.
    ///
    /// - `response`: any unit, without offset.
    /// - `sample_rate_hz`, `frequency_hz`: of the samples and the resonance, in hertz.
    /// - `noise_density`: one-sided density of the noise in the band, in the samples' unit squared
    ///   per hertz.
    pub fn until_noise(
        response: &[f64],
        sample_rate_hz: f64,
        frequency_hz: f64,
        noise_density: f64,
    ) -> Option<Self> {
        DecayEnvelope::of(response, sample_rate_hz, frequency_hz)?
            .until_noise(response, noise_density)
    }

    /// Value of the window at a time after the first sample (seconds), 0 to 1.
    pub fn weight(&self, time_s: f64) -> f64 {
        let beyond = time_s - self.end_s;
        if beyond <= 0.0 {
            1.0
        } else if beyond >= self.taper_s {
            0.0
        } else {
            0.5 + 0.5 * (PI * beyond / self.taper_s).cos()
        }
    }

    /// Applies the window to samples.
    pub fn apply(&self, samples: &mut [f64], sample_rate_hz: f64) {
        for (index, x) in samples.iter_mut().enumerate() {
            let weight = self.weight(index as f64 / sample_rate_hz);
            *x = if weight == 0.0 { 0.0 } else { *x * weight };
        }
    }
}
