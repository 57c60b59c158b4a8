//! Damping from the logarithmic decrement of a free decay.

use crate::fit::{fitted_line, quartic_vertex};
use std::f64::consts::PI;

/// The logarithmic decrement of a free decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogarithmicDecrement {
    /// Damping ratio, `delta / sqrt(4 pi^2 + delta^2)`; negative for a growing oscillation.
    pub ratio: f64,
    /// Logarithmic decrement `delta`, the decrease of the logarithm of the amplitude per cycle.
    pub decrement: f64,
    /// Damped natural frequency, in hertz.
    pub frequency_hz: f64,
    /// Number of cycles fitted.
    pub cycles: f64,
    /// Root mean square residual of the logarithms of the amplitudes.
    pub scatter: f64,
}

/// Smallest peak-to-peak height used, over the first.
const FLOOR: f64 = 1e-4;
/// Samples a cycle to refine extrema by, or up to twice as many.
const SAMPLES_A_CYCLE: f64 = 64.0;
/// Fewest heights for a line and its scatter.
const FEWEST: usize = 3;

/// Damping of a free decay of one mode from its successive maxima and minima.
///
/// ```text
/// u(t) = c + a exp(-zeta w t) cos(w sqrt(1 - zeta^2) t + phi)
/// ln |u_k - u_{k+1}| = const - k delta / 2,   zeta = delta / sqrt(4 pi^2 + delta^2)
/// ```
///
/// with `u_k` the alternating extrema, refined by a quartic through five
/// samples, of 64 to 128 a cycle where there are more. Their differences do not contain the
/// offset `c`; the line is fitted by least squares. For a decay with other modes see
/// [`envelope_decrement`](crate::envelope_decrement).
///
/// - `samples`: free decay from the first sample on, any unit. The first extremum taken is a
///   quarter of a cycle later, or more.
/// - `sample_rate_hz`: in hertz. The error of the quartic is fifth order in the
///   phase per sample (sixth without damping): at most 1e-4 of the ratio from
///   8 samples a cycle, 1e-6 from 20.
/// - `frequency_hz`: of the oscillation, to within a quarter, in hertz. It
///   selects the extrema: each is the largest or smallest sample within a quarter of a cycle
///   and follows the one before it after 0.3 to 0.7 of a cycle. The first that does not, or a
///   height below `1e-4` of the first, ends the series.
///
/// `None` for fewer than 8 samples a cycle, fewer than four extrema, and
/// samples or arguments that are not finite. Limiting case: zero without damping.
///
/// Source: D. J. Inman, *Engineering Vibration*, 4th ed., Pearson 2014, sec. 1.6.
///
/// ```
/// use asperity_signal::logarithmic_decrement;
///
/// let (rate, frequency, damping) = (1e4, 100.0, 0.02_f64);
/// let sigma = std::f64::consts::TAU * frequency * damping / (1.0 - damping * damping).sqrt();
/// let decay: Vec<f64> = (0..2000)
///     .map(|n| n as f64 / rate)
///     .map(|t| (-sigma * t).exp() * (std::f64::consts::TAU * frequency * t).cos())
///     .collect();
/// let found = logarithmic_decrement(&decay, rate, frequency).ok_or("a decay has a decrement")?;
/// assert!((found.ratio - damping).abs() < 1e-5);
/// assert!((found.frequency_hz - frequency).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn logarithmic_decrement(
    samples: &[f64],
    sample_rate_hz: f64,
    frequency_hz: f64,
) -> Option<LogarithmicDecrement> {
    decrement_of(samples, sample_rate_hz, frequency_hz).map(|(found, _)| found)
}

/// [`logarithmic_decrement`] and its extrema: their times in seconds, and the derivatives of the
/// damping ratio with respect to their values.
pub(crate) fn decrement_of(
    samples: &[f64],
    sample_rate_hz: f64,
    frequency_hz: f64,
) -> Option<(LogarithmicDecrement, Vec<(f64, f64)>)> {
    let per_cycle = sample_rate_hz / frequency_hz;
    let valid = per_cycle.is_finite() && per_cycle >= 8.0 && frequency_hz > 0.0;
    // All samples whatever the first is, which compiles to vectors.
    if !valid || !samples.iter().fold(true, |all, sample| all & sample.is_finite()) {
        return None;
    }
    let extrema = alternating_extrema(samples, per_cycle);
    let heights = extrema.windows(2).map(|pair| (pair[0].value - pair[1].value).abs().ln());
    let heights: Vec<f64> = heights.collect();
    if heights.len() < FEWEST {
        return None;
    }
    let (slope, scatter) = fitted_line(&heights);
    let decrement = -2.0 * slope;
    let times: Vec<f64> = extrema.iter().map(|extremum| extremum.time).collect();
    let (half_cycle, _) = fitted_line(&times);
    let square = 4.0 * PI * PI + decrement * decrement;
    // The slope of a line is the sum of (k - c) y_k over that of (k - c)^2.
    let count = heights.len() as f64;
    let squares = count * (count * count - 1.0) / 12.0;
    let factor = -2.0 * 4.0 * PI * PI / (square * square.sqrt() * squares);
    let mut derivatives: Vec<(f64, f64)> =
        times.iter().map(|time| (time / sample_rate_hz, 0.0)).collect();
    for k in 0..heights.len() {
        let weight = factor * (k as f64 - 0.5 * (count - 1.0));
        let change = weight / (extrema[k].value - extrema[k + 1].value);
        derivatives[k].1 += change;
        derivatives[k + 1].1 -= change;
    }
    let found = LogarithmicDecrement {
        ratio: decrement / square.sqrt(),
        decrement,
        frequency_hz: 0.5 * sample_rate_hz / half_cycle,
        cycles: 0.5 * (heights.len() - 1) as f64,
        scatter,
    };
    Some((found, derivatives))
}

/// A refined maximum or minimum; the time counts samples.
struct Extremum {
    time: f64,
    value: f64,
    is_maximum: bool,
}

/// Extrema that follow each other half a cycle apart, from a quarter of a cycle on and down to the
/// floor.
fn alternating_extrema(samples: &[f64], per_cycle: f64) -> Vec<Extremum> {
    // At least two, with eight samples a cycle.
    let quarter = (0.25 * per_cycle) as usize;
    // Closer samples of a faster ripple, or of noise, may have no vertex.
    let stride = ((per_cycle / SAMPLES_A_CYCLE) as usize).max(1);
    let first = 0.25 * per_cycle;
    let mut extrema: Vec<Extremum> = Vec::new();
    let mut floor = f64::MIN_POSITIVE;
    for n in quarter..samples.len().saturating_sub(quarter) {
        let Some(extremum) = extremum_at(samples, n, quarter, stride) else {
            continue;
        };
        // By its time, so that the first one does not depend on the sample rate.
        if extremum.time < first {
            continue;
        }
        if let Some(last) = extrema.last() {
            let spacing = (extremum.time - last.time) / per_cycle;
            let follows = last.is_maximum != extremum.is_maximum && (0.3..0.7).contains(&spacing);
            let height = (last.value - extremum.value).abs();
            if !(follows && height >= floor && height.is_finite()) {
                break;
            }
            if extrema.len() == 1 {
                floor = floor.max(FLOOR * height);
            }
        }
        extrema.push(extremum);
    }
    extrema
}

/// The extremum at sample `n`, if no sample within a quarter of a cycle exceeds it, refined by samples `stride` apart.
fn extremum_at(samples: &[f64], n: usize, quarter: usize, stride: usize) -> Option<Extremum> {
    let here = samples[n];
    let (before, after) = (samples[n - 1], samples[n + 1]);
    let is_maximum = here > before && here >= after;
    let is_minimum = here < before && here <= after;
    if !(is_maximum || is_minimum) {
        return None;
    }
    let inside = |x: &f64| if is_maximum { *x <= here } else { *x >= here };
    if !samples[n - quarter..=n + quarter].iter().all(inside) {
        return None;
    }
    let at = |k: usize| samples[n + k * stride - 2 * stride];
    let (shift, value) = quartic_vertex([at(0), at(1), here, at(3), at(4)])?;
    Some(Extremum { time: n as f64 + shift * stride as f64, value, is_maximum })
}
