//! The analytic signal.

use super::band_pass::{BandPass, check_band};
use crate::error::{Result, check_rate, check_samples};
use asperity_transform::{fast_length, forward, inverse};
use num_complex::Complex64;

/// Impulse response of the filter at which the zero padding ends.
const WRAPPED: f64 = 1e-12;

/// The analytic signal `x + i Hilbert(x)`, filtered by a band if one is given.
///
/// The transform of the result is twice the transform of `x` above zero frequency and
/// zero below; with a band it is twice the gain at every frequency, of either
/// sign, times that of `x`. Its magnitude is the envelope and its angle the phase of a
/// signal that oscillates about zero. Against circular convolution the record is padded with zeros
/// for the settling time of the band, or to twice its length without a band.
///
/// # Errors
/// [`SignalError::Empty`](crate::SignalError::Empty), [`SignalError::NotFinite`](crate::SignalError::NotFinite),
/// [`SignalError::SampleRate`](crate::SignalError::SampleRate), and
/// [`SignalError::Option`](crate::SignalError::Option) for a band beyond half the sample rate.
///
/// ```
/// let cosine: Vec<f64> =
///     (0..1000).map(|n| (std::f64::consts::TAU * 50.0 * f64::from(n) / 1000.0).cos()).collect();
/// let analytic = asperity_signal::analytic_signal(&cosine, 1000.0, None)?;
/// assert!((analytic[500].norm() - 1.0).abs() < 1e-2);
/// # Ok::<(), asperity_signal::SignalError>(())
/// ```
pub fn analytic_signal(
    samples: &[f64],
    sample_rate_hz: f64,
    band: Option<&BandPass>,
) -> Result<Vec<Complex64>> {
    // A gain cut at zero frequency would have a slowly decaying impulse response. Both signs of
    // frequency pass, the even part of the gain to the signal, the odd part to its quadrature.
    let above = |frequency: f64| if frequency.is_sign_positive() { 1.0 } else { 0.0 };
    let gain = |frequency: f64| band.map_or(above(frequency), |band| band.gain(frequency));
    filtered(samples, sample_rate_hz, band, gain)
}

/// The analytic signal whose transform is twice a `gain` times the transform of the samples, at
/// frequencies of either sign; the gain is zero above the end of the `band`, and settles with it.
pub(super) fn filtered(
    samples: &[f64],
    sample_rate_hz: f64,
    band: Option<&BandPass>,
    gain: impl Fn(f64) -> f64,
) -> Result<Vec<Complex64>> {
    check_samples("signal", samples)?;
    check_rate(sample_rate_hz)?;
    let mut padding = samples.len();
    if let Some(band) = band {
        check_band(band, sample_rate_hz)?;
        padding = padding.min((band.settling_s(WRAPPED) * sample_rate_hz) as usize);
    }
    let length = fast_length(samples.len() + padding);
    let mut padded = vec![0.0; length];
    padded[..samples.len()].copy_from_slice(samples);
    let mut spectrum = forward(padded);
    let step = sample_rate_hz / length as f64;
    let scale = 1.0 / length as f64;
    let gains = |k: usize| {
        let frequency = k as f64 * step;
        let (above, below) = (gain(frequency), gain(-frequency));
        ((above + below) * scale, (above - below) * scale)
    };
    let last = spectrum.len() - 1;
    // The gain is zero above the end of the filter.
    let end = band.map_or(f64::INFINITY, BandPass::end_hz) / step;
    let kept = (end as usize).saturating_add(1).min(spectrum.len());
    spectrum[kept..].fill(Complex64::ZERO);
    let mut quadrature = vec![Complex64::ZERO; spectrum.len()];
    for (k, (value, shifted)) in spectrum[..kept].iter_mut().zip(&mut quadrature).enumerate() {
        let (even, odd) = gains(k);
        // The spectrum is real at both ends, where the quadrature is zero.
        if k != 0 && k != last {
            *shifted = Complex64::new(value.im, -value.re) * odd;
        }
        *value *= even;
    }
    let invert = |spectrum| {
        let mut output = inverse(spectrum, length);
        output.truncate(samples.len());
        output
    };
    let (real, imaginary) = (invert(spectrum), invert(quadrature));
    Ok(real.into_iter().zip(imaginary).map(|(re, im)| Complex64::new(re, im)).collect())
}

impl BandPass {
    /// The filtered samples, as many as were given, at the same times.
    ///
    /// # Errors
    /// Those of [`analytic_signal`].
    pub fn apply(&self, samples: &[f64], sample_rate_hz: f64) -> Result<Vec<f64>> {
        let analytic = analytic_signal(samples, sample_rate_hz, Some(self))?;
        Ok(analytic.into_iter().map(|value| value.re).collect())
    }
}
