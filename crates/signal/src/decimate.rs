//! Fewer samples for a search in a narrow band.

use std::f64::consts::PI;
use std::ops::Range;

/// Attenuation of what would fold into the band, and ripple inside it, in decibels.
const ATTENUATION: f64 = 180.0;
/// Decimated rate over the highest frequency kept, at least.
const OVERSAMPLING: f64 = 6.0;
/// Partial sums of a dot product.
const LANES: usize = 8;

/// A low-pass filter that keeps every `factor`-th sample of its output.
///
/// With the rate `r' = rate / factor` the band `0..high` folds with
/// `r' - high..r' + high` and above. A Kaiser-windowed sinc passes the first
/// and stops the rest, both to 1e-9 of the largest value of the transform:
///
/// ```text
/// g_j = sin(pi j / D) / (pi j) I0(beta sqrt(1 - (j/P)^2)) / I0(beta),   |j| <= P.
/// ```
///
/// Source: J. F. Kaiser, "Nonrecursive digital filter design using the
/// I0-sinh window function", Proc. IEEE ISCAS 1974, 20-23, for `beta` and `P`.
/// Applied to a force and its response alike it drops out of their ratio, and what folds is all
/// that is lost.
#[derive(Debug, Clone, PartialEq)]
pub struct DecimationFilter {
    factor: usize,
    taps: Vec<f64>,
}

/// What [`DecimationFilter::keeping`] asks of attenuation \[dB\] and of the decimated rate over the
/// highest frequency kept: enough for peaks to 1e-5 of the largest value, with few taps.
const THRIFTY_ATTENUATION: f64 = 100.0;
const THRIFTY_OVERSAMPLING: f64 = 4.4;

impl DecimationFilter {
    /// For frequencies up to `high` (Hz); `None` where decimation would not pay.
    pub(crate) fn new(rate: f64, high: f64, count: usize) -> Option<Self> {
        // A factor beyond the record's length is no use; the cast saturates.
        let factor = ((rate / (OVERSAMPLING * high)) as usize).min(count);
        if factor < 2 {
            return None;
        }
        let filter = Self::designed(factor, high / rate, ATTENUATION);
        (count >= 2 * filter.taps.len()).then_some(filter)
    }

    /// Keeps so many samples that frequencies up to `high` (Hz) stay, with as few taps as give
    /// 100 dB; the factor is 1, and the filter none, where nothing can be left out.
    ///
    /// The filter depends on the factor alone, so that records of different rates can share one.
    pub fn keeping(rate: f64, high: f64) -> Self {
        let factor = (rate / (THRIFTY_OVERSAMPLING * high)).min(1e6);
        if factor < 2.0 {
            return Self { factor: 1, taps: vec![1.0] };
        }
        let factor = factor as usize;
        let band = 1.0 / (THRIFTY_OVERSAMPLING * factor as f64);
        Self::designed(factor, band, THRIFTY_ATTENUATION)
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

    /// The filter, symmetric.
    pub fn taps(&self) -> &[f64] {
        &self.taps
    }

    /// Samples left out per sample kept.
    pub fn factor(&self) -> usize {
        self.factor
    }

    /// Every `factor`-th filtered sample, from the filter's first touch to its last: output j is
    /// `sum of taps_l x_(j factor - l)`.
    ///
    /// Only the samples in `support` are not zero. All outputs of one filter
    /// are late by the same half filter.
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

/// `sum a_j b_j` over the shorter of two.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let b = &b[..a.len().min(b.len())];
    let (chunks, rest) = a.as_chunks::<LANES>();
    let (others, other_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (x, y) in chunks.iter().zip(others) {
        for lane in 0..LANES {
            sums[lane] += x[lane] * y[lane];
        }
    }
    let tail: f64 = rest.iter().zip(other_rest).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + tail
}

/// Modified Bessel function of order zero, `sum ((x/2)^k / k!)^2`.
fn bessel_i0(x: f64) -> f64 {
    let quarter = 0.25 * x * x;
    let (mut term, mut sum) = (1.0, 1.0);
    // The terms fall once k > x/2; x is below 20, and 60 leave nothing.
    for k in 1..=60_u32 {
        term *= quarter / f64::from(k * k);
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pairwise::absolute_sum;
    use crate::transform::transform_at;

    /// Verified against the transform of all samples: on a full-band signal (a decaying
    /// exponential from a step) the band's transform agrees to the designed 1e-9 of
    /// `dt sum |x|`, doubled for the several bands that fold.
    #[test]
    fn the_band_is_kept() {
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
        // Samples said to be outside the support are as good as zero.
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

    /// Verified against I0(1) and I0(19) (Abramowitz and Stegun 9.8; 19 by its asymptotic series).
    #[test]
    fn the_bessel_function_is_right() {
        assert!((bessel_i0(1.0) - 1.266_065_877_752_008_4).abs() < 1e-15);
        let x = 19.0_f64;
        let mut series = 1.0;
        let mut term = 1.0;
        for k in 1..30 {
            let odd = f64::from(2 * k - 1);
            term *= odd * odd / (8.0 * x * f64::from(k));
            series += term;
        }
        let asymptotic = x.exp() / (2.0 * PI * x).sqrt() * series;
        assert!((bessel_i0(x) / asymptotic - 1.0).abs() < 1e-12);
    }

    /// Verified against the documentation: no decimation where there is nothing to gain.
    #[test]
    fn wide_bands_and_short_records_stay() {
        assert!(DecimationFilter::new(1000.0, 200.0, 10_000).is_none());
        assert!(DecimationFilter::new(200_000.0, 2_700.0, 300).is_none());
        assert!(DecimationFilter::new(200_000.0, f64::INFINITY, 10_000).is_none());
        assert!(DecimationFilter::new(200_000.0, f64::NAN, 10_000).is_none());
    }
}
