//! For smooth laws the truncation error falls exponentially with the harmonics.

use asperity_harmonic::{
    ContactSystem, Continuation, FourierResolution, HarmonicSettings, LawEvaluation, trace,
};
use asperity_mesh::Support;

use crate::rigs::{Law, branch, exponential, mass_on, power, preloaded, reference_law, rig};

/// Errors below this are rounding.
const ROUNDING: f64 = 1e-13;

/// Relative errors of the fundamental over 1 to `most` harmonics, against 30, down to rounding.
fn errors(system: &ContactSystem, continuation: Continuation, most: usize) -> Vec<f64> {
    let last = |harmonics| branch(system, continuation, (harmonics, 256)).points.pop().unwrap();
    let exact = last(30).displacement[0];
    (1..=most)
        .map(|h| (last(h).displacement[0] - exact).norm() / exact.norm())
        .take_while(|error| *error > ROUNDING)
        .collect()
}

/// Slope of the logarithm of the errors by least squares.
fn slope(errors: &[f64]) -> f64 {
    let n = errors.len() as f64;
    let points: Vec<_> = errors.iter().enumerate().map(|(i, e)| (i as f64, e.ln())).collect();
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / n;
    let above: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    above / points.iter().map(|p| (p.0 - mean_x).powi(2)).sum::<f64>()
}

#[test]
fn errors_fall_exponentially_with_harmonics() {
    let laws: [(&str, Law); 3] =
        [("series", reference_law()), ("power", power()), ("exponential", exponential())];
    for (name, law) in laws {
        let structure = preloaded(rig(&law, Support::Rigid), 416.0);
        let systems = [
            ("mass", mass_on(&law, LawEvaluation::Exact)),
            ("rig", ContactSystem::of_structure(&structure, LawEvaluation::Exact).unwrap()),
        ];
        for (kind, system) in systems {
            let continuation = Continuation::Force { frequency: 1000.0, from: 0.1, to: 0.8 };
            let found = errors(&system, continuation, 7);
            assert!(found.len() >= 2);
            // Each harmonic gains more than a factor of ten, down to rounding.
            assert!(slope(&found) < -10.0_f64.ln(), "{name} {kind}: {found:?}");
        }
    }
}

/// The estimate bounds the true error of the automatic choice, and the choice meets its tolerance.
#[test]
fn the_automatic_choice_meets_its_tolerance() {
    let system = mass_on(&reference_law(), LawEvaluation::Exact);
    let continuation = Continuation::Frequency { force: 1.2, from: 1000.0, to: 850.0 };
    let exact = branch(&system, continuation, (40, 512)).highest().unwrap().amplitude(1);
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let resolution = FourierResolution::Automatic { tolerance, most: 60 };
        let found = trace(
            &system,
            &continuation,
            &HarmonicSettings { resolution, ..HarmonicSettings::default() },
        )
        .unwrap();
        assert!(found.truncation() <= tolerance);
        let off = (found.highest().unwrap().amplitude(1) / exact - 1.0).abs();
        assert!(off <= tolerance, "{off:.1e}");
    }
    let resolution = FourierResolution::Automatic { tolerance: 1e-14, most: 6 };
    let found = trace(
        &system,
        &continuation,
        &HarmonicSettings { resolution, ..HarmonicSettings::default() },
    )
    .unwrap();
    assert!(found.is_complete() && found.harmonics == 6 && found.truncation() > 1e-14);
}
