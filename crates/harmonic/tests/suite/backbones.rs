//! Nonlinear modes: Duffing's closed form, and the two backbones against each other.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use asperity_harmonic::{ContactSystem, Continuation, LawEvaluation, RigidMass, SpecialPointKind};
use asperity_structure::PreloadedContact;

use crate::rigs::{Cubic, branch, mass_on, natural_frequency, rate_on, reference_law};

/// The arithmetic-geometric mean.
fn mean(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..40 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

/// `u'' + u + c u^3 = 0` from the amplitude a at rest: `w = pi/2 sqrt(1 + c a^2) / K(m)` with
/// `m = c a^2 / (2 (1 + c a^2))`, K the complete elliptic integral. Mass-proportional damping is
/// cancelled exactly by the anti-damping, so that the damped mode is the undamped one.
#[test]
fn duffings_backbone_is_the_elliptic_one() {
    let cube = 0.6;
    let law = Arc::new(Cubic { stiffness: 1.0, square: 0.0, cube });
    let contact = PreloadedContact::new("spring", 1.0, law, 0.0).unwrap();
    let rate = 0.08;
    let mass = RigidMass::new(1.0, rate).unwrap();
    let system = ContactSystem::new(Arc::new(mass), vec![contact], LawEvaluation::Exact).unwrap();
    let continuation = Continuation::Mode { near: 1.0 / TAU, from: 1e-3, to: 3.0 };
    let found = branch(&system, continuation, (25, 256));
    assert!(found.is_complete());
    for point in &found.points {
        let a = point.displacement_at(0.0);
        let hard = 1.0 + cube * a * a;
        let m = 0.5 * cube * a * a / hard;
        let period_part = FRAC_PI_2 / mean(1.0, (1.0 - m).sqrt());
        let w = FRAC_PI_2 * hard.sqrt() / period_part;
        // The harmonics left out are below 1e-13.
        assert!((point.angular_frequency / w - 1.0).abs() < 1e-11, "{a}");
        assert!((point.anti_damping / rate - 1.0).abs() < 1e-9, "{a}");
        assert!((point.modal_mass - 1.0).abs() < 1e-12);
        assert!((point.modal_amplitude() / point.amplitude(1) - 1.0).abs() < 1e-12);
        assert!((point.damping_ratio() - 0.5 * rate / w).abs() < 1e-9);
    }
}

/// Phase resonance of the reference case: exact points of the frequency response where the phase
/// is -90 degrees, and close to the peak at light damping.
#[test]
fn phase_resonance_lies_on_the_frequency_responses() {
    let law = reference_law();
    let system = mass_on(&law, LawEvaluation::Exact);
    let near = natural_frequency(&law);
    let continuation = Continuation::PhaseResonance { near, from: 0.01, to: 0.55279 };
    let backbone = branch(&system, continuation, (7, 128));
    assert!(backbone.is_complete());
    let last = backbone.points.last().unwrap();
    let start = last.frequency_hz();
    let continuation = Continuation::Frequency { force: 0.55279, from: start, to: start + 5.0 };
    let response = branch(&system, continuation, (7, 128));
    assert!((response.points[0].amplitude(1) / last.amplitude(1) - 1.0).abs() < 1e-9);
    assert!((response.points[0].phase() + FRAC_PI_2).abs() < 1e-8);
    let continuation = Continuation::Frequency { force: 0.55279, from: 767.0, to: 1054.0 };
    let sweep = branch(&system, continuation, (7, 128));
    let peak = sweep.of_kind(SpecialPointKind::Peak).next().unwrap();
    // The peak lies below phase resonance by about the damping ratio squared.
    assert!((peak.frequency_hz() / start - 1.0).abs() < 2e-3);
    assert!((peak.amplitude(1) / last.amplitude(1) - 1.0).abs() < 2e-3);
}

/// The damped mode of the reference case: its anti-damping is the damping, and its frequency that
/// of phase resonance but for the harmonics' own damping.
#[test]
fn the_damped_mode_is_the_undamped_one_under_mass_proportional_damping() {
    let law = reference_law();
    let system = mass_on(&law, LawEvaluation::Exact);
    let continuation = Continuation::Mode { near: natural_frequency(&law), from: 1e-9, to: 1.3e-7 };
    let mode = branch(&system, continuation, (9, 128));
    assert!(mode.is_complete());
    for point in &mode.points {
        assert!((point.anti_damping / rate_on(&law) - 1.0).abs() < 1e-8);
    }
    let last = mode.points.last().unwrap();
    let continuation = Continuation::PhaseResonance {
        near: natural_frequency(&law),
        from: 0.01,
        to: rate_on(&law) * crate::rigs::MASS * last.angular_frequency * last.amplitude(1),
    };
    let resonance = branch(&system, continuation, (9, 128));
    let driven = resonance.points.last().unwrap();
    assert!((driven.frequency_hz() / last.frequency_hz() - 1.0).abs() < 1e-4);
    assert!((driven.amplitude(1) / last.amplitude(1) - 1.0).abs() < 1e-3);
}
