//! Responses at given frequencies and forces against a traced branch; their derivatives against
//! differences of responses.

use asperity_harmonic::{ContactSystem, Drive, SineVariation, SteppedSineSolver};
use asperity_law::Power;
use std::sync::Arc;

use super::rigs::{Law, mass_on, reference_law};
use asperity_harmonic::{Continuation, FourierResolution, HarmonicSettings, LawEvaluation, trace};

const HARMONICS: usize = 9;

fn exact(law: &Law) -> ContactSystem {
    mass_on(law, LawEvaluation::Exact)
}

/// Every point of a branch below its first fold is found again, up and down, to rounding.
#[test]
fn a_sweep_gives_the_points_of_a_branch() {
    let system = exact(&reference_law());
    let force = 1.0;
    let sweep = Continuation::Frequency { force, from: 700.0, to: 1100.0 };
    let samples = 16 * HARMONICS;
    let resolution = FourierResolution::Fixed { harmonics: HARMONICS, samples };
    let settings = HarmonicSettings { resolution, ..HarmonicSettings::default() };
    let branch = trace(&system, &sweep, &settings).unwrap();
    assert!(branch.is_complete());
    let points: Vec<_> = branch.points.iter().step_by(3).collect();
    assert!(points.len() > 10);
    let mut drives: Vec<Drive> =
        points.iter().map(|point| Drive { frequency_hz: point.frequency_hz(), force }).collect();
    let mut expected: Vec<_> = points.iter().map(|point| point.displacement[0]).collect();
    for _ in 0..2 {
        let found = SteppedSineSolver::new(&system, HARMONICS).sweep(&drives);
        for (found, expected) in found.iter().zip(&expected) {
            let off = (found.as_ref().unwrap().displacement - expected).norm() / expected.norm();
            assert!(off < 1e-7, "{off}");
        }
        drives.reverse();
        expected.reverse();
    }
}

/// Implicit derivatives with respect to the coefficient of a law, and to the force, against
/// fourth-order differences of solved responses.
#[test]
fn derivatives_are_those_of_the_responses() {
    let weights = [1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0];
    let places = [-2.0, -1.0, 1.0, 2.0];
    let law = |coefficient: f64| -> Law { Arc::new(Power::new(coefficient, 0.35, 0.0).unwrap()) };
    // The damping rate is that of the law at the middle.
    let coefficient = 0.9e10;
    let middle = exact(&law(coefficient));
    let with = |coefficient: f64| {
        let contact = asperity_structure::PreloadedContact::new(
            "contacts",
            super::rigs::AREA,
            law(coefficient),
            super::rigs::PRESSURE,
        );
        let rate = super::rigs::rate_on(&law(0.9e10));
        let mass = asperity_harmonic::RigidMass::new(super::rigs::MASS, rate).unwrap();
        let contacts = vec![contact.unwrap()];
        ContactSystem::new(Arc::new(mass), contacts, LawEvaluation::Exact).unwrap()
    };
    let natural = super::rigs::natural_frequency(&law(coefficient));
    for share in [0.9, 0.98, 1.0, 1.05] {
        let drive = Drive { frequency_hz: share * natural, force: 1.5 };
        let mut solver = SteppedSineSolver::new(&middle, HARMONICS);
        let response = solver.sweep(&[drive]).remove(0).unwrap();
        let (by_law, by_force) = (1e-4 * coefficient, 1e-4 * drive.force);
        let systems = places.map(|place| with(coefficient + place * by_law));
        let forced = places.map(|place| Drive { force: drive.force + place * by_force, ..drive });
        let variations = [
            SineVariation {
                points: systems.iter().map(|system| (system, drive)).collect(),
                weights: &weights,
                step: by_law,
            },
            SineVariation {
                points: forced.iter().map(|drive| (&middle, *drive)).collect(),
                weights: &weights,
                step: by_force,
            },
        ];
        let found = solver.derivatives(drive, &response, &variations).unwrap();
        let solve = |system: &ContactSystem, drive: Drive| {
            SteppedSineSolver::new(system, HARMONICS)
                .sweep(&[drive])
                .remove(0)
                .unwrap()
                .displacement
        };
        for (variation, found) in variations.iter().zip(&found) {
            let expected: num_complex::Complex64 = variation
                .points
                .iter()
                .zip(&weights)
                .map(|((system, drive), weight)| solve(system, *drive) * (weight / variation.step))
                .sum();
            let off = (found - expected).norm() / expected.norm();
            assert!(off < 1e-6, "{share}: {off}");
        }
    }
}
