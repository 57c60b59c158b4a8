//! Settings out of range are refused with the error that says so.

use std::sync::Arc;

use crate::support::{Law, modified, pulse, rig, rig_on};
use asperity_dynamics::{
    DynamicsError, FiniteDifference, InstructionSet, Integrator, Modal, Sampling,
};
use asperity_law::Hyperbolic;
use asperity_mesh::{MeshError, Port, Stack, Support};
use asperity_structure::{
    Damping, LoadCase, PreloadedStructure, SampledFunction, StructureError, TimeFunction,
};

fn attempt(
    stack: &Stack,
    method: FiniteDifference,
    excitation: &LoadCase,
) -> Result<(), DynamicsError> {
    let structure = PreloadedStructure::new(stack.clone(), Damping::Rate(352.0)).unwrap();
    let sampling = Sampling::new(1e-3, 2e5).unwrap();
    method.integrate(&structure, excitation, &[Port::TOP], &sampling).map(|_| ())
}

fn with(change: impl Fn(&mut FiniteDifference)) -> Result<(), DynamicsError> {
    let mut method = FiniteDifference::default();
    change(&mut method);
    attempt(&rig(&modified()), method, &pulse(9.0))
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

/// Runs that would take years or more memory than there is, refused by their size.
#[test]
fn runs_beyond_the_bounds_are_refused() {
    let on = |stiffness: f64, duration: f64, rate: f64, method: Integrator| {
        let support = Support::SpringMass { stiffness, mass: 2.0, damping_ratio: 0.0 };
        let stack = rig_on(&modified(), support);
        let structure = PreloadedStructure::new(stack, Damping::Rate(352.0)).unwrap();
        let sampling = Sampling::new(duration, rate).unwrap();
        method.outline(&structure, &pulse(9.0), &sampling).map(|_| ())
    };
    let coarse = Integrator::from(FiniteDifference { cell: 5e-3, ..FiniteDifference::default() });
    assert_eq!(on(1e9, 0.1, 2e5, coarse), Ok(()));
    for stiffness in [1e24, 1e100, 1e300] {
        let refused = on(stiffness, 0.1, 2e5, coarse);
        assert!(matches!(refused, Err(DynamicsError::TooLarge { .. })), "{refused:?}");
    }
    let many_samples = on(1e9, 0.1, 2e8, coarse);
    assert!(matches!(many_samples, Err(DynamicsError::TooLarge { limit: 1e8, .. })));
    let short = Integrator::from(Modal { step: Some(1e-10), ..Modal::default() });
    let refused = on(1e9, 0.1, 2e5, short);
    assert!(refused.is_err(), "{refused:?}");
    let many_steps = Integrator::from(Modal { step: Some(1e-9), ..Modal::default() });
    let refused = on(1e9, 0.1, 2e5, many_steps);
    assert!(matches!(refused, Err(DynamicsError::TooLarge { limit: 2e8, .. })), "{refused:?}");
    let modal = on(1e9, 0.1, 2e8, Integrator::default());
    assert!(matches!(modal, Err(DynamicsError::TooLarge { limit: 1e8, .. })), "{modal:?}");
}

#[test]
fn excitations_out_of_range_are_refused() {
    let refused = [
        LoadCase::force(TimeFunction::GammaPulse { rise: 1e-3 }, f64::NAN),
        LoadCase::force(TimeFunction::GammaPulse { rise: 0.0 }, 1.0),
        LoadCase::force(TimeFunction::HalfSine { duration: 1e-3 }, f64::INFINITY),
        LoadCase::force(TimeFunction::HalfSine { duration: -1e-3 }, 1.0),
        LoadCase::force(TimeFunction::Haversine { duration: f64::NAN }, 1.0),
        LoadCase::force(TimeFunction::Harmonic { frequency: 0.0 }, 1.0),
    ];
    for excitation in refused {
        let error =
            attempt(&rig(&modified()), FiniteDifference::default(), &excitation).unwrap_err();
        let refused = matches!(error, DynamicsError::Structure(StructureError::Setting { .. }));
        assert!(refused, "{excitation:?}: {error:?}");
    }
    let error = SampledFunction::new(vec![0.0, 1.0, 1.0], vec![0.0; 3]).unwrap_err();
    assert!(matches!(error, StructureError::Samples { row: 2, .. }));
}

#[test]
fn an_instruction_set_that_the_machine_lacks_is_refused() {
    let all = [
        InstructionSet::Scalar,
        InstructionSet::Neon,
        InstructionSet::Avx2,
        InstructionSet::Avx512,
    ];
    let structure = PreloadedStructure::new(rig(&modified()), Damping::Rate(352.0)).unwrap();
    let sampling = Sampling::new(1e-3, 2e5).unwrap();
    let available = InstructionSet::available();
    for set in all {
        let modal = Modal { instructions: set, ..Modal::default() };
        let outcome = modal.integrate(&structure, &pulse(9.0), &[Port::TOP], &sampling).map(|_| ());
        if available.contains(&set) {
            assert_eq!(outcome, Ok(()));
        } else {
            assert!(matches!(outcome, Err(DynamicsError::InstructionSet { .. })), "{set:?}");
        }
    }
    // No machine has both families.
    assert!(available.len() < all.len());
}

/// Forces beyond all bounds end in an error or in numbers, never in what is no number.
#[test]
fn forces_beyond_all_bounds_end_in_an_error_or_in_numbers() {
    let hyperbolic: Law = Arc::new(Hyperbolic::new(3e11, 1e-6).unwrap());
    let cases = [
        (modified(), 1e30, true),
        (modified(), -1e100, true),
        (modified(), 1e307, false),
        // 130 MPa, 400 times the pressure scale of the law: next to its rigid limit.
        (hyperbolic, 1e4, true),
    ];
    for (law, peak, runs) in cases {
        let structure = PreloadedStructure::new(rig(&law), Damping::Rate(352.0)).unwrap();
        let method = FiniteDifference::default();
        let sampling = Sampling::new(1e-3, 2e5).unwrap();
        let outcome = method.integrate(&structure, &pulse(peak), &[Port::TOP], &sampling);
        match outcome {
            Ok(run) => {
                assert!(runs, "{peak:e}");
                assert!(
                    run.history.sensors[0].displacement.iter().all(|u| u.is_finite()),
                    "{peak:e}"
                );
                assert!(run.energy.residual().is_finite(), "{peak:e}: {:?}", run.energy);
            }
            // Beyond the grid, or beyond the law.
            Err(DynamicsError::Coarse { .. }) => {}
            Err(error) => assert!(!runs && matches!(error, DynamicsError::Law { .. }), "{error}"),
        }
    }
}
