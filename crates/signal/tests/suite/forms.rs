//! The six forms of a frequency response function.

use crate::oscillator::Mode;
use asperity_signal::{Complex64, Frf, FrfForm};
use std::f64::consts::TAU;

fn receptance() -> Frf {
    let mode = Mode { natural_hz: 832.0, damping: 0.035, mass: 1.61 };
    let frequency_hz: Vec<f64> = (0..400).map(|k| 5.0 * f64::from(k)).collect();
    let values = frequency_hz.iter().map(|&f| mode.receptance(f)).collect();
    Frf { frequency_hz, values, form: FrfForm::Receptance }
}

/// Verified against the definitions, written out for one oscillator: `m`, `c`, `k` give
/// `k - m w^2 + i c w` and its quotients by `i w`. Tolerance: a few roundings.
#[test]
fn each_form_follows_its_definition() {
    let (mass, omega_0, damping) = (1.61, TAU * 832.0, 0.035);
    let (stiffness, viscosity) = (mass * omega_0 * omega_0, 2.0 * damping * omega_0 * mass);
    let converted = FrfForm::ALL.map(|form| receptance().to(form).without_dc());
    for (k, &frequency) in converted[0].frequency_hz.iter().enumerate() {
        let s = Complex64::new(0.0, TAU * frequency);
        let dynamic = s * s * mass + s * viscosity + stiffness;
        let expected =
            [dynamic.inv(), s / dynamic, s * s / dynamic, dynamic, dynamic / s, dynamic / (s * s)];
        for (frf, expected) in converted.iter().zip(expected) {
            let error = (frf.values[k] - expected).norm() / expected.norm();
            // Near resonance the closed form cancels 1/(2 zeta) = 14-fold.
            assert!(error < 1e-14, "{} at {frequency} Hz: {error:e}", frf.form);
        }
    }
}

/// Verified against the identity: all 36 conversions and back. Tolerance: at most six roundings.
#[test]
fn every_conversion_is_inverted() {
    let receptance = receptance().without_dc();
    for from in FrfForm::ALL {
        let original = receptance.to(from);
        for to in FrfForm::ALL {
            let back = original.to(to).to(from);
            assert_eq!(back.form, from);
            for (a, b) in back.values.iter().zip(&original.values) {
                assert!((a - b).norm() <= 2e-15 * b.norm(), "{from} to {to}");
            }
        }
    }
}

/// Verified against the documentation: at zero frequency products are zero and quotients NaN.
#[test]
fn zero_frequency_gives_zero_or_nan() {
    let receptance = receptance();
    let dc = |frf: &Frf| frf.values[0];
    assert_eq!(dc(&receptance.to(FrfForm::Mobility)).norm(), 0.0);
    assert_eq!(dc(&receptance.to(FrfForm::Accelerance)).norm(), 0.0);
    let stiffness = dc(&receptance.to(FrfForm::DynamicStiffness));
    assert!((stiffness * dc(&receptance) - Complex64::ONE).norm() < 1e-15);
    for form in [FrfForm::MechanicalImpedance, FrfForm::ApparentMass] {
        assert!(dc(&receptance.to(form)).is_nan(), "{form}");
    }
    let back = receptance.to(FrfForm::Accelerance).to(FrfForm::Receptance);
    assert!(dc(&back).is_nan());
    assert_eq!(back.without_dc().len(), receptance.len() - 1);
    assert_eq!(receptance.without_dc().frequency_hz[0], 5.0);
}

/// Verified against dimensions: receptance times each derivative's `1/s`, and reciprocals.
#[test]
fn units_and_phases() {
    let units: Vec<&str> = FrfForm::ALL.iter().map(|form| form.unit()).collect();
    assert_eq!(units, ["m/N", "m/(N s)", "m/(N s^2)", "N/m", "N s/m", "kg"]);
    let receptance = receptance();
    let (phase, magnitude) = (receptance.phase(), receptance.magnitude());
    assert!(phase.windows(2).all(|pair| pair[1] < pair[0]), "falls through resonance");
    assert_eq!(phase[0], 0.0);
    assert_eq!(magnitude[0], receptance.values[0].re);
    assert!(!receptance.is_empty());
}
