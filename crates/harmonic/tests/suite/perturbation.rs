//! Small vibrations of a mass on power-law contacts: perturbation theory's three results.

use std::f64::consts::TAU;
use std::sync::Arc;

use asperity_harmonic::{ContactSystem, Continuation, LawEvaluation, PeriodicResponse, RigidMass};
use asperity_law::Power;
use asperity_structure::PreloadedContact;

use crate::rigs::{AREA, MASS, PRESSURE, branch, natural_frequency, reference_law};

/// Frequency shift `-(m s/48)(3 + 3m - 4ms) r^2`, displacement ratio `(m s/12) r` and mean shift
/// over amplitude `-(m s/4) r`, r being the pressure amplitude over the static pressure.
fn expected(ratio: f64) -> [f64; 3] {
    let m = 0.35;
    let k1 = 1.0 / (2.0 / (1.81e10 * PRESSURE.powf(m)) + 0.015 / 71e9);
    let s = 2.0 * k1 / (1.81e10 * PRESSURE.powf(m));
    let ms = m * s;
    [
        -(ms / 48.0) * (3.0 + 3.0 * m - 4.0 * ms) * ratio * ratio,
        ms / 12.0 * ratio,
        -ms / 4.0 * ratio,
    ]
}

fn found(point: &PeriodicResponse) -> ([f64; 3], f64) {
    let natural = natural_frequency(&reference_law());
    let shift = point.frequency_hz() / natural - 1.0;
    let pressure = MASS * (TAU * natural).powi(2) * point.amplitude(1) / AREA;
    let values = [shift, point.displacement_ratio(), point.mean_displacement / point.amplitude(1)];
    (values, pressure / PRESSURE)
}

/// The undamped mode: the differences from perturbation theory, relative to it, fall with the
/// square of the amplitude, the next order.
#[test]
fn the_undamped_mode_meets_perturbation_theory_with_slope_two() {
    let law = reference_law();
    let contact = PreloadedContact::new("contacts", AREA, law, PRESSURE).unwrap();
    let mass = RigidMass::new(MASS, 0.0).unwrap();
    let system = ContactSystem::new(Arc::new(mass), vec![contact], LawEvaluation::Exact).unwrap();
    let largest = 4e-8;
    let continuation = Continuation::Mode { near: 958.0, from: largest / 16.0, to: largest };
    let branch = branch(&system, continuation, (9, 128));
    assert!(branch.is_complete());
    let off = |point: &PeriodicResponse| {
        let (values, ratio) = found(point);
        let theory = expected(ratio);
        [0, 1, 2].map(|i| (values[i] / theory[i] - 1.0).abs())
    };
    let (first, last) = (off(&branch.points[0]), off(branch.points.last().unwrap()));
    for i in 0..3 {
        assert!(last[i] < 0.1, "{i}: {:.2e}", last[i]);
        let slope = (last[i] / first[i]).ln() / 16.0_f64.ln();
        assert!((slope - 2.0).abs() < 0.1, "{i}: slope {slope}, {:.1e}", first[i]);
    }
}

/// Power law alone, no elastic layer (s = 1), at phase resonance under damping: the shift is the
/// same to the order of the damping squared.
#[test]
fn phase_resonance_shifts_as_the_undamped_mode() {
    let law = Arc::new(Power::new(0.5 * 1.81e10, 0.35, 0.0).unwrap());
    let contact = PreloadedContact::new("contacts", AREA, law, PRESSURE).unwrap();
    let mass = RigidMass::new(MASS, 4.0).unwrap();
    let system = ContactSystem::new(Arc::new(mass), vec![contact], LawEvaluation::Exact).unwrap();
    let k1 = 0.5 * 1.81e10 * PRESSURE.powf(0.35);
    let natural = (AREA * k1 / MASS).sqrt() / TAU;
    let continuation = Continuation::PhaseResonance { near: natural, from: 1e-4, to: 2e-3 };
    let branch = branch(&system, continuation, (7, 128));
    let last = branch.points.last().unwrap();
    assert!((last.phase() + std::f64::consts::FRAC_PI_2).abs() < 1e-10);
    let ratio = k1 * last.amplitude(1) / PRESSURE;
    let (m, shift) = (0.35, last.frequency_hz() / natural - 1.0);
    let theory = -(m / 48.0) * (3.0 - m) * ratio * ratio;
    // Pressure amplitudes of 0.07: the next order is about their square.
    assert!((shift / theory - 1.0).abs() < 0.01, "{shift:.3e} {theory:.3e}");
}
