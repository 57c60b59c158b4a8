//! Spectra of a hit, as the searches for peaks and widths use them.

use crate::fit::parabola_vertex;
use crate::form::ResponseKind;
use crate::linear_prediction::continued;
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
    /// Bounds on the ripple of `|H|` from truncation and rounding; see [`Ripple::of`].
    fn ripple(&self, frequency_hz: f64, end: RecordEnd) -> Ripple;
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

/// The time before a record's end in which its size is read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RecordEnd {
    /// Length that is searched for its largest magnitude \[s\].
    pub(crate) period: f64,
    /// Time after it, in which a filter runs out \[s\]; the motion ends in the middle of it.
    pub(crate) run_out: f64,
    /// True if the motion is [continued](continued) to where it ends; else its decay is.
    pub(crate) is_predicted: bool,
}

impl RecordEnd {
    /// [Size](EndMotion::size) of the motion at the end of a record; where a filter runs out after it, of the motion that is predicted
    /// up to its end, or quickly, of the period before less the decay of two periods up to its end, over the half of that time.
    fn size(self, samples: &[f64], rate: f64, frequency_hz: f64) -> f64 {
        let count = |time: f64| (time * rate).ceil() as usize;
        let period = count(self.period).max(1).min(samples.len());
        // A record shorter than both is searched from its start.
        let to = samples.len().saturating_sub(count(self.run_out)).max(period);
        let omega = TAU * frequency_hz / rate;
        let earlier =
            |periods: usize| EndMotion::of(&samples[..to.saturating_sub(periods * period)], period);
        let last = earlier(0);
        if self.run_out == 0.0 {
            return last.size(omega);
        }
        if self.is_predicted {
            let rest = continued(&samples[..to], count(0.5 * self.run_out));
            let all = [&samples[to.saturating_sub(2 * period)..to], &rest].concat();
            // Motion that rings down stays below its last periods, a wrong prediction may not.
            let most = [last, earlier(1), earlier(2)].map(|motion| motion.size(omega));
            let most = most.into_iter().fold(0.0, f64::max);
            return EndMotion::of(&all, period).size(omega).min(most);
        }
        // Over two periods: of one the crest may be read, and of the other the trough.
        let decay = last.slow / earlier(2).slow;
        let left = if decay < 1.0 { decay.powf(0.25 * self.run_out / self.period) } else { 1.0 };
        left * last.size(omega)
    }
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
    /// The motion of a record that ends in a `period`, in samples. Without enough of them all of it is slow.
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

/// Bounds on the ripple of `|H|` \[m/N\] that is not the structure's.
pub(crate) struct Ripple {
    pub(crate) leakage: f64,
    pub(crate) rounding: f64,
}

impl Ripple {
    /// Ripple of a record of `samples` under a force of spectral magnitude `force` at a frequency.
    ///
    /// `leakage` is that of the step at the end of the record, `x_end / (w |F|)` with `x_end` the
    /// size of the motion in its `end`, between samples too; `rounding` is that of the transform, relative
    /// to `dt sum |x|`.
    pub(crate) fn of(
        samples: &[f64],
        (rate, kind): (f64, ResponseKind),
        force: f64,
        (frequency_hz, end): (f64, RecordEnd),
    ) -> Self {
        let end = end.size(samples, rate, frequency_hz);
        let omega = TAU * frequency_hz;
        let scale = 1.0 / (omega.powi(kind.derivatives()) * force);
        Self {
            leakage: end / omega * scale,
            rounding: 1e-14 * absolute_sum(samples) / rate * scale,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A decay of 1 % a period; its last twelfth of a second is 9 % larger, and runs out in zeros.
    #[test]
    fn the_size_of_an_end_is_read_before_a_filter_runs_out() {
        let (rate, frequency, half) = (1000.0, 68.0, 83);
        let motion = |n: i32| {
            let periods = f64::from(n) / rate * frequency;
            0.99_f64.powf(periods) * (TAU * periods).sin()
        };
        let end = RecordEnd { period: 1.0 / frequency, run_out: 0.0, is_predicted: false };
        let plain: Vec<f64> = (0..1500).map(motion).collect();
        let exact = 0.99_f64.powf(1.5 * frequency - 1.0);
        let size = end.size(&plain, rate, frequency) / exact;
        assert!((size - 1.0).abs() < 0.01, "{size}");
        let overshot = (0..1500).map(|n| if n < 1500 - half { 1.0 } else { 1.09 } * motion(n));
        let filtered: Vec<f64> = overshot.chain((0..half).map(|_| 0.0)).collect();
        let told = RecordEnd { run_out: f64::from(2 * half) / rate, ..end };
        let predicted = RecordEnd { is_predicted: true, ..told };
        // Quickly, an error of the decay of two periods, up to a half of one where crest and trough are read, counts 2.8 times.
        for (end, tolerance) in [(told, 0.02), (predicted, 0.01)] {
            let size = end.size(&filtered, rate, frequency) / exact;
            assert!((size - 1.0).abs() < tolerance, "{size}");
        }
        assert_eq!(end.size(&filtered, rate, frequency), 0.0);
        let growing: Vec<f64> = (0..300).map(|n| 1.1_f64.powi(n)).collect();
        assert!(predicted.size(&growing, rate, frequency) <= growing[299]);
        assert!(
            told.size(&filtered[..20], rate, frequency) > 0.0
                && told.size(&[], rate, frequency) == 0.0
        );
    }

    /// The end of an oscillation and of a faster one: its size is no less than its largest ripples ask for, wherever the
    /// record ends, and not twice as much. Exactly, `x = a sin(w0 t + phi)` adds ripples of
    /// `a |w0 cos(phi) + i w sin(phi)| / |w0^2 - w^2|`.
    #[test]
    fn a_fast_oscillation_counts_as_much_as_its_ripples() {
        let (rate, frequency) = (1e5, 100.0);
        let end = RecordEnd { period: 1.0 / frequency, run_out: 0.0, is_predicted: false };
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
                    let found = end.size(&record, rate, at * frequency);
                    let over = found / needed;
                    assert!(
                        (0.98..2.0).contains(&over),
                        "{ratio} {size} at {at}: {found} {needed}"
                    );
                }
            }
        }
    }

    /// Two modes that beat: the period before a filter runs out is up to twice as large or half as large as the last.
    #[test]
    fn the_end_of_beating_modes_is_predicted() {
        let (rate, half) = (730.0, 15);
        let motion = |n: usize| {
            let t = n as f64 / rate;
            let mode = |f: f64, decay: f64| (-decay * t).exp() * (TAU * f * t).sin();
            mode(49.4, 3.0) + 0.7 * mode(77.4, 2.0)
        };
        let end = RecordEnd { period: 1.0 / 49.4, run_out: 0.0, is_predicted: false };
        let run_out = (2 * half) as f64 / rate;
        let mut worst = [0.0_f64; 2];
        for length in 200..240 {
            let all: Vec<f64> = (0..length).map(motion).collect();
            let exact = end.size(&all, rate, 49.4);
            // What the filter leaves of the samples beside the end does not count.
            let filtered = [&all[..length - half], &vec![f64::NAN; 2 * half][..]].concat();
            for (is_predicted, worst) in [false, true].into_iter().zip(&mut worst) {
                let told = RecordEnd { run_out, is_predicted, ..end };
                *worst = worst.max((told.size(&filtered, rate, 49.4) / exact).ln().abs());
            }
        }
        assert!(worst[0] > 0.3 && worst[1] < 0.02, "{worst:?}");
    }
}
