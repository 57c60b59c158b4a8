//! The fundamental of a steady response by time integration from rest.

use std::f64::consts::TAU;

use asperity_dynamics::{DynamicsError, Excitation, Integrator, Sampling};
use num_complex::Complex64;
use serde::Serialize;

use crate::assemble::Assembly;

/// Samples of a period.
const SAMPLES: usize = 64;

/// Transients of free bodies are integrated until they have fallen to this.
const REMAINS: f64 = 1e-6;

/// Fewest periods, and most: for lightly damped rigs, and a support without damping.
const FEWEST_PERIODS: f64 = 20.0;
const MOST_PERIODS: f64 = 8000.0;

/// Scatter of the fundamental over the last quarter of the time up to which it has settled.
const SETTLED: f64 = 1e-4;

/// Times that twice as long a run does not halve the scatter until the motion counts as not periodic.
const STALLED: usize = 2;

/// Motion of the top under a harmonic force, by the fundamentals of successive periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SteadyMotion {
    /// The fundamental no longer changes from period to period.
    Periodic,
    /// It still changes at the end, less and less.
    NotSettled,
    /// It scatters, no less after four times as long: the steady motion has not the period of the force.
    NonPeriodic,
}

/// The fundamental of the top, integrated from rest under a harmonic force until it has settled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettledAmplitude {
    /// Amplitude in the last period, or of the mean fundamental over the last quarter of the time where
    /// the periods differ \[m\].
    pub amplitude_1_m: f64,
    /// Step \[s\].
    pub step_s: f64,
    /// The motion: settled if it is periodic.
    pub motion: SteadyMotion,
    /// Largest relative distance of the fundamental of a period from the mean over the last quarter of
    /// the time.
    pub scatter: f64,
}

impl SettledAmplitude {
    /// True if the motion is periodic.
    pub fn is_settled(&self) -> bool {
        self.motion == SteadyMotion::Periodic
    }

    /// Integrates under a force of `amplitude` \[N\] at `frequency` \[Hz\] by `method`: first as long as
    /// the bodies' damping takes, then twice as long again while the fundamental changes, up to 8000
    /// periods or until it turns out not to settle.
    ///
    /// # Errors
    /// [`DynamicsError`] of the integration.
    pub fn of(
        assembly: &Assembly,
        method: &Integrator,
        amplitude: f64,
        frequency: f64,
    ) -> Result<Self, DynamicsError> {
        let mut periods = first_periods(assembly, frequency);
        let (mut before, mut stalled) = (f64::INFINITY, 0);
        let shaker = Excitation::Harmonic { amplitude, frequency };
        loop {
            let sampling = Sampling::new(periods / frequency, SAMPLES as f64 * frequency)?;
            let done = method.integrate(&assembly.structure, &shaker, &sampling)?;
            let found = Fundamentals::of(&done.history.displacement);
            stalled = if found.scatter > 0.5 * before { stalled + 1 } else { 0 };
            before = found.scatter;
            let motion = if found.scatter <= SETTLED {
                SteadyMotion::Periodic
            } else if stalled >= STALLED {
                SteadyMotion::NonPeriodic
            } else {
                SteadyMotion::NotSettled
            };
            if motion != SteadyMotion::NotSettled || periods >= MOST_PERIODS {
                let periodic = motion == SteadyMotion::Periodic;
                let amplitude_1_m = if periodic { found.last } else { found.mean };
                let (step_s, scatter) = (done.step, found.scatter);
                return Ok(Self { amplitude_1_m, step_s, motion, scatter });
            }
            periods = (2.0 * periods).min(MOST_PERIODS);
        }
    }
}

/// Periods until a transient of free bodies, on damped contacts that of the lowest mode, at `frequency` \[Hz\] has fallen to a millionth, 20 to
/// 8000.
pub fn first_periods(assembly: &Assembly, frequency: f64) -> f64 {
    periods_to_decay(assembly, frequency, REMAINS).clamp(FEWEST_PERIODS, MOST_PERIODS).ceil()
}

/// Periods at `frequency` \[Hz\] until such a transient has fallen to `remains`; infinite without
/// damping.
pub(super) fn periods_to_decay(assembly: &Assembly, frequency: f64, remains: f64) -> f64 {
    let structure = &assembly.structure;
    let mut rate = 0.5 * structure.damping_rate();
    if structure.contacts().iter().any(|contact| contact.damping().is_some())
        && let Ok(modes) = structure.modes(1)
    {
        let slowest = modes.iter().map(|mode| TAU * mode.frequency_hz * mode.damping_ratio);
        rate = slowest.fold(rate, f64::max);
    }
    -remains.ln() * frequency / rate
}

/// Fundamentals of the periods in the last quarter of some samples.
struct Fundamentals {
    /// Amplitude in the last period.
    last: f64,
    /// Amplitude of the mean.
    mean: f64,
    /// Largest relative distance from the mean.
    scatter: f64,
}

impl Fundamentals {
    fn of(samples: &[f64]) -> Self {
        let periods = (samples.len() / SAMPLES / 4).max(1);
        let all: Vec<Complex64> =
            samples.rchunks_exact(SAMPLES).take(periods).map(fundamental).collect();
        let mean = all.iter().sum::<Complex64>() / all.len() as f64;
        let off = |one: &Complex64| (one - mean).norm() / mean.norm();
        let scatter = all.iter().map(off).fold(0.0, f64::max);
        let last = all.first().map_or(f64::NAN, |last| last.norm());
        Self { last, mean: mean.norm(), scatter }
    }
}

/// Complex amplitude of the fundamental in the samples of a period.
fn fundamental(period: &[f64]) -> Complex64 {
    let turn = |n: usize| Complex64::from_polar(1.0, -TAU * n as f64 / SAMPLES as f64);
    let sum: Complex64 = period.iter().enumerate().map(|(n, u)| turn(n) * u).sum();
    sum * (2.0 / SAMPLES as f64)
}
