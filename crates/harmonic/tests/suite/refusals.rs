//! What cannot be computed says so, and what was computed before is kept.

use std::sync::Arc;

use asperity_harmonic::{
    BranchEnd, Contact, ContactSystem, Evaluation, HarmonicError, LinearSystem, ModalSystem,
    Oscillator, Path, Resolution, Settings, StepControl, trace,
};
use asperity_law::Hyperbolic;

use crate::rigs::{AREA, Law, MASS, PRESSURE, mass_on, reference_law};

fn settings() -> Settings {
    Settings { resolution: Resolution::Fixed { harmonics: 7, samples: 128 }, ..Settings::default() }
}

fn hyperbolic() -> ContactSystem {
    let law: Law = Arc::new(Hyperbolic::new(3e11, 1e-6).unwrap());
    mass_on(&law, Evaluation::Exact)
}

#[test]
fn paths_without_sense_are_refused() {
    let system = mass_on(&reference_law(), Evaluation::Exact);
    let path = |force, from, to| Path::Frequency { force, from, to };
    for path in [
        path(1.0, 800.0, 800.0),
        path(1.0, f64::NAN, 800.0),
        path(1.0, 700.0, f64::INFINITY),
        path(1.0, -700.0, 900.0),
        Path::Force { frequency: 900.0, from: 0.0, to: 1.0 },
        Path::Mode { near: 900.0, from: 1e-9, to: 1e-9 },
    ] {
        let error = trace(&system, &path, &settings()).unwrap_err();
        assert!(matches!(error, HarmonicError::EmptyRange { .. }), "{error}");
    }
    for path in [
        path(0.0, 700.0, 900.0),
        path(f64::NAN, 700.0, 900.0),
        Path::Force { frequency: f64::NAN, from: 0.1, to: 1.0 },
        Path::PhaseResonance { near: -1.0, from: 0.1, to: 1.0 },
    ] {
        let error = trace(&system, &path, &settings()).unwrap_err();
        assert!(matches!(error, HarmonicError::Setting { .. }), "{error}");
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let system = mass_on(&reference_law(), Evaluation::Exact);
    let path = Path::Frequency { force: 0.1, from: 800.0, to: 900.0 };
    let resolution = |resolution| Settings { resolution, ..settings() };
    for bad in [
        resolution(Resolution::Fixed { harmonics: 0, samples: 64 }),
        resolution(Resolution::Fixed { harmonics: 100_000, samples: 64 }),
        resolution(Resolution::Fixed { harmonics: 3, samples: usize::MAX }),
        resolution(Resolution::Automatic { tolerance: 0.0, most: 20 }),
        Settings { steps: StepControl { first: f64::NAN, ..StepControl::default() }, ..settings() },
        Settings { steps: StepControl { points: 0, ..StepControl::default() }, ..settings() },
    ] {
        let error = trace(&system, &path, &bad).unwrap_err();
        assert!(matches!(error, HarmonicError::Setting { .. }), "{error}");
    }
}

/// A force of 1e9 N asks the hyperbolic law for closures beyond its limit.
#[test]
fn absurd_forces_are_refused_by_name() {
    let path = Path::Frequency { force: 1e9, from: 767.0, to: 1054.0 };
    let error = trace(&hyperbolic(), &path, &settings()).unwrap_err();
    let HarmonicError::BeyondLaw { interface, .. } = &error else { panic!("{error}") };
    assert_eq!(interface, "contacts");
    assert!(error.to_string().contains("lower the force"));
}

/// Whatever a law without limit answers to 1e9 N, it is an answer: a branch or an error.
#[test]
fn absurd_forces_end_without_a_panic() {
    let system = mass_on(&reference_law(), Evaluation::default());
    let steps = StepControl { points: 200, ..StepControl::default() };
    for force in [1e3, 1e9, 1e300] {
        let path = Path::Frequency { force, from: 767.0, to: 1054.0 };
        match trace(&system, &path, &Settings { steps, ..settings() }) {
            Ok(branch) => assert!(!branch.points.is_empty()),
            Err(error) => assert!(error.to_string().contains("force"), "{error}"),
        }
    }
}

/// Rising forces reach the closure limit; the points before it are kept.
#[test]
fn a_branch_to_the_closure_limit_is_kept() {
    let path = Path::Force { frequency: 300.0, from: 0.1, to: 1e9 };
    let branch = trace(&hyperbolic(), &path, &settings()).unwrap();
    assert!(branch.points.len() > 10);
    assert!(!branch.is_complete());
    assert_ne!(branch.end, BranchEnd::PointLimit);
    for point in &branch.points {
        let highest = point.pressures[0].highest;
        assert!(highest.is_finite() && point.displacement.iter().all(|u| u.is_finite()));
    }
}

#[test]
fn the_point_limit_ends_a_branch() {
    let system = mass_on(&reference_law(), Evaluation::Exact);
    let path = Path::Frequency { force: 0.1, from: 800.0, to: 1000.0 };
    let steps = StepControl { points: 7, ..StepControl::default() };
    let branch = trace(&system, &path, &Settings { steps, ..settings() }).unwrap();
    assert_eq!((branch.points.len(), branch.end), (7, BranchEnd::PointLimit));
}

#[test]
fn systems_that_do_not_fit_are_refused() {
    let mass = Arc::new(Oscillator::new(MASS, 1.0).unwrap());
    let error = ContactSystem::new(mass, vec![]).unwrap_err();
    assert_eq!(error, HarmonicError::ContactCount { interfaces: 1, contacts: 0 });
    for bad in [0.0, -1.0, f64::NAN] {
        assert!(Oscillator::new(bad, 1.0).is_err());
        assert!(Contact::new("c", bad, PRESSURE, reference_law(), Evaluation::Exact).is_err());
    }
    assert!(Oscillator::new(1.0, -1.0).is_err());
    // No weight: a power law has no stiffness.
    let error = Contact::new("c", AREA, 0.0, reference_law(), Evaluation::Exact).unwrap_err();
    assert!(matches!(error, HarmonicError::NoStiffness { .. }));
    assert!(Contact::new("c", AREA, f64::NAN, reference_law(), Evaluation::Exact).is_err());
    let table = Evaluation::Tabulated(f64::NAN);
    let error = Contact::new("c", AREA, PRESSURE, reference_law(), table).unwrap_err();
    assert!(matches!(error, HarmonicError::Law { .. }));
    // Two rigid bodies, one contact that sees only one of them.
    let mut floating = ModalSystem::empty(1);
    floating.push(0.0, 0.0, &[1.0], 1.0);
    floating.push(0.0, 0.0, &[0.0], 0.0);
    assert_eq!(floating.check(), Err(HarmonicError::Floating { free: 2, held: 1 }));
}
