//! Derivatives of a peak with respect to a parameter of its signals.

use crate::damping::HalfPower;
use crate::peak::Peak;
use crate::response::FrequencyResponse;
use crate::spectra::HitSpectra;
use crate::transform::FourierKernel;
use num_complex::Complex64;

/// Derivatives of a peak with respect to a parameter, in the units below over that of the
/// parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeakDerivative {
    /// Derivative of the frequency, in hertz.
    pub frequency_hz: f64,
    /// Derivative of the magnitude, in m/N.
    pub magnitude: f64,
}

/// Transforms of a hit at one frequency, from which derivatives of `ln |H|^2` there follow.
#[derive(Debug)]
struct LogReceptance {
    kernel: FourierKernel,
    samples: [Complex64; 2],
    force: [Complex64; 2],
}

impl LogReceptance {
    fn new(response: &FrequencyResponse, frequency_hz: f64) -> Self {
        let transforms = response.transforms_at(frequency_hz);
        Self {
            kernel: FourierKernel::new(response.sample_rate_hz(), frequency_hz),
            samples: [transforms.response.value, transforms.response.slope],
            force: [transforms.force.value, transforms.force.slope],
        }
    }

    /// Derivatives with respect to the parameter of `ln |H|^2` and of its slope \[1/Hz\], from those
    /// of the samples and the force.
    fn derivatives(&self, d_samples: &[f64], d_force: &[f64]) -> (f64, f64) {
        let relative = |[value, slope]: [Complex64; 2], d_signal: &[f64]| {
            let (d_value, d_slope) = self.kernel.transform_and_slope(d_signal, 0);
            let relative = d_value / value;
            (relative, (d_slope - slope * relative) / value)
        };
        let (samples, samples_slope) = relative(self.samples, d_samples);
        let (force, force_slope) = relative(self.force, d_force);
        (2.0 * (samples - force).re, 2.0 * (samples_slope - force_slope).re)
    }
}

/// First-order sensitivity of a peak of a hit to any number of parameters.
///
/// With `L = ln |H|^2` and subscripts for derivatives with respect to the frequency `f` and the
/// parameter `t`, the frequency of the maximum has the derivative `-L_ft / L_ff` and its height
/// `|H| L_t / 2`, where `L_t = 2 Re (X_t / X - F_t / F)` with the transforms of the derivatives of
/// the samples. The half-power crossings, where `L` is `ln 2` below the peak, have
/// `(L_t(peak) - L_t) / L_f`.
#[derive(Debug)]
pub struct PeakSensitivity {
    peak: Peak,
    top: LogReceptance,
    /// `d2 ln |H|^2 / df2` at the peak \[1/Hz^2\].
    curvature: f64,
    sides: Option<(HalfPower, [(LogReceptance, f64); 2])>,
}

impl PeakSensitivity {
    /// The sensitivity of `peak`, and of its damping ratio if `half_power` holds its crossings.
    ///
    /// The curvature follows from `d2X/df2 = dt sum -(2 pi n dt)^2 x_n exp(-i 2 pi f n dt)`.
    ///
    /// ```
    /// use asperity_signal::{FrequencyResponse, HarmonicOptions, PeakSensitivity, find_harmonics};
    ///
    /// let decay: Vec<f64> = (0..4000).map(|n| (-5e-3 * f64::from(n)).exp()).collect();
    /// let samples: Vec<f64> =
    ///     decay.iter().zip(0..).map(|(a, n)| a * (0.1 * f64::from(n)).sin()).collect();
    /// let mut force = vec![0.0; 4000];
    /// force[0] = 1.0;
    /// let hit = FrequencyResponse::from_displacement(&force, &samples, 5e4)?;
    /// let found = find_harmonics(&hit, 800.0, &HarmonicOptions::default());
    /// let peak = found.fundamental.ok_or("an oscillator has a peak")?;
    /// // A factor on the response scales the peak and does not move it.
    /// let derivative = PeakSensitivity::new(&hit, &peak, None).peak(&samples, &[]);
    /// assert!(derivative.frequency_hz.abs() < 1e-6);
    /// assert!((derivative.magnitude / peak.magnitude - 1.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(response: &FrequencyResponse, peak: &Peak, half_power: Option<HalfPower>) -> Self {
        let frequency = peak.frequency_hz;
        let top = LogReceptance::new(response, frequency);
        let curvature_of = |[value, slope]: [Complex64; 2], samples: &[f64]| {
            let rate = response.sample_rate_hz();
            // A further factor -i 2 pi t on the slope.
            let ramped: Vec<f64> =
                samples.iter().enumerate().map(|(n, x)| n as f64 / rate * x).collect();
            let (_, second) = top.kernel.transform_and_slope(&ramped, 0);
            let second = second * Complex64::new(0.0, -std::f64::consts::TAU);
            (second / value - (slope / value).powi(2)).re
        };
        let divided = f64::from(2 * response.kind().derivatives()) / (frequency * frequency);
        let curvature = 2.0
            * (curvature_of(top.samples, response.samples())
                - curvature_of(top.force, response.force()))
            + divided;
        let side = |frequency: f64| {
            (LogReceptance::new(response, frequency), response.power_and_slope(frequency).1)
        };
        let sides = half_power.map(|found| (found, [side(found.lower_hz), side(found.upper_hz)]));
        Self { peak: *peak, top, curvature, sides }
    }

    /// Derivatives of the peak from those of the response samples and the force, which count as
    /// zero beyond their ends.
    pub fn peak(&self, d_samples: &[f64], d_force: &[f64]) -> PeakDerivative {
        let (height, slope) = self.top.derivatives(d_samples, d_force);
        PeakDerivative {
            frequency_hz: -slope / self.curvature,
            magnitude: 0.5 * height * self.peak.magnitude,
        }
    }

    /// Derivative of the half-power damping ratio ([`HalfPower::ratio`]) from those of the response
    /// samples and the force; `None` without crossings.
    pub fn damping_ratio(&self, d_samples: &[f64], d_force: &[f64]) -> Option<f64> {
        let (crossings, sides) = self.sides.as_ref()?;
        let (height, _) = self.top.derivatives(d_samples, d_force);
        let [lower, upper] = sides
            .each_ref()
            .map(|(side, slope)| (height - side.derivatives(d_samples, d_force).0) / slope);
        let (a, b) = (crossings.lower_hz, crossings.upper_hz);
        let sum = a * a + b * b;
        let q = (b - a) * (b + a) / sum;
        let d_q = 4.0 * a * b * (a * upper - b * lower) / (sum * sum);
        Some(0.5 * (0.5 * q.atan()).cos() / (1.0 + q * q) * d_q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HarmonicOptions, find_harmonics, half_power_crossings};

    const RATE: f64 = 5e4;

    /// The response of an oscillator and a pulse: samples as functions of frequency,
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

    /// Verified against central differences of the whole analysis; the crossings are found to 1e-10,
    /// which over differences of 1e-4 leaves 1e-5 of the ratio.
    #[test]
    fn derivatives_are_those_of_central_differences() {
        let base = [800.0, 0.035, 1e-4];
        let response = hit(base);
        let peak =
            find_harmonics(&response, 800.0, &HarmonicOptions::default()).fundamental.unwrap();
        let sensitivity =
            PeakSensitivity::new(&response, &peak, half_power_crossings(&response, &peak));
        for parameter in 0..3 {
            let step = 1e-4 * base[parameter];
            let four = [-2.0, -1.0, 1.0, 2.0].map(|steps| {
                let mut varied = base;
                varied[parameter] += steps * step;
                hit(varied)
            });
            let slope = |v: [f64; 4]| (8.0 * (v[2] - v[1]) - (v[3] - v[0])) / (12.0 * step);
            let derivative = |of: &dyn Fn(&FrequencyResponse) -> &[f64]| -> Vec<f64> {
                (0..6000).map(|n| slope(four.each_ref().map(|hit| of(hit)[n]))).collect()
            };
            let (samples, force) =
                (derivative(&FrequencyResponse::samples), derivative(&FrequencyResponse::force));
            let found = sensitivity.peak(&samples, &force);
            let ratio = sensitivity.damping_ratio(&samples, &force).unwrap();
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
