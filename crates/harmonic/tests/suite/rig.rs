//! The full rig, bars elastic, against time integration by finite differences.

use std::f64::consts::TAU;

use asperity_dynamics::{FiniteDifference, Sampling};
use asperity_harmonic::{
    ContactSystem, Continuation, FourierResolution, HarmonicSettings, LawEvaluation, Termination,
    trace,
};
use asperity_mesh::{Port, Support};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};

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
