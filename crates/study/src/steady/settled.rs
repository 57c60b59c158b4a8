//! The fundamental of a steady response by time integration from rest.

use std::f64::consts::TAU;

use asperity_dynamics::{DynamicsError, Excitation, Integrator, Sampling};

use crate::assemble::Assembly;

/// Samples of a period.
const SAMPLES: usize = 64;

/// Transients of free bodies are integrated until they have fallen to this.
const REMAINS: f64 = 1e-6;

/// Fewest periods, and most: for lightly damped rigs, and a support without damping.
const FEWEST_PERIODS: f64 = 20.0;
const MOST_PERIODS: f64 = 8000.0;

/// Relative change of the fundamental over the last quarter of the time up to which it has settled.
const SETTLED: f64 = 1e-4;

/// The fundamental of the top, integrated from rest under a harmonic force until it has settled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettledAmplitude {
    /// Amplitude in the last period \[m\].
    pub amplitude_1_m: f64,
    /// Step \[s\].
    pub step_s: f64,
    /// False if it still changed after 8000 periods.
    pub settled: bool,
}

impl SettledAmplitude {
    /// Integrates under a force of `amplitude` \[N\] at `frequency` \[Hz\] by `method`: first as long as
    /// the bodies' damping takes, then twice as long again while the fundamental changes.
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
        let shaker = Excitation::Harmonic { amplitude, frequency };
        loop {
            let sampling = Sampling::new(periods / frequency, SAMPLES as f64 * frequency)?;
            let done = method.integrate(&assembly.structure, &shaker, &sampling)?;
            let displacement = &done.history.displacement;
            let before = displacement.len() - displacement.len() / 4;
            let [earlier, last] = [&displacement[..before], &displacement[..]].map(fundamental);
            let settled = (last - earlier).abs() <= SETTLED * last;
            if settled || periods >= MOST_PERIODS {
                return Ok(Self { amplitude_1_m: last, step_s: done.step, settled });
            }
            periods = (2.0 * periods).min(MOST_PERIODS);
        }
    }
}

/// Periods until a transient of free bodies, on damped contacts that of the lowest mode, at `frequency` \[Hz\] has fallen to a millionth, 20 to
/// 8000.
pub fn first_periods(assembly: &Assembly, frequency: f64) -> f64 {
    let structure = &assembly.structure;
    let mut rate = 0.5 * structure.damping_rate();
    if structure.contacts().iter().any(|contact| contact.damping().is_some())
        && let Ok(modes) = structure.modes(1)
    {
        let slowest = modes.iter().map(|mode| TAU * mode.frequency_hz * mode.damping_ratio);
        rate = slowest.fold(rate, f64::max);
    }
    let decay = rate / frequency;
    (-REMAINS.ln() / decay).clamp(FEWEST_PERIODS, MOST_PERIODS).ceil()
}

/// Amplitude of the fundamental in the last period of some samples.
fn fundamental(samples: &[f64]) -> f64 {
    let last = &samples[samples.len().saturating_sub(SAMPLES)..];
    let angle = |n: usize| TAU * n as f64 / SAMPLES as f64;
    let cos: f64 = last.iter().enumerate().map(|(n, u)| u * angle(n).cos()).sum();
    let sin: f64 = last.iter().enumerate().map(|(n, u)| u * angle(n).sin()).sum();
    2.0 / SAMPLES as f64 * cos.hypot(sin)
}
