//! The Fourier sum on the grid of an FFT.

use crate::error::{Result, SignalError, check_rate, check_samples};
use asperity_transform::{fast_length, forward};
use num_complex::Complex64;

/// Largest zero padding; use [`transform_at`](crate::transform_at) for denser grids.
pub(crate) const PADDING_LIMIT: usize = 1024;

/// One-sided Fourier transform of a real signal by the rectangle rule.
///
/// ```text
/// X(f_k) = dt * sum_n x_n exp(-i 2 pi f_k n dt),   f_k = k / (M dt),   0 <= k <= M/2
/// ```
///
/// Rectangular window and no detrending: the record is the whole
/// transient. Zero padding to `M` samples interpolates the transform and adds
/// no information. The values have the unit of the samples times seconds and
/// tend to the continuous transform as `dt` tends to zero.
///
/// ```
/// use asperity_signal::Spectrum;
///
/// let spectrum = Spectrum::new(&[1.0; 8], 8.0, 1)?;
/// assert_eq!(spectrum.frequency_step(), 1.0);
/// assert!((spectrum.values()[0].re - 1.0).abs() < 1e-15);
/// assert!(spectrum.values()[1].norm() < 1e-15);
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    values: Vec<Complex64>,
    frequency_step: f64,
}

impl Spectrum {
    /// Transforms `samples`, zero-padded to [`fast_length`]`(padding * samples.len())`.
    ///
    /// - `samples`: any unit, the first at time zero.
    /// - `sample_rate_hz`: positive, in hertz.
    /// - `padding`: 1 (none) to 1024.
    ///
    /// # Errors
    /// [`SignalError::Empty`], [`SignalError::NotFinite`], [`SignalError::SampleRate`], [`SignalError::Padding`].
    pub fn new(samples: &[f64], sample_rate_hz: f64, padding: usize) -> Result<Self> {
        check_samples("signal", samples)?;
        check_rate(sample_rate_hz)?;
        if !(1..=PADDING_LIMIT).contains(&padding) {
            return Err(SignalError::Padding { value: padding, limit: PADDING_LIMIT });
        }
        let length = fast_length(padding * samples.len());
        Ok(Self::padded_to(samples, sample_rate_hz, length))
    }

    /// The transform of checked samples, zero-padded to an even `length` they fit in.
    pub(crate) fn padded_to(samples: &[f64], sample_rate_hz: f64, length: usize) -> Self {
        let mut padded = vec![0.0; length];
        padded[..samples.len()].copy_from_slice(samples);
        Self::of(padded, sample_rate_hz)
    }

    /// The transform of an even number of checked samples.
    pub(crate) fn of(samples: Vec<f64>, sample_rate_hz: f64) -> Self {
        let frequency_step = sample_rate_hz / samples.len() as f64;
        let mut values = forward(samples);
        let time_step = 1.0 / sample_rate_hz;
        for value in &mut values {
            *value *= time_step;
        }
        Self { values, frequency_step }
    }

    /// Spacing of the bins `1 / (M dt)`, in hertz.
    pub fn frequency_step(&self) -> f64 {
        self.frequency_step
    }

    /// Frequency of bin `index`, in hertz.
    pub fn frequency(&self, index: usize) -> f64 {
        index as f64 * self.frequency_step
    }

    /// The transform from zero to half the sample rate, both included.
    pub fn values(&self) -> &[Complex64] {
        &self.values
    }

    /// The transform, by value.
    pub(crate) fn into_values(self) -> Vec<Complex64> {
        self.values
    }
}
