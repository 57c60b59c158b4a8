//! High-pass filter of a sampled signal.

use std::f64::consts::{PI, SQRT_2};

use crate::error::{Result, check_positive};

/// Butterworth high-pass of second order, for a signal in blocks.
///
/// ```text
/// G(s) = s^2 / (s^2 + sqrt(2) w s + w^2),   w = 2 pi f,   by the bilinear transform
/// ```
///
/// It takes constants and slow drifts out of a record. Far above the corner `f_c` the gain is
/// `1 - (f_c/f)^4 / 2`, and the phase `sqrt(2) f_c/f` rad. The filter starts at rest about the first
/// sample; samples that are not finite are passed on and do not enter the state.
///
/// ```
/// use asperity_signal::HighPass;
/// let mut drift: Vec<f64> = (0..20_000).map(|n| 3.0 + 1e-5 * f64::from(n)).collect();
/// HighPass::new(5.0, 1000.0)?.filter(&mut drift);
/// assert_eq!(drift[0], 0.0);
/// assert!(drift.iter().all(|x| x.abs() < 1e-3));
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HighPass {
    /// Factor of the second difference of the input.
    gain: f64,
    feedback: [f64; 2],
    /// None before the first finite sample.
    state: Option<[f64; 2]>,
}

impl HighPass {
    /// A filter with its corner at `corner_hz`, where its gain is 1/sqrt(2).
    ///
    /// # Errors
    /// [`SignalError::Option`](crate::SignalError::Option) for a corner that is not positive or not below
    /// half the sample rate.
    pub fn new(corner_hz: f64, sample_rate_hz: f64) -> Result<Self> {
        check_positive("the corner of the high-pass", corner_hz)?;
        check_positive("half the sample rate above the corner", 0.5 * sample_rate_hz - corner_hz)?;
        let tangent = (PI * corner_hz / sample_rate_hz).tan();
        let square = tangent * tangent;
        let gain = 1.0 / (1.0 + SQRT_2 * tangent + square);
        let feedback = [2.0 * (square - 1.0) * gain, (1.0 - SQRT_2 * tangent + square) * gain];
        Ok(Self { gain, feedback, state: None })
    }

    /// Filters the next block of the signal.
    pub fn filter(&mut self, samples: &mut [f64]) {
        let (gain, [first, second]) = (self.gain, self.feedback);
        for sample in samples.iter_mut().filter(|sample| sample.is_finite()) {
            let x = *sample;
            // The state in which a constant input gives zero.
            let state = self.state.get_or_insert([-gain * x, gain * x]);
            let y = gain * x + state[0];
            *state = [-2.0 * gain * x - first * y + state[1], gain * x - second * y];
            *sample = y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gain at a frequency far above, at and far below the corner; blocks do not matter.
    #[test]
    fn the_gain_is_that_of_the_equation() {
        let rate = 1e4;
        for frequency in [1.0, 20.0, 500.0] {
            let wave = |n: usize| (2.0 * PI * frequency * n as f64 / rate).sin();
            let mut samples: Vec<f64> = (0..60_000).map(wave).collect();
            let mut filter = HighPass::new(20.0, rate).unwrap();
            samples.chunks_mut(777).for_each(|block| filter.filter(block));
            let last = &samples[40_000..];
            let square: f64 = last.iter().map(|x| x * x).sum::<f64>() / last.len() as f64;
            let ratio = (frequency / 20.0_f64).powi(2);
            let expected = ratio / (1.0 + ratio * ratio).sqrt();
            assert!(((2.0 * square).sqrt() / expected - 1.0).abs() < 2e-3, "{frequency}");
        }
        assert!(HighPass::new(0.0, 100.0).is_err() && HighPass::new(50.0, 100.0).is_err());
    }
}
