//! Linear modes and the geometric sums of their sampled transforms.

use asperity_signal::{Complex64, FrequencyResponse};
use std::f64::consts::TAU;

/// One viscously damped mode.
#[derive(Clone, Copy)]
pub(crate) struct Mode {
    pub(crate) natural_hz: f64,
    pub(crate) damping: f64,
    /// Modal mass [kg]; its reciprocal weighs the mode.
    pub(crate) mass: f64,
}

impl Mode {
    pub(crate) fn omega(&self) -> f64 {
        TAU * self.natural_hz
    }

    pub(crate) fn damped_omega(&self) -> f64 {
        self.omega() * (1.0 - self.damping * self.damping).sqrt()
    }

    /// Displacement a time `t` after a unit impulse.
    pub(crate) fn impulse_response(&self, t: f64) -> f64 {
        let decay = (-self.damping * self.omega() * t).exp();
        decay * (self.damped_omega() * t).sin() / (self.mass * self.damped_omega())
    }

    /// `1 / (m (w0^2 - w^2 + 2 i zeta w0 w))`, the continuous receptance.
    pub(crate) fn receptance(&self, frequency: f64) -> Complex64 {
        let (w0, w) = (self.omega(), TAU * frequency);
        let stiffness = Complex64::new(w0 * w0 - w * w, 2.0 * self.damping * w0 * w);
        (stiffness * self.mass).inv()
    }

    /// `dt sum h(n dt) exp(-i w n dt)` over all n >= 0 and its derivative with
    /// frequency, from the geometric series: the transform of a decayed record.
    pub(crate) fn sampled_receptance(&self, frequency: f64, rate: f64) -> (Complex64, Complex64) {
        let dt = 1.0 / rate;
        let scale = dt / (self.mass * self.damped_omega());
        let pole = Complex64::new(-self.damping * self.omega(), self.damped_omega());
        let mut sum = (Complex64::ZERO, Complex64::ZERO);
        // sin = (e^+ - e^-) / 2i
        for (pole, sign) in [(pole, 1.0), (pole.conj(), -1.0)] {
            let q = ((pole - Complex64::new(0.0, TAU * frequency)) * dt).exp();
            let rest = Complex64::ONE - q;
            let weight = Complex64::new(0.0, -0.5 * sign * scale);
            sum.0 += weight / rest;
            sum.1 += weight * Complex64::new(0.0, -TAU * dt) * q / (rest * rest);
        }
        sum
    }
}

/// Sampled impulse response of modes added up, under one sample of unit impulse.
pub(crate) fn impulse_response(modes: &[Mode], rate: f64, count: usize) -> (Vec<f64>, Vec<f64>) {
    let displacement = (0..count)
        .map(|n| {
            let t = n as f64 / rate;
            modes.iter().map(|mode| mode.impulse_response(t)).sum()
        })
        .collect();
    let mut force = vec![0.0; count];
    force[0] = rate;
    (force, displacement)
}

/// [`impulse_response`] as a hit.
pub(crate) fn hit(modes: &[Mode], rate: f64, count: usize) -> FrequencyResponse {
    let (force, displacement) = impulse_response(modes, rate, count);
    FrequencyResponse::from_displacement(&force, &displacement, rate).unwrap()
}

/// The frequency between `low` and `high` where the sampled `|H|` of the modes is
/// greatest: bisection on the derivative of the geometric series.
pub(crate) fn maximum(modes: &[Mode], rate: f64, mut low: f64, mut high: f64) -> f64 {
    let slope = |frequency| sampled_slope(modes, rate, frequency);
    assert!(slope(low) > 0.0 && slope(high) < 0.0, "no maximum inside");
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// `d ln |H|^2 / df` of the geometric series.
pub(crate) fn sampled_slope(modes: &[Mode], rate: f64, frequency: f64) -> f64 {
    let (value, slope) = modes
        .iter()
        .map(|mode| mode.sampled_receptance(frequency, rate))
        .fold((Complex64::ZERO, Complex64::ZERO), |sum, term| (sum.0 + term.0, sum.1 + term.1));
    2.0 * (slope / value).re
}

/// Integrates `m u'' + r(u, u') = F(t)` from rest by the classical fourth-order
/// Runge-Kutta rule with `inner` steps a sample; returns displacement and acceleration.
pub(crate) fn integrated(
    mass: f64,
    restoring: impl Fn(f64, f64) -> f64,
    force: impl Fn(f64) -> f64,
    rate: f64,
    count: usize,
    inner: usize,
) -> (Vec<f64>, Vec<f64>) {
    let acceleration = |t: f64, u: f64, v: f64| (force(t) - restoring(u, v)) / mass;
    let h = 1.0 / (rate * inner as f64);
    let (mut u, mut v) = (0.0, 0.0);
    let (mut displacement, mut accelerations) = (Vec::new(), Vec::new());
    for step in 0..count * inner {
        let t = step as f64 * h;
        let a1 = acceleration(t, u, v);
        if step % inner == 0 {
            displacement.push(u);
            accelerations.push(a1);
        }
        let (u2, v2) = (u + 0.5 * h * v, v + 0.5 * h * a1);
        let a2 = acceleration(t + 0.5 * h, u2, v2);
        let (u3, v3) = (u + 0.5 * h * v2, v + 0.5 * h * a2);
        let a3 = acceleration(t + 0.5 * h, u3, v3);
        let (u4, v4) = (u + h * v3, v + h * a3);
        let a4 = acceleration(t + h, u4, v4);
        u += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
        v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    (displacement, accelerations)
}

/// A smooth hammer pulse `F (t/tp)^2 exp(2 (1 - t/tp))`, largest at `tp`.
pub(crate) fn hammer_pulse(peak: f64, rise: f64) -> impl Fn(f64) -> f64 {
    move |t| peak * (t / rise).powi(2) * (2.0 * (1.0 - t / rise)).exp()
}
