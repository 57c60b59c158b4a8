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

/// Longest period looked for, in periods of the force.
const MOST_MULTIPLE: usize = 8;

/// Motion of the top under a harmonic force, by the fundamentals of successive periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SteadyMotion {
    /// The fundamental no longer changes from period to period.
    Periodic,
    /// The fundamental repeats after 2 to 8 periods of the force.
    Subharmonic,
    /// The fundamental still changes at the end, less with each doubling of the time.
    NotSettled,
    /// The fundamental scatters, and no less after four times the time: the motion has no period, or one longer
    /// than eight of the force.
    NonPeriodic,
    /// An interface is without contact all the time: the bodies do not come together again.
    Apart,
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
        let found = Fundamentals::of(&done.history.sensors[0].displacement, SAMPLES);
        let (motion, _) = found.motion(&mut before, &mut stalled);
        if motion != SteadyMotion::NotSettled || periods >= MOST_PERIODS {
            let periodic = motion == SteadyMotion::Periodic;
            let amplitude = if periodic { found.last() } else { found.mean() };
            let (amplitude_1_m, step_s, scatter) = (amplitude.norm(), done.step, found.scatter(1));
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

/// Fundamentals of the periods in the last quarter of some samples, the last first.
pub(super) struct Fundamentals(Vec<Complex64>);

impl Fundamentals {
    /// The fundamentals of samples that are so many a period.
    pub(super) fn of(samples: &[f64], per_period: usize) -> Self {
        let periods = (samples.len() / per_period / 4).max(1);
        Self(samples.rchunks_exact(per_period).take(periods).map(fundamental).collect())
    }

    fn last(&self) -> Complex64 {
        self.0.first().copied().unwrap_or(Complex64::new(f64::NAN, f64::NAN))
    }

    pub(super) fn mean(&self) -> Complex64 {
        mean(self.0.iter())
    }

    /// Largest distance of the fundamental of a period from the mean over every so many periods, relative to
    /// the mean over all.
    pub(super) fn scatter(&self, multiple: usize) -> f64 {
        let whole = self.mean().norm();
        let every = |first: usize| self.0[first..].iter().step_by(multiple);
        let off = |first: usize| {
            let mean = mean(every(first));
            every(first).map(|one| (one - mean).norm() / whole).fold(0.0, f64::max)
        };
        (0..multiple.min(self.0.len())).map(off).fold(0.0, f64::max)
    }

    /// The motion, and its period in periods of the force if it has one. `before` is the scatter of the run
    /// before this one, and `stalled` counts the runs in a row that did not halve it.
    pub(super) fn motion(
        &self,
        before: &mut f64,
        stalled: &mut usize,
    ) -> (SteadyMotion, Option<usize>) {
        let longest = (self.0.len() / 4).clamp(1, MOST_MULTIPLE);
        if let Some(found) = (1..=longest).find(|&multiple| self.scatter(multiple) <= SETTLED) {
            let motion =
                if found == 1 { SteadyMotion::Periodic } else { SteadyMotion::Subharmonic };
            return (motion, Some(found));
        }
        let least =
            (1..=longest).map(|multiple| self.scatter(multiple)).fold(f64::INFINITY, f64::min);
        *stalled = if least > 0.5 * *before { *stalled + 1 } else { 0 };
        *before = least;
        let motion =
            if *stalled >= STALLED { SteadyMotion::NonPeriodic } else { SteadyMotion::NotSettled };
        (motion, None)
    }
}

fn mean<'a>(all: impl ExactSizeIterator<Item = &'a Complex64>) -> Complex64 {
    let count = all.len() as f64;
    all.sum::<Complex64>() / count
}

/// Complex amplitude of the fundamental in the samples of a period.
pub(super) fn fundamental(period: &[f64]) -> Complex64 {
    let turn = |n: usize| Complex64::cis(-TAU * n as f64 / period.len() as f64);
    let sum: Complex64 = period.iter().enumerate().map(|(n, u)| turn(n) * u).sum();
    sum * (2.0 / period.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The motion of a fundamental whose amplitude is a sequence, over doubled times.
    fn motion(next: impl Fn(f64) -> f64) -> (SteadyMotion, Option<usize>) {
        let (mut before, mut stalled) = (f64::INFINITY, 0);
        let mut periods = 64;
        loop {
            let mut amplitude = 0.3;
            let mut samples = Vec::new();
            for _ in 0..periods {
                amplitude = next(amplitude);
                let at = |n: usize| amplitude * (TAU * n as f64 / SAMPLES as f64).sin();
                samples.extend((0..SAMPLES).map(at));
            }
            let found = Fundamentals::of(&samples, SAMPLES).motion(&mut before, &mut stalled);
            if found.0 != SteadyMotion::NotSettled {
                return found;
            }
            periods *= 2;
        }
    }

    /// The logistic map has periods of 1, 2, 4 and 3, and none.
    #[test]
    fn periods_of_the_logistic_map_are_found() {
        let logistic = |r: f64| motion(move |x| r * x * (1.0 - x));
        assert_eq!(logistic(2.8), (SteadyMotion::Periodic, Some(1)));
        assert_eq!(logistic(3.3), (SteadyMotion::Subharmonic, Some(2)));
        assert_eq!(logistic(3.5), (SteadyMotion::Subharmonic, Some(4)));
        assert_eq!(logistic(3.835), (SteadyMotion::Subharmonic, Some(3)));
        assert_eq!(logistic(3.9), (SteadyMotion::NonPeriodic, None));
    }
}
