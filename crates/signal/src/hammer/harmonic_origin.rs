//! The origin of a peak near twice the fundamental, from the free decay.

use crate::ring_down::{BandPass, analytic_signal};
use std::f64::consts::TAU;

/// Half width of the bands about the fundamental and its double, over the fundamental.
const HALF_WIDTH: f64 = 0.3;
/// Edges of the bands, over the fundamental.
const EDGE: f64 = 0.05;
/// Largest part of the signal that the end of the force pulse may contribute.
const EDGE_LEVEL: f64 = 0.03;
/// Least amplitude of the second signal, over the root mean square envelope of the noise.
const ABOVE_NOISE: f64 = 4.0;
/// Fewest cycles of the fundamental.
const FEWEST_CYCLES: f64 = 2.0;
/// Largest drift of the phase of a harmonic, and smallest of a mode \[rad\].
const DRIFT: (f64, f64) = (0.6, 1.0);
/// Exponents of the amplitude of a harmonic, and those beyond which a peak is a mode.
const HARMONIC_EXPONENT: (f64, f64) = (1.6, 2.6);
const MODE_EXPONENT: (f64, f64) = (1.35, 3.2);

/// Origin of a peak near twice the fundamental.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PeakOrigin {
    /// The second harmonic of the fundamental, made by the nonlinearity.
    Harmonic,
    /// Another mode of the structure.
    Mode,
}

/// Behaviour of a peak near twice the fundamental in the free decay.
///
/// From the analytic signals `z1 = a1 exp(i p1)` and `z2 = a2 exp(i p2)` of the bands about `f1` and
/// `2 f1`: a harmonic follows its fundamental,
///
/// ```text
/// p2 - 2 p1 = const,   a2 ~ a1^2,
/// ```
///
/// a mode has its own frequency `f2`, so that `p2 - 2 p1` drifts by `2 pi (f2 - 2 f1) t`, and its own
/// decay rate, `a2 ~ a1^(s2 / s1)`. A mode at twice the fundamental with its damping ratio
/// behaves in one decay as a harmonic does; hits of different forces tell them apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HarmonicTest {
    /// Drift of `p2 - 2 p1` over the decay, in radians.
    pub phase_drift: f64,
    /// Exponent `d ln a2 / d ln a1`.
    pub exponent: f64,
    /// Length of the decay, in cycles of the fundamental.
    pub cycles: f64,
}

impl HarmonicTest {
    /// The behaviour in a decay; `None` if the second signal is above the noise for fewer than two
    /// cycles after the settling of the filters, or a band exceeds half the sample rate.
    ///
    /// - `decay`: free decay from the end of the force pulse, any unit.
    /// - `noise_density`: one-sided, in the samples' unit squared per hertz.
    pub fn of(
        decay: &[f64],
        sample_rate_hz: f64,
        fundamental_hz: f64,
        noise_density: f64,
    ) -> Option<Self> {
        let half = HALF_WIDTH * fundamental_hz;
        let edge = EDGE * fundamental_hz;
        let band = |centre: f64| BandPass::new(centre - half, centre + half, edge);
        let first = band(fundamental_hz).ok()?;
        let second = band(2.0 * fundamental_hz).ok()?;
        let z1 = analytic_signal(decay, sample_rate_hz, Some(&first)).ok()?;
        let z2 = analytic_signal(decay, sample_rate_hz, Some(&second)).ok()?;
        let settled = (second.settling_s(EDGE_LEVEL) * sample_rate_hz).ceil() as usize;
        let floor = ABOVE_NOISE * (2.0 * noise_density * second.noise_width_hz()).sqrt();
        let rest = z2.get(settled..z2.len().saturating_sub(settled))?;
        let largest = rest.first()?.norm();
        let end = rest
            .iter()
            .position(|value| value.norm() <= floor.max(1e-6 * largest))
            .unwrap_or(rest.len());
        let cycles = end as f64 * fundamental_hz / sample_rate_hz;
        if cycles < FEWEST_CYCLES {
            return None;
        }
        let (mut phase, mut before) = (0.0, None);
        let mut points = Vec::with_capacity(end);
        for (one, two) in z1[settled..settled + end].iter().zip(rest) {
            let turned = (two * one.conj() * one.conj()).arg();
            if let Some(before) = before {
                let change: f64 = turned - before;
                phase += change - TAU * (change / TAU).round();
            }
            before = Some(turned);
            points.push([phase, one.norm().ln(), two.norm().ln()]);
        }
        let count = points.len() as f64;
        let index = |n: usize| n as f64 / count;
        let drift = slope(points.iter().enumerate().map(|(n, point)| (index(n), point[0])));
        let exponent = slope(points.iter().map(|point| (point[1], point[2])));
        let found = Self { phase_drift: drift, exponent, cycles };
        (drift.is_finite() && exponent.is_finite()).then_some(found)
    }

    /// The origin, if the decay decides it.
    ///
    /// A harmonic drifts by less than 0.6 rad and has an exponent of 1.6 to 2.6; a drift of more than
    /// 1 rad, or an exponent below 1.35 or above 3.2, is that of a mode.
    pub fn origin(&self) -> Option<PeakOrigin> {
        let drift = self.phase_drift.abs();
        let within = |(low, high): (f64, f64)| (low..=high).contains(&self.exponent);
        if drift > DRIFT.1 || !within(MODE_EXPONENT) {
            Some(PeakOrigin::Mode)
        } else if drift < DRIFT.0 && within(HARMONIC_EXPONENT) {
            Some(PeakOrigin::Harmonic)
        } else {
            None
        }
    }
}

/// Slope of the least-squares line.
fn slope(points: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let sum = |of: fn((f64, f64)) -> f64| points.clone().map(of).sum::<f64>();
    let count = sum(|_| 1.0);
    let (x, y) = (sum(|(x, _)| x) / count, sum(|(_, y)| y) / count);
    let cross: f64 = points.clone().map(|(a, b)| (a - x) * (b - y)).sum();
    let square: f64 = points.map(|(a, _)| (a - x).powi(2)).sum();
    cross / square
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 25_600.0;

    fn decay(second: impl Fn(f64) -> f64) -> Vec<f64> {
        let time = |n: usize| n as f64 / RATE;
        let first = |t: f64| (-150.0 * t).exp() * (TAU * 830.0 * t + 0.4).cos();
        (0..3000).map(|n| first(time(n)) + second(time(n))).collect()
    }

    /// Verified against decays with a known second signal: the square of a first one whose frequency
    /// changes by 10 % with amplitude is a harmonic; modes at 1.95 of the fundamental, and at twice
    /// with its decay rate, are modes; a weak signal in noise decides nothing.
    #[test]
    fn harmonics_follow_their_fundamental() {
        let phase = |t: f64| TAU * (830.0 * t - 83.0 / 150.0 * (1.0 - (-150.0 * t).exp()));
        let samples: Vec<f64> = (0..3000)
            .map(|n| f64::from(n) / RATE)
            .map(|t| {
                let a = (-150.0 * t).exp();
                a * phase(t).cos() + 0.1 * a * a * (2.0 * phase(t) + 1.0).cos()
            })
            .collect();
        let found = HarmonicTest::of(&samples, RATE, 800.0, 1e-9).unwrap();
        assert_eq!(found.origin(), Some(PeakOrigin::Harmonic), "{found:?}");
        assert!((found.exponent - 2.0).abs() < 0.1, "{found:?}");

        let near = decay(|t| 0.1 * (-300.0 * t).exp() * (TAU * 1.95 * 830.0 * t).cos());
        let found = HarmonicTest::of(&near, RATE, 830.0, 1e-9).unwrap();
        assert_eq!(found.origin(), Some(PeakOrigin::Mode), "{found:?}");

        let double = decay(|t| 0.1 * (-150.0 * t).exp() * (TAU * 1660.0 * t).cos());
        let found = HarmonicTest::of(&double, RATE, 830.0, 1e-9).unwrap();
        assert_eq!(found.origin(), Some(PeakOrigin::Mode), "{found:?}");
        assert!((found.exponent - 1.0).abs() < 0.1 && found.phase_drift.abs() < 0.1, "{found:?}");

        let weak = decay(|t| 1e-3 * (-300.0 * t).exp() * (TAU * 1660.0 * t).cos());
        assert_eq!(HarmonicTest::of(&weak, RATE, 830.0, 1e-4), None);
    }
}
