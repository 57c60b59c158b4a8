//! How a peak follows what its signals depend on.

use crate::damping::HalfPower;
use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::transform::Kernel;
use realfft::num_complex::Complex64;

/// Derivatives of a peak with respect to a parameter; units are over the parameter's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakDerivative {
    /// Of the peak's frequency, in hertz.
    pub frequency_hz: f64,
    /// Of the peak's magnitude, in m/N.
    pub magnitude: f64,
}

/// A place on `ln |H|^2`: all that its derivatives there need of the hit itself.
#[derive(Debug)]
struct Place {
    kernel: Kernel,
    samples: [Complex64; 2],
    force: [Complex64; 2],
}

impl Place {
    fn new(response: &FrequencyResponse, frequency_hz: f64) -> Self {
        let terms = response.transforms_at(frequency_hz);
        Self {
            kernel: Kernel::new(response.sample_rate_hz(), frequency_hz),
            samples: [terms.response.value, terms.response.slope],
            force: [terms.force.value, terms.force.slope],
        }
    }

    /// Derivatives with respect to the parameter of `ln |H|^2` and of its slope \[1/Hz\].
    fn rates(&self, samples: &[f64], force: &[f64]) -> (f64, f64) {
        let part = |[value, slope]: [Complex64; 2], rates: &[f64]| {
            let (rate, slope_rate) = self.kernel.transform_and_slope(rates, 0);
            let relative = rate / value;
            (relative, (slope_rate - slope * relative) / value)
        };
        let (moved, bent) = part(self.samples, samples);
        let (pushed, swayed) = part(self.force, force);
        (2.0 * (moved - pushed).re, 2.0 * (bent - swayed).re)
    }
}

/// A hit's peak, ready to be differentiated with respect to any number of parameters.
///
/// With `L = ln |H|^2`, subscripts derivatives with frequency and with the parameter, the maximum
/// moves by `-L_ft / L_ff`, and its height by `|H| L_t / 2`: to first order the motion of the
/// maximum does not count. `L_t = 2 Re (X_t / X - F_t / F)` comes from the transforms of the
/// derivatives of the samples. The crossings of half power, where `L` has fallen by `ln 2`, move by
/// `(L_t(peak) - L_t) / L_f`.
#[derive(Debug)]
pub struct PeakSensitivity {
    peak: Peak,
    top: Place,
    /// `d2 ln |H|^2 / df2` at the peak \[1/Hz^2\].
    curvature: f64,
    sides: Option<(HalfPower, [(Place, f64); 2])>,
}

impl PeakSensitivity {
    /// The tangent of `peak`; `half_power` are its crossings, if it has any.
    ///
    /// The curvature is that of the samples themselves, `d2X/df2 = dt sum -(2 pi n dt)^2 x_n e`.
    pub fn new(response: &FrequencyResponse, peak: &Peak, half_power: Option<HalfPower>) -> Self {
        let frequency = peak.frequency_hz;
        let top = Place::new(response, frequency);
        let bend = |[value, slope]: [Complex64; 2], samples: &[f64]| {
            let rate = response.sample_rate_hz();
            // -i 2 pi t once more on the slope.
            let ramped: Vec<f64> =
                samples.iter().enumerate().map(|(n, x)| n as f64 / rate * x).collect();
            let (_, second) = top.kernel.transform_and_slope(&ramped, 0);
            let second = second * Complex64::new(0.0, -std::f64::consts::TAU);
            (second / value - (slope / value).powi(2)).re
        };
        let divided = f64::from(2 * response.kind().derivatives()) / (frequency * frequency);
        let curvature = 2.0
            * (bend(top.samples, response.samples()) - bend(top.force, response.force()))
            + divided;
        let side = |frequency: f64| {
            (Place::new(response, frequency), response.power_and_slope(frequency).1)
        };
        let sides = half_power.map(|found| (found, [side(found.lower_hz), side(found.upper_hz)]));
        Self { peak: *peak, top, curvature, sides }
    }

    /// Derivatives of the peak from those of the hit's `samples` and `force`, as long as the hit's.
    pub fn peak(&self, samples: &[f64], force: &[f64]) -> PeakDerivative {
        let (height, slope) = self.top.rates(samples, force);
        PeakDerivative {
            frequency_hz: -slope / self.curvature,
            magnitude: 0.5 * height * self.peak.magnitude,
        }
    }

    /// Derivative of the half-power damping ratio ([`HalfPower::ratio`]) from those of the hit's
    /// `samples` and `force`; none without crossings.
    pub fn damping_ratio(&self, samples: &[f64], force: &[f64]) -> Option<f64> {
        let (crossings, sides) = self.sides.as_ref()?;
        let (height, _) = self.top.rates(samples, force);
        let [lower, upper] =
            sides.each_ref().map(|(place, slope)| (height - place.rates(samples, force).0) / slope);
        let (a, b) = (crossings.lower_hz, crossings.upper_hz);
        let sum = a * a + b * b;
        let q = (b - a) * (b + a) / sum;
        let q_rate = 4.0 * a * b * (a * upper - b * lower) / (sum * sum);
        Some(0.5 * (0.5 * q.atan()).cos() / (1.0 + q * q) * q_rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HarmonicOptions, find_harmonics, half_power_crossings};

    const RATE: f64 = 5e4;

    /// An oscillator struck by a short pulse, and the pulse: samples as functions of frequency,
    /// damping ratio and pulse width.
    fn hit([natural, ratio, width]: [f64; 3]) -> FrequencyResponse {
        let omega = std::f64::consts::TAU * natural;
        let damped = omega * (1.0 - ratio * ratio).sqrt();
        let time = |n: usize| n as f64 / RATE;
        let samples: Vec<f64> = (0..6000)
            .map(|n| (-ratio * omega * time(n)).exp() * (damped * time(n)).sin() / damped)
            .collect();
        let force: Vec<f64> = (0..6000)
            .map(|n| if time(n) > 20.0 * width { 0.0 } else { time(n) * (-time(n) / width).exp() })
            .collect();
        FrequencyResponse::from_displacement(&force, &samples, RATE).unwrap()
    }

    fn measures(response: &FrequencyResponse) -> [f64; 3] {
        let peak =
            find_harmonics(response, 800.0, &HarmonicOptions::default()).fundamental.unwrap();
        let ratio = half_power_crossings(response, &peak).unwrap().ratio();
        [peak.frequency_hz, peak.magnitude, ratio]
    }

    /// Against central differences of the whole analysis; the crossings are found to 1e-10, which
    /// over differences of 1e-4 leaves 1e-5 of the ratio.
    #[test]
    fn a_peak_follows_its_samples() {
        let base = [800.0, 0.035, 1e-4];
        let response = hit(base);
        let peak =
            find_harmonics(&response, 800.0, &HarmonicOptions::default()).fundamental.unwrap();
        let tangent =
            PeakSensitivity::new(&response, &peak, half_power_crossings(&response, &peak));
        for parameter in 0..3 {
            let step = 1e-4 * base[parameter];
            let four = [-2.0, -1.0, 1.0, 2.0].map(|place| {
                let mut varied = base;
                varied[parameter] += place * step;
                hit(varied)
            });
            let slope = |v: [f64; 4]| (8.0 * (v[2] - v[1]) - (v[3] - v[0])) / (12.0 * step);
            let rates = |of: &dyn Fn(&FrequencyResponse) -> &[f64]| -> Vec<f64> {
                (0..6000).map(|n| slope(four.each_ref().map(|hit| of(hit)[n]))).collect()
            };
            let (samples, force) =
                (rates(&FrequencyResponse::samples), rates(&FrequencyResponse::force));
            let found = tangent.peak(&samples, &force);
            let ratio = tangent.damping_ratio(&samples, &force).unwrap();
            let all = four.each_ref().map(measures);
            let scales = measures(&response).map(|value| value / base[parameter]);
            let pairs = [found.frequency_hz, found.magnitude, ratio];
            for (i, (found, tolerance)) in pairs.into_iter().zip([1e-7, 1e-7, 1e-5]).enumerate() {
                let expected = slope(all.map(|measures| measures[i]));
                let off = (found - expected).abs() / expected.abs().max(1e-2 * scales[i]);
                assert!(off < tolerance, "{parameter} {i}: {found} {expected} {off:e}");
            }
        }
    }
}
