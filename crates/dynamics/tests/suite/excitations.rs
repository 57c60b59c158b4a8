//! Every excitation: records against the pulses they sample, the harmonic force
//! against the damped bars' dynamic stiffness in closed form.

use crate::support::bar_chain::receptance;
use crate::support::receptance::transform;
use crate::support::{DISC, constant, difference, modified, rig, rig_on, run, run_at, slope};
use asperity_dynamics::{FiniteDifference, Integrator, Modal};
use asperity_mesh::Stack;
use asperity_structure::{LoadCase, SampledFunction, TimeFunction};

fn pulses() -> impl Iterator<Item = LoadCase> {
    let functions = [
        TimeFunction::GammaPulse { rise: 0.34e-3 },
        TimeFunction::HalfSine { duration: 1e-3 },
        TimeFunction::Haversine { duration: 1e-3 },
    ];
    functions.into_iter().map(|function| LoadCase::force(function, 20.0))
}

/// A record of `pulse` every `interval` [s], to its end.
fn record(pulse: &LoadCase, interval: f64) -> LoadCase {
    let samples = (pulse.ends_at() / interval).round() as usize;
    let time: Vec<f64> = (0..=samples).map(|n| n as f64 * interval).collect();
    let force = time.iter().map(|&t| pulse.value(t)).collect();
    LoadCase::samples(&SampledFunction::new(time, force).unwrap())
}

/// Finite differences of `cell` \[m\], and modal steps fine enough for as much.
fn methods(cell: f64) -> [Integrator; 2] {
    let modal = Modal { step: Some(1e-6), modes_per_body: Some(8), ..Modal::default() };
    [FiniteDifference { cell, ..FiniteDifference::default() }.into(), modal.into()]
}

/// A record is linear between its samples: slope 2 in their interval.
#[test]
fn a_record_acts_as_the_pulse_it_was_sampled_from() {
    let stack = rig(&modified());
    let cases = pulses().flat_map(|pulse| methods(2e-3).map(|m| (pulse.clone(), m)));
    for (pulse, method) in cases {
        let exact = run(&stack, &method, &pulse, 0.01).history;
        let intervals = [50e-6, 25e-6, 12.5e-6];
        let errors = intervals.map(|interval| {
            let found = run(&stack, &method, &record(&pulse, interval), 0.01).history;
            difference(&found.sensors[0].displacement, &exact.sensors[0].displacement)
        });
        let order = slope(&intervals, &errors);
        assert!((1.9..2.1).contains(&order), "{pulse:?}: {errors:?}");
    }
}

/// The history reports the force that acts, from its first sample on.
#[test]
fn the_force_of_the_history_is_the_excitation() {
    let stack = rig(&modified());
    let harmonic = LoadCase::force(TimeFunction::Harmonic { frequency: 700.0 }, 3.0);
    let excitations = pulses().chain([harmonic, LoadCase::none()]);
    let cases = excitations.flat_map(|excitation| methods(4e-3).map(|m| (excitation.clone(), m)));
    for (excitation, method) in cases {
        let history = run(&stack, &method, &excitation, 2e-3).history;
        for (&time, &force) in history.time.iter().zip(&history.load) {
            // Times are products of step and count: off by round-off.
            assert!((force - excitation.value(time)).abs() < 1e-9, "{excitation:?} at {time}");
        }
        let moved = history.sensors[0].displacement.iter().any(|&u| u != 0.0);
        assert_eq!(moved, excitation != LoadCase::none());
    }
}

/// A force that is there from the start: the first step takes half of it, so
/// that a free rigid motion follows `F t^2 / 2 m` from the first sample on, and
/// the first acceleration is that of the top's end node.
#[test]
fn a_force_that_starts_at_once_starts_the_motion_right() {
    let stack = rig(&constant());
    let step_force = |duration: f64| {
        LoadCase::samples(&SampledFunction::new(vec![0.0, duration], vec![5.0, 5.0]).unwrap())
    };
    let method = FiniteDifference::default();
    let run = run_at(&stack, &method, 0.0, &step_force(1.0), (0.05, 2e5));
    // Undamped, the top swings about its new rest: mean = F times the static receptance.
    let mean = run.history.sensors[0].displacement.iter().sum::<f64>()
        / run.history.sensors[0].displacement.len() as f64;
    let at_rest = 5.0 * receptance(&stack, &[8.5e11; 2], 0.0, 1e-3).re;
    // 41.6 periods of the fundamental: the part left over is below 1 / (2 pi 41).
    assert!((mean / at_rest - 1.0).abs() < 5e-3);
    assert!(run.energy.residual_relative() < 1e-10);
    let node = 0.5 * 1.61 / 229.0;
    assert!((run.history.sensors[0].acceleration[0] / (5.0 / node) - 1.0).abs() < 1e-9);
}

/// Amplitude and phase of the steady state under a sine, off, at and above
/// resonance, against the exact receptance of damped bars.
#[test]
fn a_harmonic_force_reaches_the_exact_steady_state() {
    let cases: [(&str, Stack); 2] =
        [("rigid", rig(&constant())), ("disc", rig_on(&constant(), DISC))];
    for (name, stack, method) in cases.iter().flat_map(|(n, s)| methods(1e-3).map(|m| (n, s, m))) {
        for frequency in [400.0, 800.0, 1600.0] {
            let excitation = LoadCase::force(TimeFunction::Harmonic { frequency }, 2.0);
            // Samples that divide the period; a rate of 400 1/s leaves exp(-200 t) of the start.
            let (periods, a_period) = (10, 400);
            let start = (0.1 * frequency).ceil();
            let duration = (start + f64::from(periods)) / frequency;
            let sampling = (duration, frequency * f64::from(a_period));
            let history = run_at(stack, &method, 400.0, &excitation, sampling).history;
            let from = history.time.len() - (periods * a_period) as usize;
            let interval = history.time[1];
            let steady = transform(&history.sensors[0].displacement[from..], interval, frequency);
            let force = transform(&history.load[from..], interval, frequency);
            let found = steady / force;
            let exact = receptance(stack, &[8.5e11; 2], 400.0, frequency);
            let off = (found - exact).norm() / exact.norm();
            // The one-sided damping adds h dt / 2 = 3e-5 to the mass, which near
            // resonance acts 1 / (2 zeta) = 13 times enlarged.
            assert!(off < 5e-4, "{name} {frequency} Hz: {off}");
        }
    }
}

/// The closed form itself, far below resonance: bars and contacts are springs in series.
#[test]
fn the_closed_form_receptance_tends_to_the_static_compliance() {
    let soft = receptance(&rig(&constant()), &[8.5e11; 2], 0.0, 1e-3).re;
    let guide = 0.229_f64 / (71e9 * 1.61 / (2710.0 * 0.229));
    let springs = 2.0 / (8.5e11 * crate::support::AREA) + 0.015 / (71e9 * crate::support::AREA);
    assert!((soft / (guide + springs) - 1.0).abs() < 1e-9);
}
