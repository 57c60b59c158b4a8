//! One mode that depends on its amplitude, or two linear modes, in the band of a decay.

use num_complex::Complex64;
use std::f64::consts::TAU;

use crate::complex_system::solve;
use crate::fit::orthogonal;

/// Samples over the width of the band.
const PER_WIDTH: f64 = 2.0;
/// Fewest samples.
const FEWEST: usize = 24;
/// Powers of the amplitude in phase and logarithm of the amplitude of one mode.
const POWERS: i32 = 3;
/// Misfit of one mode over the misfit of two from which there are two, and the largest misfit of two modes over
/// the signal.
const BETTER: f64 = 3.0;
const LARGEST_MISFIT: f64 = 0.05;
/// Least misfit of one mode over the signal, and over the noise, that is told from filter ringing.
const TOLD: (f64, f64) = (1e-3, 2.0);
/// Least distance of two modes, over the larger of their decay rates, and of two that leave no more than noise: a
/// mode whose frequency follows its amplitude `a` holds terms in `a^2` and `a^3` at its own frequency, with two
/// and three times its rate.
const APART: (f64, f64) = (1.0, 0.2);
/// Halvings of the span that are tried as the step of a recurrence, and steps of Newton's method.
const HALVINGS: std::ops::Range<i32> = 3..9;
const ITERATIONS: usize = 30;

/// One of two linear modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearMode {
    /// Frequency of the damped oscillation, in hertz.
    pub frequency_hz: f64,
    /// Its standard deviation due to noise, in hertz.
    pub frequency_uncertainty_hz: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Its standard deviation due to noise.
    pub damping_ratio_uncertainty: f64,
    /// Amplitude at the first line, over the amplitude of the stronger mode.
    pub amplitude_ratio: f64,
}

/// Two linear modes that explain a decay, the stronger first.
///
/// ```text
/// z(t) = c_1 exp(s_1 t) + c_2 exp(s_2 t),   s = -sigma + i w_d
/// ```
///
/// by least squares, from a recurrence of second order; their deviations are due to noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoModes {
    /// The modes.
    pub modes: [LinearMode; 2],
    /// Error of the local decay rates of the stronger mode due to the other, over its decay rate.
    pub decay_rate_error: f64,
}

/// Filtered decay, and what it is compared with.
pub(super) struct ModeSearch<'a> {
    /// Analytic signal of the displacement.
    pub(super) signal: &'a [Complex64],
    pub(super) sample_rate_hz: f64,
    /// Frequency about which the phase is slow, in hertz.
    pub(super) carrier_hz: f64,
    /// Width of the band, in hertz.
    pub(super) width_hz: f64,
    /// One-sided density of the noise of the samples.
    pub(super) noise_density: f64,
}

impl ModeSearch<'_> {
    /// Two modes, if they explain the signal and one mode does not: one whose frequency and decay rate are
    /// polynomials of its amplitude. If neither does, the part of the signal that one mode leaves.
    pub(super) fn two_modes(&self) -> (Option<TwoModes>, f64) {
        let rate = self.sample_rate_hz;
        let stride = (rate / (PER_WIDTH * self.width_hz)).floor().max(1.0) as usize;
        let step = stride as f64 / rate;
        let turn = |n: usize| Complex64::from_polar(1.0, -TAU * self.carrier_hz * step * n as f64);
        let values: Vec<Complex64> =
            self.signal.iter().step_by(stride).enumerate().map(|(n, z)| z * turn(n)).collect();
        if values.len() < FEWEST || values.iter().any(|value| value.norm() == 0.0) {
            return (None, 0.0);
        }
        let size = power(&values).sqrt();
        // Noise of the analytic signal in a sample.
        let noise = (2.0 * self.noise_density * self.width_hz.min(1.0 / step)).sqrt();
        let one = one_mode_misfit(&values);
        if one < (TOLD.0 * size).max(TOLD.1 * noise) {
            return (None, 0.0);
        }
        let fits = HALVINGS
            .filter_map(|halving| Exponentials::by_recurrence(&values, 1 << halving))
            .filter_map(|start| start.refined(&values));
        let two = fits.map(|fit| (fit.misfit(&values), fit)).min_by(|a, b| a.0.total_cmp(&b.0));
        let found = two.and_then(|(two, fit)| {
            let is_better = two * BETTER < one && two < LARGEST_MISFIT * size;
            let apart = if two < TOLD.1 * noise { APART.1 } else { APART.0 };
            let found = self.described(fit.strongest_first(), values.len(), step, apart);
            found.filter(|_| is_better)
        });
        (found, one / size)
    }

    fn described(
        &self,
        fit: Exponentials,
        count: usize,
        step: f64,
        least: f64,
    ) -> Option<TwoModes> {
        let [first, second] = fit.rates.map(|rate| rate / step);
        let rates = [-first.re, -second.re];
        let apart = (second.im - first.im).abs();
        let is_decay = rates[0] > 0.0 && rates[1] > 0.0;
        if !is_decay || apart < least * rates[0].max(rates[1]) {
            return None;
        }
        // White noise of the analytic signal in each sample.
        let variance = 2.0 * self.noise_density / step;
        let deviations = fit.rate_deviations(count)?.map(|one| one * variance.sqrt() / step);
        let strongest = fit.amplitudes[0].norm();
        let mode = |n: usize| {
            let omega = TAU * self.carrier_hz + [first, second][n].im;
            LinearMode {
                frequency_hz: omega / TAU,
                frequency_uncertainty_hz: deviations[n] / TAU,
                damping_ratio: rates[n] / rates[n].hypot(omega),
                damping_ratio_uncertainty: deviations[n] / omega,
                amplitude_ratio: fit.amplitudes[n].norm() / strongest,
            }
        };
        let modes = [mode(0), mode(1)];
        let decay_rate_error = apart * modes[1].amplitude_ratio / rates[0];
        Some(TwoModes { modes, decay_rate_error })
    }
}

fn power(values: &[Complex64]) -> f64 {
    values.iter().map(Complex64::norm_sqr).sum::<f64>() / values.len() as f64
}

/// Root mean square of what one mode leaves of a signal, with a line in time and powers of
/// `u = exp(-sigma t)` for its phase and the logarithm of its amplitude.
fn one_mode_misfit(values: &[Complex64]) -> f64 {
    let count = values.len();
    let quarter = count / 4;
    let [early, late] = [&values[..quarter], &values[count - quarter..]].map(power);
    // Between the middles of the first and the last quarter.
    let fall = 0.5 * (early / late).ln() / (count - quarter) as f64;
    let mut turned = 0.0;
    let mut before = f64::NAN;
    let logarithms = values.iter().map(|value| {
        let phase = value.arg() + turned;
        let change: f64 = phase - before;
        if change.is_finite() {
            turned -= TAU * (change / TAU).round();
        }
        before = value.arg() + turned;
        Complex64::new(value.norm().ln(), before)
    });
    let mut rest: Vec<Complex64> = logarithms.collect();
    let weights: Vec<f64> = values.iter().map(Complex64::norm_sqr).collect();
    let column = |degree: i32| -> Vec<f64> {
        let place = |n: usize| match degree {
            0 => 1.0,
            1 => n as f64 / count as f64,
            _ => (-fall * n as f64).exp().powi(degree - 1),
        };
        (0..count).map(place).collect()
    };
    for (own, square) in orthogonal((0..=POWERS + 1).map(column), &weights) {
        let products = rest.iter().zip(&own).zip(&weights).map(|((r, x), w)| r * (x * w));
        let share = products.sum::<Complex64>() / square;
        rest.iter_mut().zip(&own).for_each(|(r, x)| *r -= share * x);
    }
    let left = values.iter().zip(&rest).map(|(z, rest)| z - z * (-rest).exp());
    power(&left.collect::<Vec<_>>()).sqrt()
}

/// `sum_k c_k exp(s_k n)` over samples n.
#[derive(Debug, Clone, Copy)]
struct Exponentials {
    amplitudes: [Complex64; 2],
    rates: [Complex64; 2],
}

impl Exponentials {
    /// The roots of `y_(n+2) + a y_(n+1) + b y_n = 0`, which a sum of two exponentials obeys, over means of
    /// equal parts of the samples.
    fn by_recurrence(values: &[Complex64], parts: usize) -> Option<Self> {
        let length = values.len() / parts;
        if length == 0 {
            return None;
        }
        let means: Vec<Complex64> =
            values.chunks_exact(length).map(|part| part.iter().sum::<Complex64>()).collect();
        let mut rows = vec![Complex64::ZERO; 6];
        for three in means.windows(3) {
            let columns = [three[1], three[0], -three[2]];
            for (i, conjugate) in columns[..2].iter().map(Complex64::conj).enumerate() {
                for (j, value) in columns.iter().enumerate() {
                    rows[3 * i + j] += conjugate * value;
                }
            }
        }
        let [a, b] = solve(&mut rows)?[..] else { return None };
        let root = (0.25 * a * a - b).sqrt();
        let rates = [-0.5 * a + root, -0.5 * a - root].map(|root| root.ln() / length as f64);
        Self { amplitudes: [Complex64::ONE; 2], rates }.with_amplitudes(values)
    }

    fn terms(&self, n: usize) -> [Complex64; 2] {
        self.rates.map(|rate| (rate * n as f64).exp())
    }

    /// The amplitudes of least squares.
    fn with_amplitudes(self, values: &[Complex64]) -> Option<Self> {
        let mut rows = vec![Complex64::ZERO; 6];
        for (n, value) in values.iter().enumerate() {
            let [a, b] = self.terms(n);
            add(&mut rows, &[a, b], *value);
        }
        let [a, b] = solve(&mut rows)?[..] else { return None };
        Some(Self { amplitudes: [a, b], ..self })
    }

    /// Gauss-Newton's method: the model is analytic in its complex parameters.
    fn refined(self, values: &[Complex64]) -> Option<Self> {
        let mut best = self;
        let mut misfit = best.misfit(values);
        for _ in 0..ITERATIONS {
            let mut rows = vec![Complex64::ZERO; 20];
            for (n, value) in values.iter().enumerate() {
                let slopes = best.slopes(n);
                let rest = value - best.value(n);
                add(&mut rows, &slopes, rest);
            }
            let change = solve(&mut rows)?;
            let next = Self {
                amplitudes: best.amplitudes,
                rates: [best.rates[0] + change[2], best.rates[1] + change[3]],
            };
            let next = next.with_amplitudes(values)?;
            let left = next.misfit(values);
            let is_better = left < misfit * (1.0 - 1e-9);
            if is_better {
                (best, misfit) = (next, left);
            } else {
                break;
            }
        }
        misfit.is_finite().then_some(best)
    }

    fn value(&self, n: usize) -> Complex64 {
        let [a, b] = self.terms(n);
        a * self.amplitudes[0] + b * self.amplitudes[1]
    }

    /// Derivatives with respect to amplitudes and rates.
    fn slopes(&self, n: usize) -> [Complex64; 4] {
        let [a, b] = self.terms(n);
        let n = n as f64;
        [a, b, self.amplitudes[0] * a * n, self.amplitudes[1] * b * n]
    }

    fn misfit(&self, values: &[Complex64]) -> f64 {
        let left = values.iter().enumerate().map(|(n, value)| (value - self.value(n)).norm_sqr());
        (left.sum::<f64>() / values.len() as f64).sqrt()
    }

    /// Standard deviations of real and imaginary part of the rates for noise of variance 1 in each complex
    /// sample, by the inverse of the normal equations.
    fn rate_deviations(&self, count: usize) -> Option<[f64; 2]> {
        let mut rows = vec![Complex64::ZERO; 20];
        for n in 0..count {
            add(&mut rows, &self.slopes(n), Complex64::ZERO);
        }
        let variance = |place: usize| {
            let mut unit = rows.clone();
            unit[5 * place + 4] = Complex64::ONE;
            Some(solve(&mut unit)?[place].re)
        };
        // Half of the variance is that of the real part.
        Some([(0.5 * variance(2)?).sqrt(), (0.5 * variance(3)?).sqrt()])
    }

    fn strongest_first(self) -> Self {
        let Self { amplitudes: [a, b], rates: [r, s] } = self;
        if b.norm() > a.norm() { Self { amplitudes: [b, a], rates: [s, r] } } else { self }
    }
}

/// Adds the products of an observation to normal equations with the right side as last column.
fn add(rows: &mut [Complex64], slopes: &[Complex64], value: Complex64) {
    let width = slopes.len() + 1;
    for (i, own) in slopes.iter().map(Complex64::conj).enumerate() {
        for (j, other) in slopes.iter().enumerate() {
            rows[i * width + j] += own * other;
        }
        rows[i * width + slopes.len()] += own * value;
    }
}
