//! Spectra of a hit, as the searches for peaks and widths use them.

use crate::fit::parabola_vertex;
use crate::form::ResponseKind;
use crate::sums::{absolute_sum, dot, largest_magnitude};
use num_complex::Complex64;
use std::borrow::Cow;
use std::f64::consts::TAU;
use std::ops::Range;

/// Receptance of a hit and the transforms it is the ratio of.
pub(crate) trait HitSpectra {
    /// The transforms from zero to just above `high` (Hz), zero-padded by `padding` or more, up to
    /// a common phase.
    fn band(&self, padding: usize, high: f64) -> BandSpectra<'_>;
    /// Quantity of the response samples.
    fn kind(&self) -> ResponseKind;
    /// Magnitude of the transform of the force \[N s\].
    fn force_magnitude(&self, frequency_hz: f64) -> f64;
    /// Receptance \[m/N\].
    fn receptance_at(&self, frequency_hz: f64) -> Complex64;
    /// `|H|^2` and the derivative of its logarithm with respect to frequency \[1/Hz\].
    fn power_and_slope(&self, frequency_hz: f64) -> (f64, f64);
    /// The ripples of a response whose end is read in its last `period` \[s\].
    fn ripples(&self, period: f64) -> Ripples;
}

/// Transforms of force and response at `k step`, from zero.
pub(crate) struct BandSpectra<'a> {
    pub(crate) step: f64,
    /// Duration of the record \[s\].
    pub(crate) duration: f64,
    pub(crate) samples: Cow<'a, [Complex64]>,
    pub(crate) force: Cow<'a, [Complex64]>,
}

/// Transforms of force and response at one frequency.
pub(crate) struct HitTransforms {
    pub(crate) response: SignalTransform,
    pub(crate) force: SignalTransform,
}

/// Transform of a signal, its derivative with respect to frequency, and the samples it is taken
/// over.
pub(crate) struct SignalTransform {
    pub(crate) value: Complex64,
    pub(crate) slope: Complex64,
    pub(crate) samples: Range<usize>,
}

/// The last samples of a motion at a higher rate than those that are analysed, as they were before a low-pass filter took
/// them in. The filter hides how the motion ends, on which the [ripples](crate::HarmonicOptions::leakage_margin) depend.
#[derive(Debug, Clone, Copy)]
pub struct UnfilteredEnd<'a> {
    /// The samples, up to the end of the motion, over so [many](Self::PERIODS) periods of the fundamental or more.
    pub samples: &'a [f64],
    /// Their rate \[Hz\].
    pub sample_rate_hz: f64,
}

impl UnfilteredEnd<'_> {
    /// Periods of the fundamental that are read: the last one, the window about both of its ends, and room for whole samples.
    pub const PERIODS: f64 = 1.05 + SLOW;
}

/// Ripples of a step `x_end` at 1.5 times the frequency of the oscillation it ends, over `x_end / w`.
pub(crate) const COVERED: f64 = 1.8;

/// Length of the window of slow motion, over the period: it leaves 0.96 of the period's motion, and a half of that at four times
/// its frequency.
const SLOW: f64 = 0.25;

/// Slow and fast motion in the last period of a record: samples under a moving window, a Hann window of a quarter of the
/// period, and the rest.
///
/// The end of a motion `x` far below a frequency w adds ripples of `x / w`; of one far above, of its integral:
///
/// ```text
/// | integral from T of x exp(-i w t) dt |  ->  | x(T) | / w,   | integral of x up to T |,   x periodic of mean zero
/// ```
///
/// that of a light body that rings a hundred times as fast hardly matters.
#[derive(Debug, Clone, Copy)]
struct EndMotion {
    /// Largest magnitude of the slow motion.
    slow: f64,
    /// Largest magnitude of the integral of the fast motion, in samples.
    fast_integral: f64,
}

impl EndMotion {
    /// The motion in the last `period` of a record, in samples. Without enough of them all of it is slow.
    fn of(samples: &[f64], period: usize) -> Self {
        let all = || largest_between(&samples[samples.len().saturating_sub(period)..]);
        Self::apart(samples, period).unwrap_or_else(|| Self { slow: all(), fast_integral: 0.0 })
    }

    /// The motion at 64 places or a few more; `None` without three samples in the window.
    fn apart(samples: &[f64], period: usize) -> Option<Self> {
        let length = SLOW * period as f64;
        let half = (0.5 * length) as usize;
        let first = samples.len().checked_sub(period + half).filter(|first| *first >= half)?;
        if length < 3.0 {
            return None;
        }
        let weights: Vec<f64> =
            (0..=2 * half).map(|k| 1.0 + (TAU * (k as f64 - half as f64) / length).cos()).collect();
        let sum: f64 = weights.iter().sum();
        let turn = |k: usize| TAU * (k as f64 - half as f64) / period as f64;
        let gain = (0..=2 * half).map(|k| weights[k] * turn(k).cos()).sum::<f64>() / sum;
        let windowed =
            |of: &[f64], place: usize| dot(&weights, &of[place - half..=place + half]) / sum;
        let places = || (first..samples.len() - half).step_by((period / 64).max(1));
        let slow: Vec<f64> = places().map(|place| windowed(samples, place)).collect();
        let slow = largest_between(&slow) / gain;
        let integral = trapezoids(&samples[first - half..]);
        let rest = |place: usize| {
            let place = place - (first - half);
            (integral[place] - windowed(&integral, place)).abs()
        };
        // The window leaves a little of the slow motion too.
        let left = (1.0 - gain) * slow * period as f64 / TAU;
        let fast_integral = (places().map(rest).fold(0.0, f64::max) - left).max(0.0);
        Some(Self { slow, fast_integral })
    }

    /// Magnitude of a slow motion that adds ripples as large at an angular frequency \[rad per sample\], in units of those
    /// of slow motion at 1.5 times its frequency.
    fn size(&self, omega: f64) -> f64 {
        self.slow + omega * self.fast_integral / COVERED
    }
}

/// Integral up to each sample, in samples, by the trapezoidal rule.
fn trapezoids(samples: &[f64]) -> Vec<f64> {
    let (mut sum, mut last) = (0.0, 0.0);
    let next = |sample: &f64| {
        sum += 0.5 * (last + sample);
        last = *sample;
        sum
    };
    samples.iter().map(next).collect()
}

/// Largest magnitude of samples, or of the parabola through one and its smaller neighbours.
fn largest_between(samples: &[f64]) -> f64 {
    let crest = |three: &[f64]| {
        let [left, here, right] = [0, 1, 2].map(|k| three[k] * three[1].signum());
        let is_crest = here >= left && here >= right;
        parabola_vertex([left, here, right]).filter(|_| is_crest).map_or(here, |(_, height)| height)
    };
    samples.windows(3).map(crest).fold(largest_magnitude(samples), f64::max)
}

/// Ripples of `|H|` that are not the structure's, from the end of a record and from rounding.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ripples {
    /// The motion where the record ends, per sample of this rate \[Hz\].
    end: EndMotion,
    rate: f64,
    /// Rounding of the response's transform.
    rounding: f64,
    kind: ResponseKind,
}

/// Bounds on the ripple of `|H|` \[m/N\] at a frequency.
pub(crate) struct Ripple {
    pub(crate) leakage: f64,
    pub(crate) rounding: f64,
}

impl Ripples {
    /// Those of `samples` at a `rate` \[Hz\]. Their motion is read in its last `period` \[s\], between samples too, and
    /// before a filter if its `end` there is given.
    pub(crate) fn of(
        samples: &[f64],
        (rate, kind): (f64, ResponseKind),
        end: Option<UnfilteredEnd<'_>>,
        period: f64,
    ) -> Self {
        let end = end.unwrap_or(UnfilteredEnd { samples, sample_rate_hz: rate });
        let count = (period * end.sample_rate_hz).ceil() as usize;
        let motion = EndMotion::of(end.samples, count.clamp(1, end.samples.len().max(1)));
        let rounding = 1e-14 * absolute_sum(samples) / rate;
        Self { end: motion, rate: end.sample_rate_hz, rounding, kind }
    }

    /// Those of the response over a factor.
    pub(crate) fn over(self, factor: f64) -> Self {
        let EndMotion { slow, fast_integral } = self.end;
        let end = EndMotion { slow: slow / factor, fast_integral: fast_integral / factor };
        Self { end, rounding: self.rounding / factor, ..self }
    }

    /// The ripple at a frequency where the force has a spectral magnitude `force`.
    ///
    /// `leakage` is that of the step at the end of the record, `x_end / (w |F|)` with `x_end` the
    /// [size](EndMotion::size) of the motion there; `rounding` is that of the transform, relative to `dt sum |x|`.
    pub(crate) fn at(&self, frequency_hz: f64, force: f64) -> Ripple {
        let omega = TAU * frequency_hz;
        let scale = 1.0 / (omega.powi(self.kind.derivatives()) * force);
        let size = self.end.size(omega / self.rate);
        Ripple { leakage: size / omega * scale, rounding: self.rounding * scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Size of the end of samples at a rate and a frequency, from a period \[s\].
    fn end_size(samples: &[f64], rate: f64, period: f64, frequency_hz: f64) -> f64 {
        let ripples = Ripples::of(samples, (rate, ResponseKind::Displacement), None, period);
        ripples.at(frequency_hz, 1.0).leakage * TAU * frequency_hz
    }

    /// A decay of 1 % a period; its filtered samples, which run out in zeros, do not show its end.
    #[test]
    fn the_size_of_an_end_is_read_before_a_filter() {
        let (rate, frequency) = (1000.0, 68.0);
        let motion = |n: i32| {
            let periods = f64::from(n) / rate * frequency;
            0.99_f64.powf(periods) * (TAU * periods).sin()
        };
        let plain: Vec<f64> = (0..1500).map(motion).collect();
        let exact = 0.99_f64.powf(1.5 * frequency - 1.0);
        let found = end_size(&plain, rate, 1.0 / frequency, frequency);
        assert!((found / exact - 1.0).abs() < 0.01, "{found}");
        let filtered: Vec<f64> = plain.iter().step_by(5).copied().chain([0.0; 16]).collect();
        assert_eq!(end_size(&filtered, 0.2 * rate, 1.0 / frequency, frequency), 0.0);
        let kept = [plain.as_slice(), &plain[1450..], &plain[1497..], &[]].map(|samples| {
            let end = Some(UnfilteredEnd { samples, sample_rate_hz: rate });
            let sampling = (0.2 * rate, ResponseKind::Displacement);
            let ripples = Ripples::of(&filtered, sampling, end, 1.0 / frequency).over(2.0);
            ripples.at(frequency, 1.0).leakage * TAU * frequency
        });
        assert_eq!(kept[0], 0.5 * found);
        assert_eq!(kept[1], 0.5 * found);
        // Of less than a period all that there is.
        assert!(kept[2] > 0.0 && kept[2] < 0.6 * found && kept[3] == 0.0, "{kept:?}");
    }

    /// The end of an oscillation and of a faster one: its size is no less than its largest ripples ask for, wherever the
    /// record ends, and not twice as much. Exactly, `x = a sin(w0 t + phi)` adds ripples of
    /// `a |w0 cos(phi) + i w sin(phi)| / |w0^2 - w^2|`.
    #[test]
    fn a_fast_oscillation_counts_as_much_as_its_ripples() {
        let (rate, frequency) = (1e5, 100.0);
        let largest_ripple =
            |size: f64, f0: f64, f: f64| size * f.max(f0) * f / (f0 * f0 - f * f).abs() / COVERED;
        for (ratio, size) in
            [(3.3, 1.0), (4.1, 2.0), (5.0, 1.0), (8.0, 3.0), (13.3, 20.0), (20.3, 1.0)]
        {
            for at in [1.6, 1.9, 2.3] {
                let both = |n: usize| {
                    let turn = TAU * frequency * n as f64 / rate;
                    turn.sin() + size * (ratio * turn).cos()
                };
                let needed =
                    [(1.0, 1.0), (size, ratio)].map(|(size, f0)| largest_ripple(size, f0, at));
                let needed: f64 = needed.iter().sum();
                for length in (5000..6000).step_by(37) {
                    let record = (0..length).map(both).collect::<Vec<_>>();
                    let found = end_size(&record, rate, 1.0 / frequency, at * frequency);
                    let over = found / needed;
                    assert!(
                        (0.98..2.0).contains(&over),
                        "{ratio} {size} at {at}: {found} {needed}"
                    );
                }
            }
        }
    }
}
