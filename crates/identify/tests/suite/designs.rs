//! Ranking of further measurements against closed forms.

use asperity_identify::{
    Identification, IdentificationError, IdentificationProblem, MeasurementKind, identify,
};
use asperity_scenario::Document;
use serde_json::{Value, json};

/// A power law whose coefficient follows from two stiffnesses of 2 %, with a `design`.
fn identified(design: &Value) -> Result<Identification, IdentificationError> {
    let path = "../../fixtures/scenarios/nouira2020-modified.json";
    let mut scenario = Document::read(path).unwrap();
    let power = r#"{"kind": "power", "coefficient": 1.8e10, "exponent": 0.35}"#;
    for (pointer, value) in [("/laws/modified", power), ("/duration_s", "0.03")] {
        scenario.set(pointer, value).unwrap();
    }
    let stiffness = |pressure: f64| [pressure, 1.8e10 * pressure.powf(0.35)];
    let problem = json!({
        "schema": "asperity/identify/1",
        "scenario": scenario.value(),
        "unknowns": [
            {"kind": "scalar", "pointer": "/laws/modified/coefficient", "bounds": [1e9, 1e12]},
        ],
        "data": [{"kind": "stiffness", "law": "modified", "points": [stiffness(5e4), stiffness(2e5)],
                  "spread": {"relative": 0.02}}],
        "design": design,
        "starts": 1,
        "draws": 100,
    });
    let name = concat!(env!("CARGO_MANIFEST_DIR"), "/problem.json");
    identify(&IdentificationProblem::of(Document::parse(&problem.to_string(), name).unwrap())?)
}

fn design(more: &Value) -> Value {
    let mut design = json!({
        "force_peak_n": [5],
        "features": {"fundamental.frequency_hz": 1e-3},
        "stiffness": {"pressures_pa": [3e4, 1e5], "relative": 0.01},
        "pressures_pa": [1e4, 8e4],
    });
    for (key, value) in more.as_object().unwrap() {
        design[key] = value.clone();
    }
    design
}

/// ln K has the deviation of ln C at all pressures: `1 / sigma'^2 = 1 / sigma^2 + 1 / r^2` after a
/// stiffness with the relative deviation `r`. Before there are two stiffnesses, and the bounds as a
/// uniform distribution.
#[test]
fn a_stiffness_narrows_a_coefficient_as_its_closed_form_says() {
    let found = identified(&design(&json!({}))).unwrap();
    let ranking = found.design.as_ref().unwrap();
    assert_eq!(ranking.pressures_pa, [1e4, 8e4]);
    let before = 2.0 / 0.02_f64.powi(2) + 12.0 / 1e3_f64.ln().powi(2);
    let expected = (before / (before + 1.0 / 0.01_f64.powi(2))).sqrt();
    let [hit, low, high] = ranking.candidates.as_slice() else { panic!("{ranking:?}") };
    for (one, pressure_pa) in [(low, 3e4), (high, 1e5)] {
        assert_eq!(one.kind, MeasurementKind::Stiffness { pressure_pa });
        assert!((one.remaining - expected).abs() < 1e-6, "{} {expected}", one.remaining);
        assert!((one.information + expected.ln()).abs() < 1e-6, "{}", one.information);
    }
    // f1 rises with about the tenth part of ln C, and is measured ten times as well.
    assert!(matches!(hit.kind, MeasurementKind::Hits { force_peak_n: 5.0, .. }));
    assert!(hit.remaining > 0.05 && hit.remaining < expected, "{}", hit.remaining);
    assert_eq!(ranking.sequence.len(), 3);
    // Four times the hits halve the deviation of each.
    let four = identified(&design(&json!({"hits": 4}))).unwrap();
    let four = four.design.unwrap().candidates.remove(0).remaining;
    let variance = |remaining: f64| remaining.powi(-2) - 1.0;
    assert!((variance(four) / variance(hit.remaining) / 4.0 - 1.0).abs() < 1e-9);
}

#[test]
fn wrong_designs_are_refused_with_their_place() {
    for (more, place) in [
        (json!({"pressures_pa": [8e4, 1e4]}), "/design/pressures_pa"),
        (json!({"features": {"fundamental.frequency_hz": 0}}), "/design/features/fundamental.freq"),
        (json!({"features": {"fundamental.colour": 0.1}}), "fundamental.colour"),
        (
            json!({"stiffness": {"pressures_pa": [1e5], "relative": -1}}),
            "/design/stiffness/relative",
        ),
        (
            json!({"stiffness": {"pressures_pa": [0], "relative": 0.1}}),
            "/design/stiffness/pressures",
        ),
    ] {
        let error = identified(&design(&more)).unwrap_err().to_string();
        assert!(error.contains(place), "{error}");
    }
}
