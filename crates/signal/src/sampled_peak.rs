//! Peaks of a receptance that is known at some frequencies only.
//!
//! The receptance of an oscillator has
//!
//! ```text
//! 1 / |H|^2 = (k - m w^2)^2 + (c w)^2 = a0 + a1 x + a2 x^2,    x = f^2,
//! ```
//!
//! so that its peak is the vertex of a parabola through three lines or more, whatever their spacing. Of other
//! receptances the lines near the top count.

use std::ops::Range;

use crate::fit::least_squares;
use crate::frf::Frf;

/// Fall of `|H|^2` down to which the lines of a peak count, over that of the highest one: at least, over the
/// relative deviation, and at most. The neighbours of the highest line count in any case.
const FALL: f64 = 0.05;
const NOISE: f64 = 30.0;
const MOST_FALL: f64 = 0.6;

/// Least height of a peak above the higher minimum beside it, over its magnitude, and in standard deviations
/// of a line.
const PROMINENCE: f64 = 1e-3;
const DEVIATIONS: f64 = 4.0;

/// A peak of a sampled receptance with its standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampledPeak {
    /// Frequency, in hertz.
    pub frequency_hz: f64,
    /// Magnitude, in the unit of the function.
    pub magnitude: f64,
    /// Standard deviation of the frequency due to noise and to the distance of the lines, in hertz.
    pub frequency_deviation_hz: f64,
    /// Standard deviation of the magnitude, in the unit of the function.
    pub magnitude_deviation: f64,
}

impl SampledPeak {
    /// The highest peak of `|H|` between two frequencies; none where the magnitude only rises towards an end of
    /// the band, where no local maximum stands out, or with fewer than three lines.
    ///
    /// - `receptance`: at rising frequencies, in any unit; lines that are not finite do not count.
    /// - `deviation`: standard deviation of `|H|` at each line, independent of each other; those beyond its end
    ///   are zero.
    /// - `band_hz`: ends of the search.
    ///
    /// Limiting case: an oscillator without noise is found to rounding, on lines of any spacing up to its
    /// half-power width.
    ///
    /// ```
    /// use asperity_signal::{Complex64, Frf, FrfForm, SampledPeak};
    ///
    /// // 1 kg at 100 Hz with 2 % of critical damping, at every second hertz.
    /// let (natural, ratio) = (100.0_f64, 0.02_f64);
    /// let frequency_hz: Vec<f64> = (30..70).map(|n| 2.0 * f64::from(n)).collect();
    /// let w0 = std::f64::consts::TAU * natural;
    /// let value = |f: &f64| {
    ///     let r = f / natural;
    ///     (w0 * w0 * Complex64::new(1.0 - r * r, 2.0 * ratio * r)).inv()
    /// };
    /// let values = frequency_hz.iter().map(value).collect();
    /// let receptance = Frf { frequency_hz, values, form: FrfForm::Receptance };
    /// let peak = SampledPeak::of(&receptance, &[], (80.0, 120.0)).ok_or("a peak")?;
    /// let frequency = natural * (1.0 - 2.0 * ratio * ratio).sqrt();
    /// assert!((peak.frequency_hz - frequency).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(receptance: &Frf, deviation: &[f64], band_hz: (f64, f64)) -> Option<Self> {
        let lines: Vec<Line> = (0..receptance.len())
            .map(|at| Line {
                frequency: receptance.frequency_hz[at],
                magnitude: receptance.values[at].norm(),
                deviation: deviation.get(at).copied().unwrap_or(0.0),
            })
            .filter(|line| {
                (band_hz.0..=band_hz.1).contains(&line.frequency)
                    && line.magnitude.is_finite()
                    && line.magnitude > 0.0
            })
            .collect();
        let top = highest(&lines)?;
        let middle = lines[top].frequency;
        // Lines that fall by much less than their noise tell nothing of the curvature.
        let noise = NOISE * lines[top].deviation / lines[top].magnitude;
        let falls = std::iter::successors(Some(noise.max(FALL)), |fall| Some(2.0 * fall));
        let (range, (frequency_hz, magnitude)) =
            falls.take_while(|fall| *fall < MOST_FALL).find_map(|fall| {
                let range = around(&lines, top, fall);
                Some((range.clone(), vertex(&lines[range], middle)?))
            })?;
        let near = &lines[range.clone()];
        // What a line more on each side changes is the error of the parabola, where it exceeds the noise.
        let wider = range.start.saturating_sub(1)..(range.end + 1).min(lines.len());
        let wider = vertex(&lines[wider], middle).unwrap_or((frequency_hz, magnitude));
        // The vertex depends on each line: by central differences of half a standard deviation.
        let (mut frequency_square, mut magnitude_square) = (0.0, 0.0);
        let mut varied = near.to_vec();
        for at in (0..near.len()).filter(|at| near[*at].deviation > 0.0) {
            // Linear: of large deviations a part.
            let step = near[at].deviation.min(0.01 * near[at].magnitude);
            let mut moved = |sign: f64| {
                varied[at].magnitude = near[at].magnitude + sign * step;
                let found = vertex(&varied, middle);
                varied[at].magnitude = near[at].magnitude;
                found
            };
            let (high, low) = (moved(1.0)?, moved(-1.0)?);
            let scale = near[at].deviation / (2.0 * step);
            frequency_square += (scale * (high.0 - low.0)).powi(2);
            magnitude_square += (scale * (high.1 - low.1)).powi(2);
        }
        let deviation = |noise: f64, change: f64| {
            if change.abs() > 2.0 * noise { noise.hypot(change) } else { noise }
        };
        Some(Self {
            frequency_hz,
            magnitude,
            frequency_deviation_hz: deviation(frequency_square.sqrt(), wider.0 - frequency_hz),
            magnitude_deviation: deviation(magnitude_square.sqrt(), wider.1 - magnitude),
        })
    }
}

/// A line of a receptance.
#[derive(Debug, Clone, Copy)]
struct Line {
    frequency: f64,
    magnitude: f64,
    deviation: f64,
}

/// Place of the highest local maximum that stands out of the minima beside it and of the noise.
fn highest(lines: &[Line]) -> Option<usize> {
    let magnitude = |at: usize| lines[at].magnitude;
    let stands_out = |at: &usize| {
        // Down to the lowest line on each side, before a higher one.
        let lowest = |side: &mut dyn Iterator<Item = &Line>| {
            let lower = side.take_while(|line| line.magnitude <= magnitude(*at));
            lower.map(|line| line.magnitude).fold(f64::INFINITY, f64::min)
        };
        let left = lowest(&mut lines[..*at].iter().rev());
        let right = lowest(&mut lines[at + 1..].iter());
        let height = magnitude(*at) - left.max(right);
        height > (PROMINENCE * magnitude(*at)).max(DEVIATIONS * lines[*at].deviation)
    };
    let inner = 1..lines.len().saturating_sub(1);
    inner
        .filter(|&at| magnitude(at) >= magnitude(at - 1) && magnitude(at) > magnitude(at + 1))
        .filter(stands_out)
        .max_by(|a, b| magnitude(*a).total_cmp(&magnitude(*b)))
}

/// The lines around the highest one down to a `fall` of `|H|^2`, within their noise.
fn around(lines: &[Line], top: usize, fall: f64) -> Range<usize> {
    let least = (1.0 - fall).sqrt() * lines[top].magnitude;
    let is_near = |line: &Line| line.magnitude + 2.0 * line.deviation >= least;
    let before = lines[..top - 1].iter().rev().take_while(|line| is_near(line)).count();
    let after = lines[top + 2..].iter().take_while(|line| is_near(line)).count();
    top - 1 - before..top + 2 + after
}

/// Frequency and magnitude at the least of the parabola in `f^2` through `1 / |H|^2`, each line by its weight.
fn vertex(lines: &[Line], middle: f64) -> Option<(f64, f64)> {
    let unit = lines.iter().map(|line| line.magnitude).fold(0.0, f64::max);
    let known = lines.iter().all(|line| line.deviation > 0.0);
    let span = lines.iter().map(|line| (line.frequency.powi(2) - middle * middle).abs());
    let span = span.fold(0.0, f64::max);
    let row = |line: &Line| {
        let x = (line.frequency.powi(2) - middle * middle) / span;
        let y = (unit / line.magnitude).powi(2);
        // The deviation of y is 2 y s / |H|.
        let relative = if known { line.deviation / line.magnitude } else { 1.0 };
        let weight = 1.0 / (2.0 * y * relative);
        ([weight, weight * x, weight * x * x], weight * y)
    };
    let [a0, a1, a2] = least_squares(lines.iter().map(row))?;
    let x = -0.5 * a1 / a2;
    let least = a0 + 0.5 * a1 * x;
    let square = middle * middle + span * x;
    (a2 > 0.0 && least > 0.0 && x.abs() <= 1.0).then(|| (square.sqrt(), unit / least.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::FrfForm;
    use num_complex::Complex64;

    fn oscillator(step: f64, noise: impl Fn(usize) -> Complex64) -> Frf {
        let (natural, ratio) = (873.0, 0.035);
        let frequency_hz: Vec<f64> =
            (0..(700.0 / step) as u32).map(|n| 500.0 + step * f64::from(n)).collect();
        let value = |(at, f): (usize, &f64)| {
            let r = f / natural;
            Complex64::new(1.0 - r * r, 2.0 * ratio * r).inv() + noise(at)
        };
        let values = frequency_hz.iter().enumerate().map(value).collect();
        Frf { frequency_hz, values, form: FrfForm::Receptance }
    }

    #[test]
    fn an_oscillator_on_coarse_lines_is_found_to_rounding() {
        let ratio: f64 = 0.035;
        let frequency = 873.0 * (1.0 - 2.0 * ratio * ratio).sqrt();
        let magnitude = 0.5 / (ratio * (1.0 - ratio * ratio).sqrt());
        for step in [1.0, 7.3, 25.0, 50.0] {
            let found = oscillator(step, |_| Complex64::ZERO);
            let peak = SampledPeak::of(&found, &[], (600.0, 1100.0)).unwrap();
            assert!((peak.frequency_hz - frequency).abs() < 1e-7, "{step}: {peak:?}");
            assert!((peak.magnitude / magnitude - 1.0).abs() < 1e-9, "{step}: {peak:?}");
            assert!(peak.frequency_deviation_hz < 1e-6, "{step}: {peak:?}");
        }
        // Towards the end of a band without its maximum the magnitude only rises.
        let found = oscillator(5.0, |_| Complex64::ZERO);
        assert_eq!(SampledPeak::of(&found, &[], (600.0, 850.0)), None);
        assert_eq!(SampledPeak::of(&found, &[], (871.0, 876.0)), None);
    }

    #[test]
    fn deviations_are_those_of_many_draws() {
        let sigma = 0.05;
        let mut state = 1_u64;
        // Sums of twelve uniform numbers are nearly normal.
        let mut normal = move || {
            (0..12)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (state >> 11) as f64 / (1_u64 << 53) as f64
                })
                .sum::<f64>()
                - 6.0
        };
        let (mut frequencies, mut magnitudes, mut stated) = (Vec::new(), Vec::new(), [0.0; 2]);
        for _ in 0..400 {
            let noise: Vec<Complex64> =
                (0..300).map(|_| sigma * Complex64::new(normal(), normal())).collect();
            let found = oscillator(4.0, |at| noise[at]);
            let deviation = vec![sigma; found.len()];
            let peak = SampledPeak::of(&found, &deviation, (700.0, 1000.0)).unwrap();
            frequencies.push(peak.frequency_hz);
            magnitudes.push(peak.magnitude);
            stated[0] += peak.frequency_deviation_hz / 400.0;
            stated[1] += peak.magnitude_deviation / 400.0;
        }
        let spread = |values: &[f64]| {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
        };
        for (found, stated) in [spread(&frequencies), spread(&magnitudes)].into_iter().zip(stated) {
            assert!((0.6..1.7).contains(&(found / stated)), "{found} {stated}");
        }
    }
}
