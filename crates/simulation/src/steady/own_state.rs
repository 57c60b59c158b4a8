//! A response of a branch, integrated in time from its own state.

use std::f64::consts::{FRAC_PI_2, TAU};

use asperity_dynamics::{Batch, PeriodicMotion};
use asperity_harmonic::PeriodicResponse;

use super::check::TimeCheck;
use super::motion::{IntegratedMotion, motion_by};
use super::settled::SteadyMotion;
use crate::assemble::Assembly;

/// Samples of the pressures over a period.
const SAMPLES: usize = 1024;

/// Steps of the time integration are these parts of the first step for a single hit, one after the other until
/// the energy balance closes.
const STEPS: [f64; 3] = [0.25, 0.125, 0.0625];

impl TimeCheck {
    /// The motion that `response` turns into; none where contacts are damped or rub, where no step closes the
    /// energy balance, and for a response of other contacts than those of the structure, as where light bodies were
    /// [condensed](super::Condensation): the state of these is not known.
    ///
    /// Time integration takes the modes that a hit excites. It starts in the motion of the response, so that it
    /// stays on this one of several, and goes on until the fundamental no longer changes, or scatters for good.
    ///
    /// Next to a fold the steps may move the fold beyond the response, by as much as they change natural frequencies; the
    /// motion then is another one.
    pub fn from_own_state(assembly: &Assembly, response: &PeriodicResponse) -> Option<Self> {
        if response.pressures.len() != assembly.structure.contacts().len() {
            return None;
        }
        let motion = periodic_motion(assembly, response);
        let (force, frequency_hz) = (response.force, response.frequency_hz());
        let from_state = |share: &f64| {
            let run = |case: &_| Batch::default().run_from(case, &motion);
            motion_by(assembly, (force, frequency_hz), *share, run).ok()
        };
        let found: IntegratedMotion = STEPS.iter().find_map(from_state)?;
        let amplitude_1_m = response.at_sensor(0, 1).norm();
        let integrated_1_m = found.amplitude_1_m;
        Some(Self {
            frequency_hz,
            amplitude_1_m,
            integrated_1_m,
            relative_difference: (amplitude_1_m / integrated_1_m - 1.0).abs(),
            settled: found.motion == SteadyMotion::Periodic,
            motion: found.motion,
            scatter: found.scatter,
        })
    }
}

/// The motion of the contacts over a period from where the load is zero and rises.
fn periodic_motion(assembly: &Assembly, response: &PeriodicResponse) -> PeriodicMotion {
    let contacts = assembly.structure.contacts().iter().enumerate();
    let (pressures, mean_closures) = contacts
        .map(|(i, contact)| {
            let phase = |n: usize| TAU * n as f64 / SAMPLES as f64 - FRAC_PI_2;
            let closures = (0..SAMPLES).map(|n| response.closure_at(i, phase(n))[0]);
            let pressure = |closure: f64| contact.pressure_at(closure) - contact.pressure();
            let mean = closures.clone().sum::<f64>() / SAMPLES as f64;
            (closures.map(pressure).collect(), mean)
        })
        .unzip();
    PeriodicMotion { pressures, mean_closures }
}
