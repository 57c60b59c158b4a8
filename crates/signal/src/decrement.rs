//! Damping from a free decay.

use std::f64::consts::PI;

/// The logarithmic decrement of a free decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogarithmicDecrement {
    /// Damping ratio, `delta / sqrt(4 pi^2 + delta^2)`; negative for a growing oscillation.
    pub ratio: f64,
    /// Logarithmic decrement `delta`: the loss of `ln` amplitude per cycle.
    pub decrement: f64,
    /// Frequency of the decay (the damped natural frequency), in hertz.
    pub frequency_hz: f64,
    /// Cycles over which the line was fitted.
    pub cycles: f64,
    /// Root mean square distance of the `ln` amplitudes from the line.
    pub scatter: f64,
}

/// Peak-to-peak heights below this fraction of the first are left out.
const FLOOR: f64 = 1e-4;
/// Fewest heights to fit a line to and know its scatter.
const FEWEST: usize = 3;

/// Damping of a free decay from its successive maxima and minima.
///
/// ```text
/// u(t) = c + a exp(-zeta w t) cos(w sqrt(1 - zeta^2) t + phi)
/// ln |u_k - u_{k+1}| = const - k delta / 2,   zeta = delta / sqrt(4 pi^2 + delta^2)
/// ```
///
/// with `u_k` the alternating extrema, refined by a parabola through three
/// samples. Their differences are free of the offset `c`; the line is least
/// squares over all of them.
///
/// - `samples`: a decay without force from the first sample on, any unit.
/// - `sample_rate_hz`: in hertz; the parabola's error is third order in the
///   phase per sample (fourth without damping), 1e-4 of the ratio or less from
///   50 samples a cycle.
/// - `frequency_hz`: of the oscillation, within a quarter, in hertz. It only
///   says which extrema belong to it: those that dominate a quarter of a cycle
///   on either side and follow each other after 0.3 to 0.7 of one. The count
///   ends at the first that does not, or at `1e-4` of the first height.
///
/// `None` for fewer than 8 samples a cycle, for fewer than four extrema, and
/// for samples or arguments that are not finite.
///
/// Source: D. J. Inman, *Engineering Vibration*, sec. 1.6. The limiting case
/// of no damping gives zero.
pub fn logarithmic_decrement(
    samples: &[f64],
    sample_rate_hz: f64,
    frequency_hz: f64,
) -> Option<LogarithmicDecrement> {
    let per_cycle = sample_rate_hz / frequency_hz;
    let valid = per_cycle.is_finite() && per_cycle >= 8.0 && frequency_hz > 0.0;
    if !valid || samples.iter().any(|sample| !sample.is_finite()) {
        return None;
    }
    let extrema = alternating_extrema(samples, per_cycle);
    let heights = heights(&extrema);
    if heights.len() < FEWEST {
        return None;
    }
    let (slope, scatter) = fitted_line(&heights);
    let decrement = -2.0 * slope;
    let times: Vec<f64> = extrema[..=heights.len()].iter().map(|e| e.time).collect();
    let (half_cycle, _) = fitted_line(&times);
    Some(LogarithmicDecrement {
        ratio: decrement / (4.0 * PI * PI + decrement * decrement).sqrt(),
        decrement,
        frequency_hz: 0.5 * sample_rate_hz / half_cycle,
        cycles: 0.5 * (heights.len() - 1) as f64,
        scatter,
    })
}

/// A refined maximum or minimum; the time counts samples.
struct Extremum {
    time: f64,
    value: f64,
    is_maximum: bool,
}

/// Extrema that follow each other half a cycle apart, from the first sample on.
fn alternating_extrema(samples: &[f64], per_cycle: f64) -> Vec<Extremum> {
    let quarter = ((0.25 * per_cycle) as usize).max(1);
    let mut extrema: Vec<Extremum> = Vec::new();
    for n in quarter..samples.len().saturating_sub(quarter) {
        let Some(extremum) = extremum_at(samples, n, quarter) else {
            continue;
        };
        if let Some(last) = extrema.last() {
            let spacing = (extremum.time - last.time) / per_cycle;
            let follows = last.is_maximum != extremum.is_maximum && (0.3..0.7).contains(&spacing);
            if !follows {
                break;
            }
        }
        extrema.push(extremum);
    }
    extrema
}

/// The extremum at sample `n`, if it dominates a quarter of a cycle on either side.
fn extremum_at(samples: &[f64], n: usize, quarter: usize) -> Option<Extremum> {
    let here = samples[n];
    let (before, after) = (samples[n - 1], samples[n + 1]);
    let is_maximum = here > before && here >= after;
    let is_minimum = here < before && here <= after;
    if !(is_maximum || is_minimum) {
        return None;
    }
    let dominated = |x: &f64| if is_maximum { *x <= here } else { *x >= here };
    if !samples[n - quarter..=n + quarter].iter().all(dominated) {
        return None;
    }
    // Vertex of the parabola through three samples; the curvature is not zero.
    let slope = 0.5 * (after - before);
    let curvature = (after - here) - (here - before);
    let shift = -slope / curvature;
    Some(Extremum { time: n as f64 + shift, value: here + 0.5 * slope * shift, is_maximum })
}

/// `ln |u_k - u_{k+1}|` down to the floor.
fn heights(extrema: &[Extremum]) -> Vec<f64> {
    let heights = extrema.windows(2).map(|pair| (pair[0].value - pair[1].value).abs());
    let mut kept = Vec::new();
    let mut floor = f64::MIN_POSITIVE;
    for height in heights {
        if !(height >= floor && height.is_finite()) {
            break;
        }
        if kept.is_empty() {
            floor = floor.max(FLOOR * height);
        }
        kept.push(height.ln());
    }
    kept
}

/// Slope and root mean square residual of the least-squares line through `(k, y_k)`.
fn fitted_line(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let centre = 0.5 * (count - 1.0);
    let mean = values.iter().sum::<f64>() / count;
    let (mut cross, mut square) = (0.0, 0.0);
    for (k, value) in values.iter().enumerate() {
        let x = k as f64 - centre;
        cross += x * (value - mean);
        square += x * x;
    }
    let slope = cross / square;
    let residual = |(k, value): (usize, &f64)| value - mean - slope * (k as f64 - centre);
    let sum: f64 = values.iter().enumerate().map(residual).map(|r| r * r).sum();
    (slope, (sum / count).sqrt())
}
