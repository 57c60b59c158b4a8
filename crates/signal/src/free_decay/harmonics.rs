//! Harmonics of a mode along its free decay.

use crate::error::Result;
use crate::noise::quiet_density;
use crate::ring_down::{BandPass, analytic_signal};
use crate::sums::largest_magnitude;
use num_complex::Complex64;

/// Half width of the band of a harmonic and its edges, over the fundamental.
const HALF_WIDTH: f64 = 0.3;
const EDGE: f64 = 0.05;
/// Largest part of a harmonic that the beginning of the decay may contribute.
const EDGE_LEVEL: f64 = 0.1;
/// Least amplitude of a harmonic, in standard deviations of its noise.
const ABOVE_NOISE: f64 = 4.0;

/// Amplitude of a harmonic over the amplitude of the fundamental.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecayHarmonic {
    /// Ratio of the amplitudes as displacements.
    pub ratio: f64,
    /// Its standard deviation due to noise.
    pub uncertainty: f64,
}

/// A harmonic of a decay, demodulated by the phase of its fundamental.
pub(super) struct HarmonicBand {
    order: i32,
    /// Amplitude as displacement over that as measured.
    scale: f64,
    signal: Vec<Complex64>,
    band: BandPass,
    /// Largest sample at the beginning.
    head: f64,
    pub(super) noise_density: f64,
    rate: f64,
}

impl HarmonicBand {
    /// The band of the harmonic of an `order`; `None` beyond half the sample rate.
    pub(super) fn of(
        samples: &[f64],
        quiet: &[f64],
        rate: f64,
        fundamental_hz: f64,
        (order, derivatives): (i32, i32),
    ) -> Result<Option<Self>> {
        let centre = f64::from(order) * fundamental_hz;
        let half = HALF_WIDTH * fundamental_hz;
        if centre + half > 0.5 * rate {
            return Ok(None);
        }
        let band = BandPass::new(centre - half, centre + half, EDGE * fundamental_hz)?;
        let signal = analytic_signal(samples, rate, Some(&band))?;
        let within = (centre - 0.5 * fundamental_hz, centre + 0.5 * fundamental_hz);
        let cycle = ((rate / fundamental_hz) as usize).clamp(1, samples.len());
        Ok(Some(Self {
            order,
            scale: f64::from(order).powi(-derivatives),
            signal,
            band,
            head: largest_magnitude(&samples[..cycle]),
            noise_density: quiet_density(quiet, rate, within).unwrap_or(0.0),
            rate,
        }))
    }

    /// The ratio over the samples `middle -+ half`, by the mean of `z_k exp(-i k p_1)`, which keeps
    /// what follows the phase `p_1` of the fundamental; `None` below four standard deviations of the
    /// noise.
    pub(super) fn ratio(
        &self,
        fundamental: &[Complex64],
        middle: usize,
        half: usize,
    ) -> Option<DecayHarmonic> {
        let window = middle - half..=middle + half;
        let (mut sum, mut first) = (Complex64::ZERO, 0.0);
        for (one, own) in fundamental.get(window.clone())?.iter().zip(self.signal.get(window)?) {
            let amplitude = one.norm();
            sum += own * (one.conj() / amplitude).powi(self.order);
            first += amplitude;
        }
        let count = (2 * half + 1) as f64;
        let noise = (self.noise_density * self.rate / count).sqrt();
        let amplitude = sum.norm() / count;
        let from_edge = self.head * self.band.ringing((middle - half) as f64 / self.rate);
        let is_clear = amplitude > ABOVE_NOISE * noise && from_edge < EDGE_LEVEL * amplitude;
        // Rounding of the transforms.
        let least = 1e-11 * self.head;
        let scale = self.scale * count / first;
        (is_clear && amplitude > least)
            .then_some(DecayHarmonic { ratio: amplitude * scale, uncertainty: noise * scale })
    }
}
