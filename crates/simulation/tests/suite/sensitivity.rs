//! Derivatives of the observables of whole scenarios against central differences of the same
//! observables at the same step.

use asperity_scenario::Document;
use asperity_simulation::sensitivity::{Sensitivities, SensitivityError, sensitivities};

const POINTERS: [&str; 12] = [
    "/laws/modified/coefficient",
    "/laws/modified/exponent",
    "/laws/modified/knots/0/1",
    "/laws/modified/knots/1/1",
    "/laws/modified/knots/2/1",
    "/laws/modified/knots/3/1",
    "/excitation/peak_n",
    "/excitation/rise_s",
    "/damping/ratio",
    "/bodies/0/mass_kg",
    "/bodies/0/length_m",
    "/gravity_m_per_s2",
];

fn rig(peak: &str) -> Document {
    let mut document = Document::read("../../fixtures/scenarios/nouira2020-modified.json").unwrap();
    document.set("/method", r#"{"kind": "modal", "step_s": 1e-5, "modes_per_body": 2}"#).unwrap();
    document.set("/excitation/peak_n", peak).unwrap();
    document
}

fn value(found: &Sensitivities, row: usize) -> f64 {
    found.values[row].unwrap()
}

/// To 3e-7 of the derivative, or of a hundredth of the observable's value over the parameter's; of the
/// damping ratio, whose crossings are found to 1e-10, over differences of 1e-5, to 1e-6.
#[test]
fn derivatives_are_those_of_whole_scenarios() {
    for peak in ["9", "32"] {
        let document = rig(peak);
        let found = sensitivities(&document, &POINTERS).unwrap();
        for (column, parameter) in found.parameters.iter().enumerate() {
            let step = 1e-5 * parameter.value;
            let four = [-2.0, -1.0, 1.0, 2.0].map(|place| {
                let mut varied = document.clone();
                varied
                    .set(&parameter.pointer, &(parameter.value + place * step).to_string())
                    .unwrap();
                sensitivities(&varied, &[]).unwrap()
            });
            for (row, name) in found.columns.iter().enumerate() {
                let [a, b, c, d] = four.each_ref().map(|found| value(found, row));
                let expected = (8.0 * (c - b) - (d - a)) / (12.0 * step);
                let rate = found.jacobian[row][column].unwrap();
                let scale = expected.abs().max(1e-2 * value(&found, row).abs() / parameter.value);
                let off = (rate - expected).abs() / scale;
                let tolerance = if name.ends_with("damping_ratio") { 1e-6 } else { 3e-7 };
                let place = format!("{peak} N, {}, {name}", parameter.pointer);
                assert!(off < tolerance, "{place}: {rate:e} for {expected:e}, off by {off:.1e}");
            }
        }
    }
}

#[test]
fn pointers_without_a_parameter_and_other_methods_are_errors() {
    let refused = |pointer: &str| sensitivities(&rig("9"), &[pointer]).unwrap_err();
    for pointer in ["/title", "/nothing", "/duration_s"] {
        assert!(matches!(refused(pointer), SensitivityError::Parameter(_)), "{pointer}");
    }
    assert!(matches!(refused("/laws/modified/knots/0/0"), SensitivityError::Zero { .. }));
    let document = Document::read("../../fixtures/scenarios/nouira2020-modified.json").unwrap();
    let method = sensitivities(&document, &[]).unwrap_err();
    assert!(matches!(method, SensitivityError::Method { .. }), "{method}");
}
