//! Settings out of range are refused with the error that says so.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

mod support;

use std::sync::Arc;

use asperity_dynamics::{
    DynamicsError, Equilibrium, Excitation, FiniteDifference, ForceRecord, InstructionSet, Sampling,
};
use asperity_law::Hyperbolic;
use asperity_mesh::{MeshError, Stack};
use support::{Law, modified, pulse, rig};

fn attempt(
    stack: &Stack,
    method: FiniteDifference,
    rate: f64,
    excitation: &Excitation,
) -> Result<(), DynamicsError> {
    let equilibrium = Equilibrium::of(stack).unwrap();
    let sampling = Sampling::new(1e-3, 2e5).unwrap();
    method.integrate(stack, &equilibrium, rate, excitation, &sampling, &|_| ()).map(|_| ())
}

fn with(change: impl Fn(&mut FiniteDifference)) -> Result<(), DynamicsError> {
    let mut method = FiniteDifference::default();
    change(&mut method);
    attempt(&rig(&modified()), method, 352.0, &pulse(9.0))
}

#[test]
fn what_is_in_range_is_accepted() {
    assert_eq!(with(|_| ()), Ok(()));
    assert_eq!(with(|method| method.courant = 0.999), Ok(()));
    assert_eq!(with(|method| method.cell = 1.0), Ok(()));
}

/// Eq. (3).
#[test]
fn a_courant_number_outside_zero_to_one_is_refused() {
    for courant in [1.0, 1.5, 0.0, -0.5] {
        let refused = with(|method| method.courant = courant);
        assert_eq!(refused, Err(DynamicsError::Mesh(MeshError::Courant { courant })));
    }
    let refused = with(|method| method.courant = f64::NAN);
    assert!(matches!(refused, Err(DynamicsError::Mesh(MeshError::Courant { .. }))));
}

#[test]
fn a_cell_that_is_no_length_is_refused() {
    for cell in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let refused = with(|method| method.cell = cell);
        assert!(matches!(refused, Err(DynamicsError::Mesh(MeshError::NotPositive { .. }))));
    }
    let refused = with(|method| method.cell = 1e-15);
    assert!(matches!(refused, Err(DynamicsError::Mesh(MeshError::TooManyNodes { .. }))));
}

#[test]
fn damping_that_is_negative_or_no_number_is_refused() {
    for rate in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = attempt(&rig(&modified()), FiniteDifference::default(), rate, &pulse(9.0));
        let quantity = |error| match error {
            DynamicsError::Setting { quantity, .. } => quantity,
            other => panic!("{other:?}"),
        };
        assert_eq!(quantity(refused.unwrap_err()), "damping rate [1/s]");
    }
}

#[test]
fn excitations_out_of_range_are_refused() {
    let refused = [
        Excitation::GammaPulse { peak: f64::NAN, rise: 1e-3 },
        Excitation::GammaPulse { peak: 1.0, rise: 0.0 },
        Excitation::HalfSine { peak: f64::INFINITY, duration: 1e-3 },
        Excitation::HalfSine { peak: 1.0, duration: -1e-3 },
        Excitation::Haversine { peak: 1.0, duration: f64::NAN },
        Excitation::Harmonic { amplitude: 1.0, frequency: 0.0 },
    ];
    for excitation in refused {
        let error = attempt(&rig(&modified()), FiniteDifference::default(), 352.0, &excitation)
            .unwrap_err();
        assert!(matches!(error, DynamicsError::Setting { .. }), "{excitation:?}: {error:?}");
    }
    let error = ForceRecord::new(vec![0.0, 1.0, 1.0], vec![0.0; 3]).unwrap_err();
    assert!(matches!(error, DynamicsError::ForceRecord { row: 2, .. }));
}

#[test]
fn an_instruction_set_that_the_machine_lacks_is_refused() {
    let all = [
        InstructionSet::Scalar,
        InstructionSet::Neon,
        InstructionSet::Avx2,
        InstructionSet::Avx512,
    ];
    let available = InstructionSet::available();
    for set in all {
        let outcome = with(|method| method.instructions = set);
        if available.contains(&set) {
            assert_eq!(outcome, Ok(()));
        } else {
            assert!(matches!(outcome, Err(DynamicsError::Setting { .. })), "{set:?}");
        }
    }
    // No machine has both families.
    assert!(available.len() < all.len());
}

/// Forces beyond all bounds end in an error or in numbers, never in what is no number.
#[test]
fn forces_beyond_all_bounds_end_in_an_error_or_in_numbers() {
    let equilibrium_of = |stack: &Stack| Equilibrium::of(stack).unwrap();
    let hyperbolic: Law = Arc::new(Hyperbolic::new(3e11, 1e-6).unwrap());
    let cases = [
        (modified(), 1e30, true),
        (modified(), -1e100, true),
        (modified(), 1e307, false),
        // 130 MPa, 400 times the pressure scale of the law: next to its rigid limit.
        (hyperbolic, 1e4, true),
    ];
    for (law, peak, runs) in cases {
        let stack = rig(&law);
        let method = FiniteDifference::default();
        let sampling = Sampling::new(1e-3, 2e5).unwrap();
        let outcome = method.integrate(
            &stack,
            &equilibrium_of(&stack),
            352.0,
            &pulse(peak),
            &sampling,
            &|_| (),
        );
        match outcome {
            Ok(run) => {
                assert!(runs, "{peak:e}");
                assert!(run.history.displacement.iter().all(|u| u.is_finite()), "{peak:e}");
                assert!(run.energy.residual().is_finite(), "{peak:e}: {:?}", run.energy);
            }
            Err(error) => assert!(!runs && matches!(error, DynamicsError::Law { .. }), "{error}"),
        }
    }
}
