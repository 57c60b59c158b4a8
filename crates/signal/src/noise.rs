//! Level and spectral density of noise.

use crate::error::Result;
use crate::spectrum::Spectrum;

/// Standard deviation of a normal distribution, over its median absolute deviation.
const NORMAL: f64 = 1.482_602_218_505_602;

/// Median and robust deviation of a signal that is at rest most of the time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobustLevel {
    /// Median, in the unit of the samples.
    pub median: f64,
    /// Standard deviation of normal noise with the same median absolute
    /// deviation, `1.4826 median |x - median|`, in the unit of the samples.
    pub deviation: f64,
}

/// Median and robust deviation of the finite samples.
///
/// Insensitive to pulses and ringing in up to half of the samples. `None` without a finite sample.
/// Linear in the number of samples.
///
/// Source: F. R. Hampel, "The influence curve and its role in robust
/// estimation", J. Am. Stat. Assoc. 69 (1974), 383-393, doi 10.1080/01621459.1974.10482962.
///
/// ```
/// let level = asperity_signal::robust_level(&[1.0, -1.0, 0.0, 1e6, 0.5]).ok_or("no samples")?;
/// assert_eq!(level.median, 0.5);
/// # Ok::<(), &str>(())
/// ```
pub fn robust_level(samples: &[f64]) -> Option<RobustLevel> {
    let mut values: Vec<f64> = samples.iter().copied().filter(|x| x.is_finite()).collect();
    let median = median_of(&mut values)?;
    for value in &mut values {
        *value = (*value - median).abs();
    }
    Some(RobustLevel { median, deviation: NORMAL * median_of(&mut values)? })
}

/// The upper median; the values are reordered.
pub(crate) fn median_of(values: &mut [f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// One-sided spectral density of white noise from quiet samples.
///
/// ```text
/// S = 2 s^2 / rate
/// ```
///
/// with `s^2` the variance about the mean, in the unit of the samples squared per hertz. `None` for
/// fewer than 4 samples, and for samples or a rate that are not finite.
pub fn white_density(quiet: &[f64], sample_rate_hz: f64) -> Option<f64> {
    if quiet.len() < 4 {
        return None;
    }
    let count = quiet.len() as f64;
    let mean = quiet.iter().sum::<f64>() / count;
    let variance = quiet.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let density = 2.0 * variance / sample_rate_hz;
    (density.is_finite() && density >= 0.0).then_some(density)
}

/// One-sided spectral density of the noise in a band, from the whole record.
///
/// ```text
/// S = 2 median |X(f)|^2 / (T ln 2),    low <= f <= high
/// ```
///
/// The median is over the bins of an unpadded transform and insensitive to a few peaks in
/// the band; `ln 2` is the median of `|X|^2` over its mean for
/// normal noise. Vibration of the structure in the band counts as noise. `None` for fewer than 16
/// bins.
///
/// # Errors
/// Those of [`Spectrum::new`].
pub fn band_density(
    samples: &[f64],
    sample_rate_hz: f64,
    (low_hz, high_hz): (f64, f64),
) -> Result<Option<f64>> {
    let spectrum = Spectrum::new(samples, sample_rate_hz, 1)?;
    let inside = |index: &usize| (low_hz..=high_hz).contains(&spectrum.frequency(*index));
    let mut power: Vec<f64> = (0..spectrum.values().len())
        .filter(inside)
        .map(|index| spectrum.values()[index].norm_sqr())
        .collect();
    if power.len() < 16 {
        return Ok(None);
    }
    let duration = samples.len() as f64 / sample_rate_hz;
    let scale = 2.0 / (duration * std::f64::consts::LN_2);
    Ok(median_of(&mut power).map(|median| median * scale))
}

/// Lines beyond this multiple of the median are left out of the mean.
const OUTLYING: f64 = 3.0;
/// Fewest lines of a density in a band.
const FEWEST_LINES: usize = 16;

/// One-sided spectral density of the noise in a band, from samples that are quiet but for a few
/// resonances.
///
/// ```text
/// S = 16 mean |Y(f)|^2 / (3 T c),    low <= f <= high
/// ```
///
/// with `Y` the transform of the samples, of duration `T`, under a Hann window. Lines above three
/// times the median are left out: a resonance that has not decayed is a few lines. For normal
/// noise the mean of the others is `c = 0.703` of that of all. With fewer
/// than 16 lines in the band the variance counts ([`white_density`]). `None` for samples that are not
/// finite, and fewer than 4.
///
/// ```
/// use asperity_signal::quiet_density;
///
/// // Too few lines in the band for a mean.
/// let alternating: Vec<f64> = (0..16).map(|n| f64::from(n % 2)).collect();
/// let density = quiet_density(&alternating, 100.0, (10.0, 20.0)).ok_or("sixteen samples")?;
/// assert!((density - 2.0 * 16.0 / 15.0 * 0.25 / 100.0).abs() < 1e-15);
/// # Ok::<(), &str>(())
/// ```
pub fn quiet_density(
    quiet: &[f64],
    sample_rate_hz: f64,
    (low_hz, high_hz): (f64, f64),
) -> Option<f64> {
    let white = white_density(quiet, sample_rate_hz)?;
    let count = quiet.len() as f64;
    let mean = quiet.iter().sum::<f64>() / count;
    let hann = |n: usize| 0.5 - 0.5 * (std::f64::consts::TAU * n as f64 / count).cos();
    let windowed: Vec<f64> = quiet.iter().enumerate().map(|(n, x)| hann(n) * (x - mean)).collect();
    let spectrum = Spectrum::new(&windowed, sample_rate_hz, 1).ok()?;
    let inside = |index: &usize| (low_hz..=high_hz).contains(&spectrum.frequency(*index));
    let mut power: Vec<f64> = (0..spectrum.values().len())
        .filter(inside)
        .map(|index| spectrum.values()[index].norm_sqr())
        .collect();
    if power.len() < FEWEST_LINES {
        return Some(white);
    }
    // The transform is padded, its lines closer than 1 / T; the mean is the same.
    let limit = OUTLYING * median_of(&mut power)?;
    let kept = power.iter().filter(|power| **power <= limit);
    let mean = kept.clone().sum::<f64>() / kept.count() as f64;
    // Mean of exponentially distributed values below `limit`, over that of all.
    let end = OUTLYING * std::f64::consts::LN_2;
    let part = 1.0 - end * (-end).exp() / (1.0 - (-end).exp());
    Some(mean * 16.0 * sample_rate_hz / (3.0 * count * part))
}

/// Fewest equal samples at the end of a record that are padding, and samples before that are compared.
const PADDING: usize = 16;
const BEFORE_PADDING: usize = 64;
/// Converter steps from rest below which an oscillation is not resolved.
const RESOLVED_STEPS: f64 = 2.5;
/// Share of equal neighbours in a tail whose noise is below the converter step, and the tail.
const CONSTANT: f64 = 0.9;
const TAIL: f64 = 0.75;

/// The part of some samples that holds a measurement, and what its converter resolves.
///
/// Equal samples at the end are padding where the samples before differ from them by more than 2.5
/// converter steps, and else an oscillation below half a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MeasuredPart {
    /// Number of samples before the padding.
    pub(crate) measured: usize,
    /// Smallest amplitude that is resolved: 2.5 steps, where noise below the step leaves a tail that is constant;
    /// else zero.
    pub(crate) resolved: f64,
    /// Step of the converter: the smallest change between neighbours.
    step: f64,
}

impl MeasuredPart {
    pub(crate) fn of(samples: &[f64]) -> Self {
        let step = converter_step(samples);
        let Some(&last) = samples.last() else { return Self { measured: 0, resolved: 0.0, step } };
        let run = samples.iter().rev().take_while(|x| **x == last).count();
        let before = &samples[..samples.len() - run];
        let nearest = &before[before.len().saturating_sub(BEFORE_PADDING)..];
        let is_far = |x: &f64| (x - last).abs() > RESOLVED_STEPS * step;
        let is_padded = run >= PADDING && nearest.iter().any(is_far);
        let measured = if is_padded { before.len() } else { samples.len() };
        let tail = &samples[(TAIL * measured as f64) as usize..measured];
        let equal = tail.windows(2).filter(|pair| pair[0] == pair[1]).count();
        let is_coarse = equal as f64 > CONSTANT * tail.len() as f64;
        Self { measured, resolved: if is_coarse { RESOLVED_STEPS * step } else { 0.0 }, step }
    }

    /// One-sided spectral density of the rounding to converter steps, `step^2 / 12` up to half the sample
    /// rate: the least noise of the samples.
    pub(crate) fn rounding_density(&self, sample_rate_hz: f64) -> f64 {
        self.step * self.step / (6.0 * sample_rate_hz)
    }
}

/// Smallest change between neighbours; zero for a constant.
pub(crate) fn converter_step(samples: &[f64]) -> f64 {
    let changes = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let least = changes.filter(|change| *change > 0.0).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Padding behind noise, a decay below half a step, and samples without either.
    #[test]
    fn padding_and_unresolved_tails_are_told_apart() {
        let decay = |n: usize| (-0.01 * n as f64).exp() * (0.3 * n as f64).cos();
        let noise = |n: usize| 1e-3 * f64::from((n as u32).wrapping_mul(2_654_435_761) % 1000);
        let noisy: Vec<f64> = (0..1000).map(|n| decay(n) + noise(n)).collect();
        let whole = MeasuredPart::of(&noisy);
        assert_eq!((whole.measured, whole.resolved), (1000, 0.0));
        let padded = [noisy, vec![0.0; 500]].concat();
        let part = MeasuredPart::of(&padded);
        assert_eq!((part.measured, part.resolved), (1000, 0.0));
        let coarse: Vec<f64> = (0..2000).map(|n| (100.0 * decay(n)).round()).collect();
        let part = MeasuredPart::of(&coarse);
        assert_eq!((part.measured, part.resolved), (2000, 2.5));
        assert!((part.rounding_density(3.0) - 1.0 / 18.0).abs() < 1e-15);
        assert_eq!(MeasuredPart::of(&[1.0; 50]).measured, 50);
        assert_eq!(MeasuredPart::of(&[]).measured, 0);
    }

    /// Verified against values that can be counted, with outliers and NaN.
    #[test]
    fn outliers_hardly_change_the_level() {
        let mut samples: Vec<f64> = (-50..=50).map(f64::from).collect();
        samples.extend([f64::NAN, 1e9, f64::INFINITY, -1e9]);
        let level = robust_level(&samples).unwrap();
        assert_eq!(level.median, 0.0);
        // |x| of 103 values: 0, 1, 1, 2, 2, ...: the 52nd is 26.
        assert_eq!(level.deviation, NORMAL * 26.0);
        assert_eq!(robust_level(&[f64::NAN]), None);
    }

    /// Verified against the variance of an alternating signal, the integral of the density.
    #[test]
    fn white_density_integrates_to_the_variance() {
        let samples: Vec<f64> = (0..1000).map(|n| if n % 2 == 0 { 0.5 } else { 1.5 }).collect();
        let density = white_density(&samples, 2000.0).unwrap();
        // n / (n - 1) above the plain mean square.
        assert!((density * 1000.0 - 0.25 * 1000.0 / 999.0).abs() < 1e-12);
        assert_eq!(white_density(&[1.0, 2.0], 1.0), None);
        assert_eq!(white_density(&[f64::NAN; 9], 1.0), None);
    }
}
