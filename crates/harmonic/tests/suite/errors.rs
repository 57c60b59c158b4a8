//! Errors of requests out of range, and branches that end early.

use std::sync::Arc;

use asperity_harmonic::{
    ContactSystem, Continuation, FourierResolution, HarmonicError, HarmonicSettings, LawEvaluation,
    RigidMass, StepControl, Termination, trace,
};
use asperity_law::Hyperbolic;
use asperity_structure::PreloadedContact;

use crate::rigs::{AREA, Law, MASS, PRESSURE, mass_on, reference_law};

fn settings() -> HarmonicSettings {
    HarmonicSettings {
        resolution: FourierResolution::Fixed { harmonics: 7, samples: 128 },
        ..HarmonicSettings::default()
    }
}

fn hyperbolic() -> ContactSystem {
    let law: Law = Arc::new(Hyperbolic::new(3e11, 1e-6).unwrap());
    mass_on(&law, LawEvaluation::Exact)
}

#[test]
fn continuations_out_of_range_are_errors() {
    let system = mass_on(&reference_law(), LawEvaluation::Exact);
    let continuation = |force, from, to| Continuation::Frequency { force, from, to };
    for continuation in [
        continuation(1.0, 800.0, 800.0),
        continuation(1.0, f64::NAN, 800.0),
        continuation(1.0, 700.0, f64::INFINITY),
        continuation(1.0, -700.0, 900.0),
        Continuation::Force { frequency: 900.0, from: 0.0, to: 1.0 },
        Continuation::Mode { near: 900.0, from: 1e-9, to: 1e-9 },
    ] {
        let error = trace(&system, &continuation, &settings()).unwrap_err();
        assert!(matches!(error, HarmonicError::EmptyRange { .. }), "{error}");
    }
    for continuation in [
        continuation(0.0, 700.0, 900.0),
        continuation(f64::NAN, 700.0, 900.0),
        Continuation::Force { frequency: f64::NAN, from: 0.1, to: 1.0 },
        Continuation::PhaseResonance { near: -1.0, from: 0.1, to: 1.0 },
    ] {
        let error = trace(&system, &continuation, &settings()).unwrap_err();
        assert!(matches!(error, HarmonicError::Setting { .. }), "{error}");
    }
}

#[test]
fn settings_out_of_range_are_errors() {
    let system = mass_on(&reference_law(), LawEvaluation::Exact);
    let continuation = Continuation::Frequency { force: 0.1, from: 800.0, to: 900.0 };
    let resolution = |resolution| HarmonicSettings { resolution, ..settings() };
    for bad in [
        resolution(FourierResolution::Fixed { harmonics: 0, samples: 64 }),
        resolution(FourierResolution::Fixed { harmonics: 100_000, samples: 64 }),
        resolution(FourierResolution::Fixed { harmonics: 3, samples: usize::MAX }),
        resolution(FourierResolution::Automatic { tolerance: 0.0, most: 20 }),
        HarmonicSettings {
            steps: StepControl { first: f64::NAN, ..StepControl::default() },
            ..settings()
        },
        HarmonicSettings {
            steps: StepControl { points: 0, ..StepControl::default() },
            ..settings()
        },
    ] {
        let error = trace(&system, &continuation, &bad).unwrap_err();
        assert!(matches!(error, HarmonicError::Setting { .. }), "{error}");
    }
}

/// A force of 1e9 N needs closures beyond the limit of the hyperbolic law.
#[test]
fn a_force_beyond_the_law_is_an_error_that_names_the_contact() {
    let continuation = Continuation::Frequency { force: 1e9, from: 767.0, to: 1054.0 };
    let error = trace(&hyperbolic(), &continuation, &settings()).unwrap_err();
    let HarmonicError::BeyondLaw { interface, .. } = &error else { panic!("{error}") };
    assert_eq!(interface, "contacts");
    assert!(error.to_string().contains("lower the force"));
}

/// A law without limit gives a branch or an error at 1e9 N, no panic.
#[test]
fn extreme_forces_end_without_a_panic() {
    let system = mass_on(&reference_law(), LawEvaluation::default());
    let steps = StepControl { points: 200, ..StepControl::default() };
    for force in [1e3, 1e9, 1e300] {
        let continuation = Continuation::Frequency { force, from: 767.0, to: 1054.0 };
        match trace(&system, &continuation, &HarmonicSettings { steps, ..settings() }) {
            Ok(branch) => assert!(!branch.points.is_empty()),
            Err(error) => assert!(error.to_string().contains("force"), "{error}"),
        }
    }
}

/// Rising forces reach the closure limit; the points before it are kept.
#[test]
fn a_branch_to_the_closure_limit_is_kept() {
    let continuation = Continuation::Force { frequency: 300.0, from: 0.1, to: 1e9 };
    let branch = trace(&hyperbolic(), &continuation, &settings()).unwrap();
    assert!(branch.points.len() > 10);
    assert!(!branch.is_complete());
    assert_ne!(branch.termination, Termination::PointLimit);
    for point in &branch.points {
        let highest = point.pressures[0].highest;
        assert!(highest.is_finite() && point.displacement.iter().all(|u| u.is_finite()));
    }
}

#[test]
fn the_point_limit_ends_a_branch() {
    let system = mass_on(&reference_law(), LawEvaluation::Exact);
    let continuation = Continuation::Frequency { force: 0.1, from: 800.0, to: 1000.0 };
    let steps = StepControl { points: 7, ..StepControl::default() };
    let branch = trace(&system, &continuation, &HarmonicSettings { steps, ..settings() }).unwrap();
    assert_eq!((branch.points.len(), branch.termination), (7, Termination::PointLimit));
}

#[test]
fn systems_that_do_not_fit_are_errors() {
    let mass = Arc::new(RigidMass::new(MASS, 1.0).unwrap());
    let on = |contacts, evaluation| ContactSystem::new(mass.clone(), contacts, evaluation);
    let error = on(vec![], LawEvaluation::Exact).unwrap_err();
    assert_eq!(error, HarmonicError::ContactCount { interfaces: 1, contacts: 0 });
    for bad in [0.0, -1.0, f64::NAN] {
        assert!(RigidMass::new(bad, 1.0).is_err());
    }
    assert!(RigidMass::new(1.0, -1.0).is_err());
    // No weight: a power law has no stiffness.
    let at = |pressure| PreloadedContact::new("c", AREA, reference_law(), pressure).unwrap();
    let error = on(vec![at(0.0)], LawEvaluation::Exact).unwrap_err();
    assert!(matches!(error, HarmonicError::NoStiffness { .. }));
    let error = on(vec![at(PRESSURE)], LawEvaluation::Tabulated(f64::NAN)).unwrap_err();
    assert!(matches!(error, HarmonicError::Setting { .. }));
}
