//! A second method: the single mass integrated in time until it is steady.

use std::f64::consts::TAU;

use asperity_harmonic::PeriodicResponse;

use crate::rigs::{AREA, Law, MASS, PRESSURE};

/// `m u'' + m h u' + S (p - p0) = F cos(w t)`, by the classical Runge-Kutta method, 400 steps a
/// period: its error is below 1e-9 there.
pub(crate) struct Motion<'a> {
    pub(crate) law: &'a Law,
    pub(crate) rate: f64,
    pub(crate) force: f64,
    pub(crate) frequency: f64,
}

pub(crate) const STEPS: usize = 400;

impl Motion<'_> {
    fn slope(&self, phase: f64, [u, v]: [f64; 2]) -> [f64; 2] {
        let pressure = self.law.pressure_increment(PRESSURE, u).value;
        [v, (self.force * phase.cos() - AREA * pressure) / MASS - self.rate * v]
    }

    /// The state a period later; `observe` is called with the displacement at every step.
    pub(crate) fn period(&self, mut state: [f64; 2], mut observe: impl FnMut(f64)) -> [f64; 2] {
        let dt = 1.0 / (self.frequency * STEPS as f64);
        let ahead = |x: [f64; 2], k: [f64; 2], t: f64| [x[0] + t * k[0], x[1] + t * k[1]];
        for n in 0..STEPS {
            observe(state[0]);
            let phase = |half: f64| TAU * (n as f64 + half) / STEPS as f64;
            let a = self.slope(phase(0.0), state);
            let b = self.slope(phase(0.5), ahead(state, a, 0.5 * dt));
            let c = self.slope(phase(0.5), ahead(state, b, 0.5 * dt));
            let d = self.slope(phase(1.0), ahead(state, c, dt));
            for i in 0..2 {
                state[i] += dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
            }
        }
        state
    }

    /// Amplitudes of the first `count` harmonics after `periods` periods from `state`.
    pub(crate) fn settled(&self, mut state: [f64; 2], periods: usize, count: usize) -> Vec<f64> {
        for _ in 0..periods {
            state = self.period(state, |_| ());
        }
        let mut samples = Vec::new();
        self.period(state, |u| samples.push(u));
        (1..=count).map(|k| harmonic(&samples, k)).collect()
    }
}

/// Amplitude of harmonic k of samples over one period.
pub(crate) fn harmonic(samples: &[f64], k: usize) -> f64 {
    let n = samples.len() as f64;
    let angle = |i: usize| TAU * (k * i) as f64 / n;
    let cos: f64 = samples.iter().enumerate().map(|(i, u)| u * angle(i).cos()).sum();
    let sin: f64 = samples.iter().enumerate().map(|(i, u)| u * angle(i).sin()).sum();
    2.0 / n * cos.hypot(sin)
}

/// Displacement and velocity of a response at the start of a period.
pub(crate) fn state_of(response: &PeriodicResponse) -> [f64; 2] {
    let velocity: f64 = (1..)
        .map(f64::from)
        .zip(&response.displacement)
        .map(|(k, u)| -u.im * k * response.angular_frequency)
        .sum();
    [response.displacement_at(0.0), velocity]
}
