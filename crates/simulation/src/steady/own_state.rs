//! A response of a branch, integrated in time from its own state.

use std::f64::consts::{FRAC_PI_2, TAU};

use asperity_dynamics::{Batch, PeriodicMotion};
use asperity_harmonic::PeriodicResponse;
use asperity_structure::PreloadedContact;

use super::bodies::Condensation;
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
    /// The motion that `response` turns into; none where contacts are damped or rub, and where no step closes the
    /// energy balance.
    ///
    /// Time integration takes the modes that a hit excites, the light bodies of a condensed branch with
    /// their inertia. It starts in the motion of the response, so that it stays on this one of several, and goes on
    /// until the fundamental no longer changes, or scatters for good.
    pub(super) fn from_own_state(
        assembly: &Assembly,
        response: &PeriodicResponse,
        condensed: Option<&Condensation>,
    ) -> Option<Self> {
        let motion = periodic_motion(assembly, response, condensed);
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
fn periodic_motion(
    assembly: &Assembly,
    response: &PeriodicResponse,
    condensed: Option<&Condensation>,
) -> PeriodicMotion {
    let contacts = assembly.structure.contacts();
    let at = |n: usize| -> Vec<[f64; 2]> {
        let phase = TAU * n as f64 / SAMPLES as f64 - FRAC_PI_2;
        if let Some(condensed) = condensed {
            return condensed.light.interfaces_at(response, phase);
        }
        let of = |(i, contact): (usize, &PreloadedContact)| {
            let [closure, ..] = response.closure_at(i, phase);
            [contact.pressure_at(closure) - contact.pressure(), closure]
        };
        contacts.iter().enumerate().map(of).collect()
    };
    let all: Vec<Vec<[f64; 2]>> = (0..SAMPLES).map(at).collect();
    let column = |i: usize, which: usize| all.iter().map(move |row| row[i][which]);
    PeriodicMotion {
        pressures: (0..contacts.len()).map(|i| column(i, 0).collect()).collect(),
        mean_closures: (0..contacts.len())
            .map(|i| column(i, 1).sum::<f64>() / SAMPLES as f64)
            .collect(),
    }
}
