//! Settings out of range are refused with the error that says so.

use std::sync::Arc;

use crate::support::{Law, modified, pulse, rig};
use asperity_dynamics::{
    DynamicsError, Excitation, FiniteDifference, ForceRecord, InstructionSet, Sampling,
};
use asperity_law::Hyperbolic;
use asperity_mesh::{MeshError, Stack};
use asperity_structure::{Damping, PreloadedStructure};

fn attempt(
    stack: &Stack,
    method: FiniteDifference,
    excitation: &Excitation,
) -> Result<(), DynamicsError> {
    let structure = PreloadedStructure::new(stack.clone(), Damping::Rate(352.0)).unwrap();
    let sampling = Sampling::new(1e-3, 2e5).unwrap();
    method.integrate(&structure, excitation, &sampling).map(|_| ())
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
        let error =
            attempt(&rig(&modified()), FiniteDifference::default(), &excitation).unwrap_err();
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
        let outcome = method.integrate(&structure, &pulse(peak), &sampling);
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
