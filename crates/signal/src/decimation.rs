//! Decimation of signals to a band of interest.

use crate::bessel::bessel_i0;
use crate::sums::dot;
use std::f64::consts::PI;
use std::ops::Range;

/// Stopband attenuation \[dB\] of a search for peaks, and its decimated sample rate over the highest
/// frequency kept.
const SEARCH: (f64, f64) = (180.0, 6.0);
/// Decimated sample rate of [`DecimationFilter::keeping`] over the highest frequency kept: few taps.
const KEPT: f64 = 4.4;

/// A low-pass filter of which every `D`-th output sample is kept.
///
/// A Kaiser-windowed sinc of `2 P + 1` taps passes the band `0..high` and attenuates the bands that
/// alias into it, `rate/D - high..rate/D + high` and above:
///
/// ```text
/// g_j = sin(pi j / D) / (pi j) I0(beta sqrt(1 - (j/P)^2)) / I0(beta),   |j| <= P
/// ```
///
/// Applied to a force and its response alike, the filter cancels in their ratio; the error is that
/// of aliasing alone.
///
/// Source of `beta` and `P`: J. F. Kaiser, "Nonrecursive digital filter design using the
/// I0-sinh window function", Proc. IEEE ISCAS 1974, 20-23.
///
/// ```
/// use asperity_signal::DecimationFilter;
///
/// let filter = DecimationFilter::keeping(200_000.0, 2_700.0);
/// assert_eq!(filter.factor(), 16);
/// assert!(DecimationFilter::highest_kept(200_000.0 / 16.0) >= 2_700.0);
/// let constant = filter.apply(&vec![1.0; 20_000], &(0..20_000));
/// assert!((constant[600] - 1.0).abs() < 1e-4);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DecimationFilter {
    factor: usize,
    taps: Vec<f64>,
}

impl DecimationFilter {
    /// The filter of a search up to `high` (Hz) in `count` samples; `None` where it would save
    /// nothing.
    pub(crate) fn new(rate: f64, high: f64, count: usize) -> Option<Self> {
        let (attenuation, oversampling) = SEARCH;
        // The cast saturates.
        let factor = ((rate / (oversampling * high)) as usize).min(count);
        if factor < 2 {
            return None;
        }
        let filter = Self::designed(factor, high / rate, attenuation);
        (count >= 2 * filter.taps.len()).then_some(filter)
    }

    /// The filter that keeps peaks at frequencies up to `high` within 1e-5 of the largest value.
    ///
    /// - `rate`, `high`: sample rate and highest frequency, both positive, in hertz.
    ///
    /// Below a sample rate of `8.8 high` the factor is 1 and the single tap is 1. The taps depend
    /// on the factor alone.
    pub fn keeping(rate: f64, high: f64) -> Self {
        Self::keeping_within(rate, high, 1e-5)
    }

    /// As [`keeping`](Self::keeping), within `error` of the largest value, between 0.01 and 1e-9; the taps depend on
    /// the factor and the error.
    pub fn keeping_within(rate: f64, high: f64, error: f64) -> Self {
        let (attenuation, oversampling) = (-20.0 * error.clamp(1e-9, 0.01).log10(), KEPT);
        let factor = (rate / (oversampling * high)).min(1e6);
        if factor < 2.0 {
            return Self { factor: 1, taps: vec![1.0] };
        }
        let factor = factor as usize;
        Self::designed(factor, 1.0 / (oversampling * factor as f64), attenuation)
    }

    /// The highest frequency \[Hz\] that filters of [`keeping`](Self::keeping) keep of samples decimated to `decimated_rate`.
    pub fn highest_kept(decimated_rate: f64) -> f64 {
        decimated_rate / KEPT
    }

    /// The filter that keeps the band up to `band` cycles a sample.
    fn designed(factor: usize, band: f64, attenuation: f64) -> Self {
        let transition = 2.0 * PI * (1.0 / factor as f64 - 2.0 * band);
        let half = ((attenuation - 7.95) / (2.285 * transition) / 2.0).ceil() as usize;
        let beta = 0.1102 * (attenuation - 8.7);
        let scale = 1.0 / bessel_i0(beta);
        let tap = |index: usize| {
            let j = index as f64 - half as f64;
            let sinc = if index == half {
                1.0 / factor as f64
            } else {
                (PI * j / factor as f64).sin() / (PI * j)
            };
            let inside = 1.0 - (j / half as f64).powi(2);
            sinc * bessel_i0(beta * inside.max(0.0).sqrt()) * scale
        };
        let side: Vec<f64> = (0..=half).map(tap).collect();
        let taps = side.iter().chain(side[..half].iter().rev()).copied();
        Self { factor, taps: taps.collect() }
    }

    /// The taps `g_j`, symmetric.
    pub fn taps(&self) -> &[f64] {
        &self.taps
    }

    /// The decimation factor `D`: input samples per output sample.
    pub fn factor(&self) -> usize {
        self.factor
    }

    /// The decimated samples `y_j = sum_l g_l x_(j D - l)`, over the whole extent of the
    /// convolution.
    ///
    /// - `samples`: any unit; zero outside the indices `support`.
    ///
    /// The output is delayed by half the filter, `P` input samples.
    pub fn apply(&self, samples: &[f64], support: &Range<usize>) -> Vec<f64> {
        let reach = self.taps.len() - 1;
        (0..=(samples.len() + reach) / self.factor)
            .map(|output| {
                // The filter lies over samples `end - reach..=end`.
                let end = output * self.factor;
                let first = support.start.max(end.saturating_sub(reach));
                let last = support.end.min(end + 1);
                if first >= last {
                    return 0.0;
                }
                let offset = first + reach - end;
                dot(&samples[first..last], &self.taps[offset..])
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::absolute_sum;
    use crate::transform::transform_at;

    /// Verified against the transform of all samples: on a full-band signal (a decaying
    /// exponential from a step) the band's transform agrees to the designed 1e-9 of
    /// `dt sum |x|`, doubled for the several bands that fold.
    #[test]
    fn decimation_keeps_the_transform_in_the_band() {
        let (rate, high, count) = (200_000.0, 2_700.0, 10_000);
        let samples: Vec<f64> = (0..count)
            .map(|n| (-2e-3 * f64::from(n)).exp() * (1.0 + 0.5 * f64::from(n % 2)))
            .collect();
        let whole = 0..samples.len();
        let filter = DecimationFilter::new(rate, high, samples.len()).unwrap();
        assert_eq!(filter.factor(), 12);
        let fewer = filter.apply(&samples, &whole);
        assert!(fewer.len() < count as usize / 11);
        let absolute = absolute_sum(&samples) / rate;
        for frequency in [0.0, 400.0, 1_000.0, 2_000.0, 2_700.0] {
            let exact = transform_at(&samples, rate, frequency).norm();
            let found = transform_at(&fewer, rate / 12.0, frequency).norm();
            assert!((found - exact).abs() < 2e-9 * absolute, "{frequency} Hz");
        }
        // Samples outside the support count as zero.
        let mut cut = samples.clone();
        cut[..300].fill(0.0);
        cut[1000..].fill(0.0);
        assert_eq!(filter.apply(&samples, &(300..1000)), filter.apply(&cut, &(300..1000)));
        let difference: f64 = filter
            .apply(&cut, &whole)
            .iter()
            .zip(filter.apply(&cut, &(300..1000)))
            .map(|(a, b)| (a - b).abs())
            .sum();
        assert!(difference < 1e-12);
    }

    /// Verified against the documentation: no decimation of wide bands and of short records.
    #[test]
    fn wide_bands_and_short_records_are_not_decimated() {
        assert!(DecimationFilter::new(1000.0, 200.0, 10_000).is_none());
        assert!(DecimationFilter::new(200_000.0, 2_700.0, 300).is_none());
        assert!(DecimationFilter::new(200_000.0, f64::INFINITY, 10_000).is_none());
        assert!(DecimationFilter::new(200_000.0, f64::NAN, 10_000).is_none());
    }
}
