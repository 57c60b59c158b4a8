//! The analytic signal: envelope and phase.

use super::band_pass::{BandPass, check_band};
use crate::error::{Result, check_rate, check_samples};
use crate::spectrum::fast_length;
use realfft::RealFftPlanner;
use realfft::num_complex::Complex64;
use std::cell::RefCell;

/// Padding lasts until the filter has fallen to this.
const WRAPPED: f64 = 1e-12;

thread_local! {
    static PLANNER: RefCell<RealFftPlanner<f64>> = RefCell::new(RealFftPlanner::new());
}

/// `x + i Hilbert(x)`, filtered by a band if one is given.
///
/// The transform of the result is twice that of `x` above zero frequency and
/// zero below; with a band it is twice the gain at every frequency, of either
/// sign, times that of `x`. Its magnitude is the envelope and its angle the phase of a
/// signal that oscillates about zero. The record is padded with zeros so that
/// its end does not wrap around to its beginning: by the band's settling time,
/// or to twice its length without one, where the Hilbert transform of the ends
/// falls only as one over time.
///
/// # Errors
/// [`SignalError::Empty`](crate::SignalError::Empty), [`SignalError::NotFinite`](crate::SignalError::NotFinite),
/// [`SignalError::SampleRate`](crate::SignalError::SampleRate), and
/// [`SignalError::Option`](crate::SignalError::Option) for a band beyond half the sample rate.
pub fn analytic_signal(
    samples: &[f64],
    sample_rate_hz: f64,
    band: Option<&BandPass>,
) -> Result<Vec<Complex64>> {
    check_samples("signal", samples)?;
    check_rate(sample_rate_hz)?;
    let mut padding = samples.len();
    if let Some(band) = band {
        check_band(band, sample_rate_hz)?;
        // At most once more: a filter that rings longer than the record is no use anyway.
        padding = padding.min((band.settling_s(WRAPPED) * sample_rate_hz) as usize);
    }
    let length = fast_length(samples.len() + padding);
    let (forward, inverse) = PLANNER.with_borrow_mut(|planner| {
        (planner.plan_fft_forward(length), planner.plan_fft_inverse(length))
    });
    let mut buffer = forward.make_input_vec();
    buffer[..samples.len()].copy_from_slice(samples);
    let mut spectrum = forward.make_output_vec();
    // Lengths fit, as the plans made the buffers; NaN would tell otherwise.
    if forward.process(&mut buffer, &mut spectrum).is_err() {
        spectrum.fill(Complex64::new(f64::NAN, f64::NAN));
    }
    let step = sample_rate_hz / length as f64;
    let scale = 1.0 / length as f64;
    // The band's gain is not cut at zero frequency, which would ring for ever: both
    // signs of frequency pass, the even part to the signal, the odd to its quadrature.
    let gains = |k: usize| {
        let frequency = k as f64 * step;
        let sides = |band: &BandPass| (band.gain(frequency), band.gain(-frequency));
        let (above, below) = band.map_or((1.0, 0.0), sides);
        ((above + below) * scale, (above - below) * scale)
    };
    let last = spectrum.len() - 1;
    // Beyond the filter's end there is nothing to weigh.
    let end = band.map_or(f64::INFINITY, BandPass::end_hz) / step;
    let kept = (end as usize).saturating_add(1).min(spectrum.len());
    spectrum[kept..].fill(Complex64::ZERO);
    let mut quadrature = vec![Complex64::ZERO; spectrum.len()];
    for (k, (value, turned)) in spectrum[..kept].iter_mut().zip(&mut quadrature).enumerate() {
        let (even, odd) = gains(k);
        // Real at both ends, where the quadrature has nothing.
        if k != 0 && k != last {
            *turned = Complex64::new(value.im, -value.re) * odd;
        }
        *value *= even;
    }
    let invert = |mut spectrum: Vec<Complex64>| {
        let mut output = inverse.make_output_vec();
        if let Some(first) = spectrum.first_mut() {
            first.im = 0.0;
        }
        if let Some(last) = spectrum.last_mut() {
            last.im = 0.0;
        }
        if inverse.process(&mut spectrum, &mut output).is_err() {
            output.fill(f64::NAN);
        }
        output.truncate(samples.len());
        output
    };
    let (real, imaginary) = (invert(spectrum), invert(quadrature));
    Ok(real.into_iter().zip(imaginary).map(|(re, im)| Complex64::new(re, im)).collect())
}
