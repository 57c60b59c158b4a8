//! The fundamental of a steady response by time integration from rest.

use std::f64::consts::TAU;

use asperity_dynamics::{DynamicsError, Integrator, Sampling, Transient};
use asperity_mesh::Port;
use asperity_structure::{LoadCase, TimeFunction};
use num_complex::Complex64;
use serde::Serialize;

use crate::assemble::Assembly;

/// Samples a period.
pub(crate) const SAMPLES: usize = 64;

/// The first integration lasts until the transient of free bodies has fallen to this share.
const REMAINS: f64 = 1e-6;

/// Limits of the number of periods. Lightly damped structures, and supports without damping, would take
/// more.
const FEWEST_PERIODS: f64 = 20.0;
const MOST_PERIODS: f64 = 8000.0;

/// Largest scatter of a settled fundamental over the last quarter of the time.
const SETTLED: f64 = 1e-4;

/// The motion counts as not periodic when the time was doubled this number of times in a row and the
/// scatter was not halved.
const STALLED: usize = 2;

/// Motion of the top under a harmonic force, by the fundamentals of successive periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SteadyMotion {
    /// The fundamental no longer changes from period to period.
    Periodic,
    /// The fundamental still changes at the end, less with each doubling of the time.
    NotSettled,
    /// The fundamental scatters, and no less after four times the time: the motion does not have the
    /// period of the force.
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

    /// Integrates under a force of `amplitude` \[N\] at `frequency` \[Hz\] by `method`. The first integration
    /// has [`first_periods`]; the time is doubled while the fundamental changes, up to 8000 periods or until
    /// the motion counts as not periodic.
    ///
    /// # Errors
    /// [`DynamicsError`] of the integration.
    pub fn of(
        assembly: &Assembly,
        method: &Integrator,
        amplitude: f64,
        frequency: f64,
    ) -> Result<Self, DynamicsError> {
        let periods = first_periods(assembly, frequency);
        let sensor = &assembly.sensor_ports()[..1];
        let integrate = |load: &LoadCase, sampling: &Sampling| {
            method.integrate(&assembly.structure, load, sensor, sampling)
        };
        settled_by(integrate, assembly.load.port(), (amplitude, frequency), periods)
    }
}

/// The fundamental of the first sensor of `integrate` under a force of this amplitude \[N\] and frequency \[Hz\]
/// at `port`, over so many periods at first.
pub(crate) fn settled_by(
    integrate: impl Fn(&LoadCase, &Sampling) -> Result<Transient, DynamicsError>,
    port: Port,
    (amplitude, frequency): (f64, f64),
    mut periods: f64,
) -> Result<SettledAmplitude, DynamicsError> {
    let (mut before, mut stalled) = (f64::INFINITY, 0);
    let shaker = LoadCase::force(TimeFunction::Harmonic { frequency }, amplitude).at(port);
    loop {
        let sampling = Sampling::new(periods / frequency, SAMPLES as f64 * frequency)?;
        let done = integrate(&shaker, &sampling)?;
        let found = Fundamentals::of(&done.history.sensors[0].displacement);
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
            return Ok(SettledAmplitude { amplitude_1_m, step_s, motion, scatter });
        }
        periods = (2.0 * periods).min(MOST_PERIODS);
    }
}

/// Periods at `frequency` \[Hz\] until the transient has fallen to a millionth, 20 to 8000: the transient of
/// free bodies, or of the lowest mode where contacts are damped.
pub fn first_periods(assembly: &Assembly, frequency: f64) -> f64 {
    periods_to_decay_at(slowest_rate(assembly), frequency)
}

/// Periods at `frequency` \[Hz\] until a transient that decays at `rate` \[1/s\] has fallen to a millionth, 20 to
/// 8000.
pub(crate) fn periods_to_decay_at(rate: f64, frequency: f64) -> f64 {
    (-REMAINS.ln() * frequency / rate).clamp(FEWEST_PERIODS, MOST_PERIODS).ceil()
}

/// Rate \[1/s\] at which the transient of [`first_periods`] decays.
pub(super) fn slowest_rate(assembly: &Assembly) -> f64 {
    let structure = &assembly.structure;
    let mut rate = 0.5 * structure.damping_rate();
    if structure.contacts().iter().any(|contact| contact.damping().is_some())
        && let Ok(modes) = structure.modes(1)
    {
        let slowest = modes.iter().map(|mode| TAU * mode.frequency_hz * mode.damping_ratio);
        rate = slowest.fold(rate, f64::max);
    }
    rate
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
