//! Motions under a harmonic force by time integration, where a branch does not tell them.

use std::sync::Arc;

use asperity_dynamics::{
    Batch, CaseResponse, Decimation, DynamicsError, Modal, Sampling, TransientCase,
};
use asperity_structure::{LoadCase, TimeFunction};
use rayon::prelude::*;
use serde::Serialize;

use super::settled::{Fundamentals, SteadyMotion, first_periods};
use crate::assemble::Assembly;

/// Number of frequencies at which a branch is asked for its motions.
const FREQUENCIES: u32 = 5;

/// Steps of the time integration are these parts of the first step for a single hit, one after the other until
/// the energy balance closes.
const STEPS: [f64; 3] = [0.5, 0.25, 0.125];

/// Most integration steps of a frequency: some seconds.
const MOST_STEPS: f64 = 5e6;

/// Share of the time without contact from which bodies are apart.
const APART: f64 = 0.99;

/// A motion under a harmonic force, from rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct IntegratedMotion {
    /// Frequency \[Hz\].
    pub frequency_hz: f64,
    /// The motion.
    pub motion: SteadyMotion,
    /// Its period in periods of the force; none for a motion without one.
    pub periods: Option<usize>,
    /// Amplitude of the mean fundamental of the first sensor over the last periods \[m\].
    pub amplitude_1_m: f64,
    /// Largest relative distance of the fundamental of a period from the mean.
    pub scatter: f64,
    /// Largest share of the time during which contact is lost at an interface, over the second half; none
    /// where the time was not doubled.
    pub lost_share: Option<f64>,
}

/// The motions at five frequencies spread over `ranges` \[Hz\], in parallel; those that cannot be integrated are left
/// out.
pub(super) fn motions(
    assembly: &Assembly,
    force: f64,
    ranges: &[[f64; 2]],
) -> Vec<IntegratedMotion> {
    let at = |frequency| {
        let mut tried = STEPS.iter().map(|&share| motion(assembly, force, frequency, share));
        tried.find_map(Result::ok)
    };
    spread(ranges).into_par_iter().filter_map(at).collect()
}

/// Frequencies at equal distances over the joined length of some ranges \[Hz\].
fn spread(ranges: &[[f64; 2]]) -> Vec<f64> {
    let whole: f64 = ranges.iter().map(|[low, high]| high - low).sum();
    let place = |n: u32| {
        let mut left = whole * (f64::from(n) + 0.5) / f64::from(FREQUENCIES);
        let inside = |[low, high]: &[f64; 2]| {
            let length = high - low;
            let found = (left <= length).then_some(low + left);
            left -= length;
            found
        };
        ranges.iter().find_map(inside)
    };
    (0..FREQUENCIES).filter_map(place).collect()
}

/// The motion at one frequency \[Hz\] from rest, in steps of this share of the first step for a single hit.
fn motion(
    assembly: &Assembly,
    force: f64,
    frequency: f64,
    share: f64,
) -> Result<IntegratedMotion, DynamicsError> {
    let every_step = Decimation::every_step();
    motion_by(assembly, (force, frequency), share, |case| {
        let cases = std::slice::from_ref(case);
        Batch::default().run(cases, &|_, _| Arc::clone(&every_step)).swap_remove(0)
    })
}

/// The motion under a force of this amplitude \[N\] and frequency \[Hz\] as `run` integrates it. The time is
/// doubled while the fundamental changes, up to 5e6 steps or until the motion counts as not periodic.
pub(super) fn motion_by(
    assembly: &Assembly,
    (force, frequency): (f64, f64),
    share: f64,
    run: impl Fn(&TransientCase) -> Result<CaseResponse, DynamicsError>,
) -> Result<IntegratedMotion, DynamicsError> {
    let mut periods = first_periods(assembly, frequency);
    let shaker = LoadCase::force(TimeFunction::Harmonic { frequency }, force);
    let shaker = shaker.at(assembly.load.port());
    let sampling = Sampling::new(periods / frequency, 64.0 * frequency)?;
    let sensor = &assembly.sensor_ports()[..1];
    let template = Modal::default().case(&assembly.structure, &shaker, sensor, &sampling)?;
    let (step, _) = template.first_step()?;
    let steps = (1.0 / (frequency * share * step)).ceil();
    let over = |periods: f64| {
        let (duration, step) = (periods / frequency, Some(1.0 / (frequency * steps)));
        run(&TransientCase { duration, step, ..template.clone() })
    };
    let mut before = over(periods)?;
    let (mut scatter, mut stalled) = (f64::INFINITY, 0);
    loop {
        let last = 2.0 * periods * steps > MOST_STEPS;
        let response = if last { before.clone() } else { over(2.0 * periods)? };
        let whole = response.displacement.len() / steps as usize;
        let samples = &response.displacement[..whole * steps as usize];
        let found = Fundamentals::of(samples, steps as usize);
        let (motion, count) = found.motion(&mut scatter, &mut stalled);
        if motion != SteadyMotion::NotSettled || last {
            let half = periods / frequency;
            let lost = response.contacts.iter().zip(&before.contacts);
            let lost = lost.map(|(all, first)| (all.lost - first.lost) / half);
            let lost_share = (!last).then(|| lost.fold(0.0, f64::max));
            let apart = lost_share.is_some_and(|share| share >= APART);
            return Ok(IntegratedMotion {
                frequency_hz: frequency,
                motion: if apart { SteadyMotion::Apart } else { motion },
                periods: count.filter(|_| !apart),
                amplitude_1_m: found.mean().norm(),
                scatter: found.scatter(1),
                lost_share,
            });
        }
        (before, periods) = (response, 2.0 * periods);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]
mod tests {
    use std::f64::consts::TAU;

    use asperity_scenario::Document;

    use num_complex::Complex64;

    use super::*;

    const MASS: f64 = 1.61;
    const AREA: f64 = 1.15e-4;
    const STIFFNESS: f64 = 1e12;
    const RATIO: f64 = 0.03;
    const A_PERIOD: usize = 2000;

    /// The mass on its spring, which only pushes, from rest by the classical Runge-Kutta method: the fundamentals of
    /// the last 60 of 300 periods, the last first, and the share of the time that contact is lost.
    fn integrated(force: f64, frequency: f64) -> (Vec<Complex64>, f64) {
        let (k, weight, w) = (AREA * STIFFNESS, MASS * 9.81, TAU * frequency);
        let rate = 2.0 * RATIO * (k / MASS).sqrt();
        let slope = |t: f64, [u, v]: [f64; 2]| {
            let held = (weight + k * u).max(0.0) - weight;
            [v, (force * (w * t).sin() - held) / MASS - rate * v]
        };
        let dt = 1.0 / (frequency * A_PERIOD as f64);
        let ahead = |x: [f64; 2], k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
        let (mut state, mut samples, mut open) = ([0.0; 2], Vec::new(), 0);
        for n in 0..300 * A_PERIOD {
            let t = n as f64 * dt;
            if n >= 240 * A_PERIOD {
                samples.push(state[0]);
                open += usize::from(weight + k * state[0] < 0.0);
            }
            let a = slope(t, state);
            let b = slope(t + 0.5 * dt, ahead(state, a, 0.5 * dt));
            let c = slope(t + 0.5 * dt, ahead(state, b, 0.5 * dt));
            let d = slope(t + dt, ahead(state, c, dt));
            for i in 0..2 {
                state[i] += dt / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
            }
        }
        let share = open as f64 / samples.len() as f64;
        (samples.rchunks_exact(A_PERIOD).map(crate::steady::settled::fundamental).collect(), share)
    }

    #[test]
    fn frequencies_are_spread_over_ranges() {
        assert_eq!(spread(&[]), Vec::<f64>::new());
        assert_eq!(spread(&[[10.0, 12.0], [20.0, 23.0]]), [10.5, 11.5, 20.5, 21.5, 22.5]);
    }

    /// Under six tenths of its weight above resonance a mass on a spring that only pushes has the period of the force;
    /// under its weight below resonance, three periods.
    #[test]
    fn a_bouncing_mass_repeats_after_one_and_after_three_periods() {
        let scenario = serde_json::json!({
            "schema": "asperity/scenario/1",
            "bodies": [{"name": "mass", "length_m": 0.01, "mass_kg": MASS,
                "youngs_modulus_pa": 2e11, "density_kg_per_m3": 7850}],
            "interfaces": [{"name": "spring", "area_m2": AREA, "law":
                {"kind": "constant", "stiffness_pa_per_m": STIFFNESS, "unilateral": true}}],
            "damping": {"kind": "mass_proportional", "ratio": RATIO},
            "duration_s": 0.1
        });
        let document = Document::parse(&scenario.to_string(), "mass.json").unwrap();
        let assembly = Assembly::new(&document.scenario().unwrap(), document.folder()).unwrap();
        let natural = (AREA * STIFFNESS / MASS).sqrt() / TAU;
        for (share, ratio, periods) in [(0.6, 1.2, 1), (1.0, 0.9, 3)] {
            let (force, frequency) = (share * MASS * 9.81, ratio * natural);
            let (fundamentals, lost) = integrated(force, frequency);
            for n in 0..50 {
                let again = |m: usize| (fundamentals[n] - fundamentals[n + m]).norm();
                let size = fundamentals[n].norm();
                assert!(again(periods) < 1e-6 * size && (periods == 1 || again(1) > 0.1 * size));
            }
            let mean = fundamentals.iter().sum::<Complex64>() / fundamentals.len() as f64;
            let found = motion(&assembly, force, frequency, STEPS[0]).unwrap();
            assert_eq!(found.periods, Some(periods), "{found:?}");
            let expected =
                if periods == 1 { SteadyMotion::Periodic } else { SteadyMotion::Subharmonic };
            assert_eq!(found.motion, expected);
            let off = (found.amplitude_1_m / mean.norm() - 1.0).abs();
            assert!(off < 1e-2, "{ratio}: {off:.1e}");
            let found = found.lost_share.unwrap();
            assert!((found - lost).abs() < 1e-2, "{ratio}: {found} {lost}");
        }
    }
}
