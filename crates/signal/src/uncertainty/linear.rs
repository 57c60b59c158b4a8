//! Standard deviation of a linear combination of logarithms of the receptance.

use super::{NoiseDensity, Signal, is_long};
use crate::response::FrequencyResponse;
use crate::spectra::{HitTransforms, SignalTransform};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Points of the slow sums over time, at least, and for each cycle of the range of frequencies.
const POINTS: f64 = 64.0;
const POINTS_A_CYCLE: f64 = 16.0;

/// Coefficients `c_k` of a small change `dq = Re sum_k c_k d ln H(f_k)` of a quantity `q`.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct LogReceptanceTerms {
    /// Frequencies in hertz, and coefficients in the unit of the quantity.
    pub(crate) terms: Vec<(f64, Complex64)>,
}

impl LogReceptanceTerms {
    /// The terms times a factor.
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.terms.iter_mut().for_each(|(_, coefficient)| *coefficient *= factor);
        self
    }

    /// The terms of the sum of two quantities, joined where the frequencies are the same.
    pub(crate) fn plus(mut self, other: &Self) -> Self {
        let pairs = || self.terms.iter().zip(&other.terms);
        if self.terms.len() == other.terms.len() && pairs().all(|(a, b)| a.0 == b.0) {
            self.terms.iter_mut().zip(&other.terms).for_each(|(a, b)| a.1 += b.1);
        } else {
            self.terms.extend_from_slice(&other.terms);
        }
        self
    }

    /// Standard deviation of the quantity due to noise, in its unit; `None` where it is not finite.
    ///
    /// ```text
    /// var q = (S rate / 2) sum_n w_n^2 (Re g_n)^2,   g_n = dt sum_k c_k exp(-i w_k t_n) / X_k
    /// ```
    ///
    /// for the noise of the response, and likewise for that of the force. Over many cycles the mean
    /// of `(Re g_n)^2` is `|g_n|^2 / 2`, which varies slowly where the frequencies are near each
    /// other, and is summed over fewer points.
    pub(crate) fn deviation(
        &self,
        response: &FrequencyResponse,
        noise: &NoiseDensity,
    ) -> Option<f64> {
        let (first, _) = *self.terms.first()?;
        let span = self.terms.iter().map(|(f, _)| (f - first).abs()).fold(0.0, f64::max);
        if !noise.is_valid() {
            return None;
        }
        let transforms: Vec<HitTransforms> =
            self.terms.iter().map(|(f, _)| response.transforms_at(*f)).collect();
        let rate = response.sample_rate_hz();
        let origin = response.time_origin_s();
        let variance = |signal: Signal, of: fn(&HitTransforms) -> &SignalTransform| {
            let density = noise.density(signal);
            let mut samples = of(&transforms[0]).samples.clone();
            if let (Signal::Response, Some(window)) = (signal, noise.windows.response) {
                let end = ((window.end_s + window.taper_s) * rate).ceil() as usize;
                samples.end = samples.end.min(end);
            }
            if density == 0.0 || samples.is_empty() {
                return 0.0;
            }
            let coefficients: Vec<(f64, Complex64)> = (self.terms.iter().zip(&transforms))
                .map(|((f, c), transform)| (TAU * (f - first), c / of(transform).value))
                .collect();
            let count = samples.len() as f64;
            let is_long = is_long(samples.len(), first, rate);
            let slow = (POINTS + POINTS_A_CYCLE * span * count / rate).floor();
            let points = if is_long { slow.min(count) } else { count };
            let stride = count / points;
            let time = |point: f64| (samples.start as f64 + (point + 0.5) * stride - 0.5) / rate;
            // The phasors of each term at the next point, and their turn from one to the next.
            let turn = |omega: f64, time: f64| Complex64::from_polar(1.0, -omega * time);
            let mut phasors: Vec<(Complex64, Complex64)> = coefficients
                .iter()
                .map(|(omega, c)| {
                    (c * turn(*omega, time(0.0) - origin), turn(*omega, stride / rate))
                })
                .collect();
            let square = |point: usize| {
                let time = time(point as f64);
                let weight = noise.windows.weight(signal, time);
                let mut sum = Complex64::ZERO;
                for (phasor, turn) in &mut phasors {
                    sum += *phasor;
                    *phasor *= *turn;
                }
                let square = if is_long {
                    0.5 * sum.norm_sqr()
                } else {
                    (sum * turn(TAU * first, time - origin)).re.powi(2)
                };
                weight * weight * square
            };
            0.5 * density / rate * stride * (0..points as usize).map(square).sum::<f64>()
        };
        let total = variance(Signal::Response, |transforms| &transforms.response)
            + variance(Signal::Force, |transforms| &transforms.force);
        Some(total.sqrt()).filter(|deviation| deviation.is_finite())
    }
}
