//! Peaks of a receptance that is known at some frequencies only.
//!
//! Near a peak the receptance is a rational function of the frequency: of one pole with a residual, of two, or of
//! three, with complex coefficients,
//!
//! ```text
//! H(f) = (n0 + n1 x + ... + nk x^k) / (1 + d1 x + ... + dk x^k),    x = (f - f0) / span,
//! ```
//!
//! fitted to the complex lines by linear least squares with the denominator before as weight, repeated until it
//! stays. An oscillator has two poles in `f`; two modes have four, of which the two at negative frequencies are
//! far. Source: C. K. Sanathanan and J. Koerner, *IEEE Trans. Autom. Control* 8, 56 (1963).

use num_complex::Complex64;

use crate::fit::{least_squares, pseudo_inverse};
use crate::frf::Frf;

/// Magnitude down to which the lines about a peak count, over the highest, and the fewest lines where there are
/// more.
const LEAST_SHARE: f64 = 0.4;
const FEWEST_LINES: usize = 9;

/// Repetitions at most, and the relative change of the denominator at which they end.
const MOST_REPETITIONS: usize = 30;
const SETTLED: f64 = 1e-13;

/// Largest magnitude of a peak between lines over the magnitude of the highest line: lines a half-power width apart have
/// the square root of two.
const MOST_RISE: f64 = 1.5;

/// Points of a search for the maximum between two lines.
const POINTS: usize = 8;

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
    /// Standard deviation of the frequency due to noise and to the form of the function, in hertz.
    pub frequency_deviation_hz: f64,
    /// Standard deviation of the magnitude, in the unit of the function.
    pub magnitude_deviation: f64,
}

impl SampledPeak {
    /// The highest peak of `|H|` between two frequencies; none where the magnitude only rises towards an end of
    /// the band, where no local maximum stands out, or with fewer than three lines.
    ///
    /// - `receptance`: at rising frequencies, in any unit; lines that are not finite do not count.
    /// - `deviation`: standard deviation of the real and of the imaginary part at each line, independent of each
    ///   other; those beyond its end are zero. Without any, it is that of the residuals.
    /// - `band_hz`: ends of the search.
    ///
    /// Of functions with one, two and three poles the one counts whose standard deviation is least: of the noise,
    /// and of what a pole more changes beyond the noise.
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
                value: receptance.values[at],
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
        let (highest, near) = (lines[top], around(&lines, top));
        let scale = Scale::of(near, highest);
        let fits = [scale.peak::<6>(near), scale.peak::<10>(near), scale.peak::<14>(near)];
        // Data that fewer poles describe exactly leave the next without a solution.
        let is_exact = |poles: usize| near.len() > 2 * poles + 3;
        let total = |own: &Self, at: usize| {
            let other = match fits.get(at + 1) {
                Some(Some(next)) => *next,
                Some(None) if is_exact(at + 1) => *own,
                _ => fits[..at].iter().rev().flatten().next().copied().unwrap_or(Self {
                    frequency_hz: highest.frequency,
                    magnitude: highest.magnitude,
                    frequency_deviation_hz: 0.0,
                    magnitude_deviation: 0.0,
                }),
            };
            let sum = |noise: f64, change: f64, of_other: f64| {
                noise.hypot((change.powi(2) - of_other.powi(2)).max(0.0).sqrt())
            };
            Self {
                frequency_deviation_hz: sum(
                    own.frequency_deviation_hz,
                    own.frequency_hz - other.frequency_hz,
                    other.frequency_deviation_hz,
                ),
                magnitude_deviation: sum(
                    own.magnitude_deviation,
                    own.magnitude - other.magnitude,
                    other.magnitude_deviation,
                ),
                ..*own
            }
        };
        let all = fits.iter().enumerate().filter_map(|(at, fit)| Some(total(fit.as_ref()?, at)));
        all.min_by(|a, b| a.frequency_deviation_hz.total_cmp(&b.frequency_deviation_hz))
    }
}

/// A line of a receptance.
#[derive(Debug, Clone, Copy)]
struct Line {
    frequency: f64,
    value: Complex64,
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

/// The lines around the highest one that belong to its peak, and more where they are few.
fn around(lines: &[Line], top: usize) -> &[Line] {
    let highest = lines[top].magnitude;
    let is_of_peak = |line: &&Line| {
        (LEAST_SHARE * highest..=highest).contains(&line.magnitude)
            || (line.magnitude - highest * LEAST_SHARE).abs() < 2.0 * line.deviation
    };
    let before = lines[..top].iter().rev().take_while(is_of_peak).count();
    let after = lines[top + 1..].iter().take_while(is_of_peak).count();
    let (mut start, mut end) = (top - before.max(1), (top + 1 + after).max(top + 2));
    while end - start < FEWEST_LINES && (start > 0 || end < lines.len()) {
        start = start.saturating_sub(1);
        end = (end + 1).min(lines.len());
    }
    &lines[start..end]
}

/// The scaled coordinates of lines: frequencies about the highest line's, values over its magnitude.
struct Scale {
    middle: f64,
    span: f64,
    unit: f64,
    /// True if every line has a standard deviation.
    is_known: bool,
}

impl Scale {
    fn of(lines: &[Line], highest: Line) -> Self {
        let distance = |line: &Line| (line.frequency - highest.frequency).abs();
        Self {
            middle: highest.frequency,
            span: lines.iter().map(distance).fold(0.0, f64::max),
            unit: highest.magnitude,
            is_known: lines.iter().all(|line| line.deviation > 0.0),
        }
    }

    fn place(&self, line: &Line) -> f64 {
        (line.frequency - self.middle) / self.span
    }

    /// The peak of the function with `N` real coefficients, with the standard deviation by the noise alone; none
    /// for too few lines, without a solution, or without a maximum between the lines.
    fn peak<const N: usize>(&self, lines: &[Line]) -> Option<SampledPeak> {
        if 2 * lines.len() < N {
            return None;
        }
        let mut weights: Vec<f64> = lines.iter().map(|line| line.magnitude / self.unit).collect();
        let mut found = [0.0; N];
        for _ in 0..MOST_REPETITIONS {
            let before = found;
            found = least_squares(self.rows::<N>(lines, &weights).into_iter())?;
            let function = Rational::of(&found);
            for (weight, line) in weights.iter_mut().zip(lines) {
                *weight = function.denominator(self.place(line)).norm().recip();
            }
            let change = found.iter().zip(&before).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            let size = found.iter().map(|a| a.abs()).fold(0.0, f64::max);
            if change <= SETTLED * size {
                break;
            }
        }
        let ends = [lines.first()?, lines.last()?].map(|line| self.place(line));
        let function = Rational::of(&found);
        let steps = POINTS * (lines.len() - 1);
        let at = |k: usize| ends[0] + (ends[1] - ends[0]) * k as f64 / steps as f64;
        let magnitude = |k: usize| function.value(at(k)).norm();
        let top = (1..steps).max_by(|a, b| magnitude(*a).total_cmp(&magnitude(*b)))?;
        let place = function.maximum(at(top)).filter(|x| (ends[0]..=ends[1]).contains(x))?;
        let height = function.value(place).norm();
        if height > MOST_RISE {
            return None;
        }
        // Changes of place and height with each row, of which each has the standard deviation one.
        let rows = self.rows::<N>(lines, &weights);
        let misfit: f64 = rows
            .iter()
            .map(|(row, right)| {
                (row.iter().zip(&found).map(|(a, x)| a * x).sum::<f64>() - right).powi(2)
            })
            .sum();
        let freedom = rows.len() - N;
        let factor = if freedom > 0 { misfit / freedom as f64 } else { 0.0 };
        // As given, or more where the residuals are larger.
        let variance = if self.is_known { factor.max(1.0) } else { factor };
        let largest = found.iter().map(|x| x.abs()).fold(0.0, f64::max);
        let mut slopes = [[0.0; 2]; N];
        for (j, slope) in slopes.iter_mut().enumerate() {
            let step = 1e-6 * largest;
            let moved = |sign: f64| {
                let mut found = found;
                found[j] += sign * step;
                let function = Rational::of(&found);
                let place = function.maximum(place)?;
                Some([place, function.value(place).norm()])
            };
            let (high, low) = (moved(1.0)?, moved(-1.0)?);
            *slope = [0, 1].map(|k| (high[k] - low[k]) / (2.0 * step));
        }
        let rows: Vec<[f64; N]> = rows.into_iter().map(|(row, _)| row).collect();
        let mut squares = [0.0; 2];
        for column in pseudo_inverse(&rows)? {
            for (k, square) in squares.iter_mut().enumerate() {
                let change: f64 = column.iter().zip(&slopes).map(|(c, slope)| c * slope[k]).sum();
                *square += change * change;
            }
        }
        Some(SampledPeak {
            frequency_hz: self.middle + self.span * place,
            magnitude: self.unit * height,
            frequency_deviation_hz: self.span * (variance * squares[0]).sqrt(),
            magnitude_deviation: self.unit * (variance * squares[1]).sqrt(),
        })
    }

    /// Rows of the least squares `N(x) - H (D(x) - 1) = H`, real and imaginary parts, by weight and standard
    /// deviation.
    fn rows<const N: usize>(&self, lines: &[Line], weights: &[f64]) -> Vec<([f64; N], f64)> {
        let poles = (N / 2 - 1) / 2;
        let mut rows = Vec::with_capacity(2 * lines.len());
        for (line, weight) in lines.iter().zip(weights) {
            let deviation = if self.is_known { line.deviation / self.unit } else { 1.0 };
            let (x, value, weight) = (self.place(line), line.value / self.unit, weight / deviation);
            let (mut real, mut imaginary) = ([0.0; N], [0.0; N]);
            let mut powers = [1.0; N];
            (1..N).for_each(|j| powers[j] = x * powers[j - 1]);
            for j in 0..N / 2 {
                let entry = if j <= poles {
                    Complex64::from(powers[j])
                } else {
                    -value * powers[j - poles]
                };
                (real[2 * j], real[2 * j + 1]) = (weight * entry.re, -weight * entry.im);
                (imaginary[2 * j], imaginary[2 * j + 1]) = (weight * entry.im, weight * entry.re);
            }
            rows.push((real, weight * value.re));
            rows.push((imaginary, weight * value.im));
        }
        rows
    }
}

/// A rational function of a real argument.
struct Rational {
    above: Vec<Complex64>,
    below: Vec<Complex64>,
}

impl Rational {
    /// The function of the real and imaginary parts of its coefficients, the numerator's first; the constant of
    /// the denominator is one.
    fn of(parts: &[f64]) -> Self {
        let all: Vec<Complex64> =
            parts.chunks_exact(2).map(|pair| Complex64::new(pair[0], pair[1])).collect();
        let (above, below) = all.split_at(all.len() / 2 + 1);
        let below = std::iter::once(Complex64::ONE).chain(below.iter().copied()).collect();
        Self { above: above.to_vec(), below }
    }

    fn value(&self, x: f64) -> Complex64 {
        polynomial(&self.above, x)[0] / polynomial(&self.below, x)[0]
    }

    fn denominator(&self, x: f64) -> Complex64 {
        polynomial(&self.below, x)[0]
    }

    /// The maximum of the magnitude near a place, by Newton's method on the derivative of its logarithm.
    fn maximum(&self, near: f64) -> Option<f64> {
        let mut x = near;
        for _ in 0..50 {
            let [above, below] = [&self.above, &self.below].map(|coefficients| {
                let [value, first, second] = polynomial(coefficients, x);
                let slope = first / value;
                (slope, second / value - slope * slope)
            });
            let (slope, bend) = ((above.0 - below.0).re, (above.1 - below.1).re);
            let step = -slope / bend;
            if bend >= 0.0 || !step.is_finite() {
                return None;
            }
            x += step;
            if step.abs() <= 1e-14 {
                break;
            }
        }
        Some(x)
    }
}

/// A polynomial and its first two derivatives.
fn polynomial(coefficients: &[Complex64], x: f64) -> [Complex64; 3] {
    let [mut value, mut first, mut second] = [Complex64::ZERO; 3];
    for coefficient in coefficients.iter().rev() {
        second = second * x + 2.0 * first;
        first = first * x + value;
        value = value * x + coefficient;
    }
    [value, first, second]
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

    /// Nearly normal numbers: sums of twelve uniform ones.
    fn normal() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            (0..12)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (state >> 11) as f64 / (1_u64 << 53) as f64
                })
                .sum::<f64>()
                - 6.0
        }
    }

    /// Two modes 60 Hz apart, of which the higher one leans on the lower, with the compliance of others.
    fn two_modes(f: f64) -> Complex64 {
        let mode = |natural: f64, ratio: f64, share: f64| {
            let r = f / natural;
            share * Complex64::new(1.0 - r * r, 2.0 * ratio * r).inv()
        };
        mode(850.0, 0.03, 1.0) + mode(910.0, 0.02, 0.45) + 0.3
    }

    #[test]
    fn a_peak_beside_another_is_found_within_its_deviation() {
        let magnitude = |f: f64| two_modes(f).norm();
        // Golden section.
        let (mut low, mut high) = (895.0, 925.0);
        while high - low > 1e-9 {
            let part = 0.381_966_011_250_105 * (high - low);
            if magnitude(low + part) > magnitude(high - part) {
                high -= part;
            } else {
                low += part;
            }
        }
        let exact = [0.5 * (low + high), magnitude(0.5 * (low + high))];
        let sampled = |step: f64, noise: &mut dyn FnMut() -> Complex64| {
            let frequency_hz: Vec<f64> =
                (0..(500.0 / step) as u32).map(|n| 650.0 + step * f64::from(n)).collect();
            let values = frequency_hz.iter().map(|f| two_modes(*f) + noise()).collect();
            Frf { frequency_hz, values, form: FrfForm::Receptance }
        };
        for step in [1.0, 4.0, 10.0] {
            let found = sampled(step, &mut || Complex64::ZERO);
            let peak = SampledPeak::of(&found, &[], (880.0, 960.0)).unwrap();
            let off = [peak.frequency_hz - exact[0], peak.magnitude - exact[1]];
            assert!(off[0].abs() < 1e-2 && off[1].abs() < 1e-3 * exact[1], "{step}: {off:?}");
            assert!(off[0].abs() <= 2.0 * peak.frequency_deviation_hz + 1e-9, "{step}: {peak:?}");
        }
        let mut normal = normal();
        for (sigma, step) in [(0.03, 2.0), (0.1, 2.0), (0.1, 5.0)] {
            let mut sums = [0.0; 2];
            for _ in 0..200 {
                let found = sampled(step, &mut || sigma * Complex64::new(normal(), normal()));
                let deviation = vec![sigma; found.len()];
                let peak = SampledPeak::of(&found, &deviation, (880.0, 960.0)).unwrap();
                sums[0] += ((peak.frequency_hz - exact[0]) / peak.frequency_deviation_hz).powi(2);
                sums[1] += ((peak.magnitude - exact[1]) / peak.magnitude_deviation).powi(2);
            }
            // Bias included.
            for sum in sums {
                let ratio = (sum / 200.0).sqrt();
                assert!((0.5..1.6).contains(&ratio), "{sigma} {step}: {ratio}");
            }
        }
    }

    #[test]
    fn deviations_are_those_of_many_draws() {
        let sigma = 0.05;
        let mut normal = normal();
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
