//! The full rig, bars elastic, against time integration by finite differences.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use asperity_dynamics::{FiniteDifference, Sampling};
use asperity_harmonic::{
    Branch, ContactSystem, Continuation, Floquet, FourierResolution, HarmonicSettings,
    LawEvaluation, Termination, trace,
};
use asperity_mesh::{Port, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, SampledFunction, TimeFunction};

use crate::integration::harmonic;
use crate::rigs::{Law, exponential, modified, power, preloaded, rig};

/// Samples of the last period.
const SAMPLES: usize = 64;

/// Periods integrated: transients fall to 1e-9.
const PERIODS: usize = 100;

/// The rig on `law` with a damping ratio of 0.035.
fn damped(law: &Law) -> PreloadedStructure {
    PreloadedStructure::new(rig(law, Support::Rigid), Damping::Ratio(0.035)).unwrap()
}

/// Amplitudes of the first two harmonics by finite differences in cells of `cell` [m], and the
/// step [s].
fn integrated(law: &Law, force: f64, frequency: f64, cell: f64) -> ([f64; 2], f64) {
    let method = FiniteDifference { cell, ..FiniteDifference::default() };
    let sampling = Sampling::new(PERIODS as f64 / frequency, SAMPLES as f64 * frequency).unwrap();
    let shaker = LoadCase::force(TimeFunction::Harmonic { frequency }, force);
    let done = method.integrate(&damped(law), &shaker, &[Port::TOP], &sampling).unwrap();
    let last = &done.history.sensors[0].displacement[(PERIODS - 1) * SAMPLES..];
    ([harmonic(last, 1), harmonic(last, 2)], done.step)
}

/// Three laws at three levels, near the linear resonance, where softening is largest without jumps.
/// The scheme takes damping by a one-sided difference, so that its error near resonance falls with
/// the step alone, and two steps give the limit.
#[test]
fn three_laws_at_three_levels_equal_time_integration() {
    for (name, law) in
        [("power", power()), ("modified", modified()), ("exponential", exponential())]
    {
        let structure = damped(&law);
        let natural = structure.natural_frequency().unwrap();
        let system = ContactSystem::of_structure(&structure, LawEvaluation::default()).unwrap();
        let frequency = 1.02 * natural;
        for force in [0.1, 0.4, 0.9] {
            let continuation = Continuation::Force { frequency, from: 0.01, to: force };
            let found = trace(&system, &continuation, &HarmonicSettings::default()).unwrap();
            assert_eq!(found.termination, Termination::Reached);
            let point = found.points.last().unwrap();
            let (coarse, long) = integrated(&law, force, frequency, 1e-3);
            let (fine, short) = integrated(&law, force, frequency, 0.5e-3);
            for k in [1, 2] {
                let limit = fine[k - 1] + (fine[k - 1] - coarse[k - 1]) * short / (long - short);
                let off = (point.amplitude(k) / limit - 1.0).abs();
                // Remaining error of the finite differences: their table of the law, 1e-6.
                assert!(off < 2e-5, "{name} at {force} N, harmonic {k}: {off:.1e}");
            }
        }
    }
}

/// The linearised resonance is the lowest mode of the preloaded structure.
#[test]
fn resonance_is_the_first_mode() {
    let structure = preloaded(rig(&power(), Support::Rigid), 1.0);
    let natural = structure.natural_frequency().unwrap();
    let system = ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap();
    let continuation = Continuation::Mode { near: 900.0, from: 1e-13, to: 2e-13 };
    let mode = trace(&system, &continuation, &HarmonicSettings::default()).unwrap();
    let ratio = mode.points[0].frequency_hz() / natural;
    // Amplitudes of 1e-13 m shift it by 1e-14; rounding of the light sample is more.
    assert!((ratio - 1.0).abs() < 1e-10, "{ratio}");
    assert!((mode.points[0].damping_ratio() * 2.0 * TAU * natural - 1.0).abs() < 1e-6);
    // The guide bar moves nearly as a whole.
    assert!((mode.points[0].modal_mass / 1.61 - 1.0).abs() < 0.05);
}

/// Loss of contact on the rig: the force is not smooth, and harmonics excite the sample's mode near
/// 33 kHz.
#[test]
fn loss_of_contact_equals_time_integration() {
    let law = power();
    let system = ContactSystem::of_structure(&damped(&law), LawEvaluation::default()).unwrap();
    let (frequency, force) = (945.0, 2.5);
    let continuation = Continuation::Force { frequency, from: 0.01, to: force };
    let resolution = FourierResolution::Automatic { tolerance: 1e-4, most: 60 };
    let found = trace(
        &system,
        &continuation,
        &HarmonicSettings { resolution, ..HarmonicSettings::default() },
    )
    .unwrap();
    let point = found.points.last().unwrap();
    assert!(found.is_complete() && point.contact_lost());
    let (coarse, long) = integrated(&law, force, frequency, 1e-3);
    let (fine, short) = integrated(&law, force, frequency, 0.5e-3);
    for k in [1, 2] {
        let limit = fine[k - 1] + (fine[k - 1] - coarse[k - 1]) * short / (long - short);
        let off = (point.amplitude(k) / limit - 1.0).abs();
        assert!(off < 1e-5, "harmonic {k}: {off:.1e}");
    }
}

/// Under a large force the light sample is parametrically unstable while contact holds: the stiffness under it falls
/// so low in every period that its vibration at some 35 kHz is excited. At 1100 Hz the period doubles from 22.08 N on.
/// In time integration under a force that rises slowly, the difference of successive periods grows by the largest
/// multiplier, which is negative, or dies out.
#[test]
fn the_sample_is_unstable_under_a_large_force_while_contact_holds() {
    const RISE: usize = 60;
    const HOLD: usize = 60;
    let frequency = 1100.0;
    let structure = damped(&modified());
    let system = ContactSystem::of_structure(&structure, LawEvaluation::default()).unwrap();
    let settings = HarmonicSettings {
        resolution: FourierResolution::Fixed { harmonics: 20, samples: 320 },
        stability: Some(Floquet::default()),
        ..HarmonicSettings::default()
    };
    for (force, stable) in [(20.0, true), (24.0, false), (28.0, false)] {
        let path = Continuation::Force { frequency, from: 1.0, to: force };
        let found = trace(&system, &path, &settings).unwrap();
        let point = found.points.last().unwrap();
        assert!(found.is_complete() && !point.contact_lost());
        assert_eq!(point.stable(), Some(stable), "{force} N");
        let (from, to) = (1110.0, 1090.0);
        let around =
            trace(&system, &Continuation::Frequency { force, from, to }, &settings).unwrap();
        let beyond = [[1080.0, if stable { to } else { from }]];
        assert_eq!(Branch::ranges_without_stable([&around], from, 1080.0), beyond, "{force} N");
        assert_eq!(
            Branch::ranges_without_stable([&around], from, to).is_empty(),
            stable,
            "{force} N"
        );
        assert_eq!(around.highest_stable().is_some(), stable, "{force} N");

        let periods = (0..=(RISE + HOLD) * 200).map(|n| n as f64 / 200.0);
        let share = |t: f64| 0.5 - 0.5 * (PI * (t / RISE as f64).min(1.0)).cos();
        let values = periods.clone().map(|t| share(t) * (TAU * t).sin()).collect();
        let times = periods.map(|t| t / frequency).collect();
        let shape = TimeFunction::Samples(Arc::new(SampledFunction::new(times, values).unwrap()));
        let duration = (RISE + HOLD) as f64 / frequency;
        let sampling = Sampling::new(duration, SAMPLES as f64 * frequency).unwrap();
        let top_of_sample = Port::Point { body: 1, position: 0.0 };
        let load = LoadCase::force(shape, force);
        let method = FiniteDifference::default();
        let done = method.integrate(&structure, &load, &[top_of_sample], &sampling).unwrap();
        let u = &done.history.sensors[0].displacement;
        let change = |period: usize| u[SAMPLES * (period + 1)] - u[SAMPLES * period];
        if stable {
            let last = (RISE + HOLD - 10..RISE + HOLD - 1).map(|n| change(n).abs());
            assert!(last.fold(0.0, f64::max) < 1e-6 * point.amplitude(1), "{force} N");
            continue;
        }
        // While the difference is small.
        let ratio: f64 = change(RISE + 16) / change(RISE + 10);
        assert!(change(RISE + 10) * change(RISE + 11) < 0.0, "{force} N");
        let largest = point.multipliers.as_ref().unwrap()[0];
        let off = ratio.powf(1.0 / 6.0) / -largest.re - 1.0;
        assert!(largest.im == 0.0 && off.abs() < 1e-2, "{force} N: {largest}, {off:.1e}");
    }
}
