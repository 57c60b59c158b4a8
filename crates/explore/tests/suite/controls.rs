//! Controls of scenarios: every number has one, and every choice gives a scenario that is valid.

use std::path::Path;

use asperity_explore::ExploreOptions;
use serde_json::{Value, json};

use crate::client::{Page, block, line};

fn state(page: &Page, changes: &Value) -> Value {
    serde_json::from_str(&page.post("state", &json!({ "changes": changes })).body).unwrap()
}

fn controls(state: &Value) -> Vec<Value> {
    let groups = state["groups"].as_array().unwrap().iter();
    groups.flat_map(|group| group["controls"].as_array().unwrap().clone()).collect()
}

/// Pointers of all numbers of a value.
fn numbers(value: &Value, pointer: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(pointer.to_owned()),
        Value::Array(items) => {
            let items = items.iter().enumerate();
            items.for_each(|(at, item)| numbers(item, &format!("{pointer}/{at}"), found));
        }
        Value::Object(object) => {
            object.iter().for_each(|(key, item)| numbers(item, &format!("{pointer}/{key}"), found));
        }
        _ => {}
    }
}

fn scenarios() -> Vec<std::path::PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/scenarios");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<_> =
        files.filter(|path| path.extension().is_some_and(|one| one == "json")).collect();
    found.sort();
    assert!(found.len() > 4);
    found
}

#[test]
fn every_number_of_a_scenario_has_a_control() {
    for path in scenarios() {
        let page = Page::of(&path, &ExploreOptions::default());
        let all = controls(&state(&page, &json!([])));
        let value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let mut pointers = Vec::new();
        numbers(&value, "", &mut pointers);
        for pointer in pointers {
            let is_there = all.iter().any(|one| {
                let own = one["pointer"].as_str().unwrap();
                let is_pair = one["control"] == "pairs" && pointer.starts_with(&format!("{own}/"));
                is_pair || own == pointer
            });
            assert!(is_there, "{}: {pointer}", path.display());
        }
        for one in &all {
            if let (Some(low), Some(high)) = (one["low"].as_f64(), one["high"].as_f64()) {
                assert!(low < high && !(one["log"] == true && low <= 0.0), "{one}");
                let value = one["value"].as_f64();
                assert!(value.is_none_or(|v| v >= low * 0.99 && v <= high * 1.01), "{one}");
            }
        }
    }
}

#[test]
fn units_are_those_of_the_keys() {
    let page = Page::new();
    let all = controls(&state(&page, &json!([])));
    for (pointer, label, unit) in [
        ("/excitation/peak_n", "Peak force", "N"),
        ("/laws/rough/exponent", "Exponent", ""),
        ("/bodies/0/youngs_modulus_pa", "Young's modulus", "Pa"),
        ("/interfaces/0/area_m2", "Area", "m²"),
    ] {
        let found = all.iter().find(|one| one["pointer"] == pointer).unwrap();
        assert_eq!((&found["label"], &found["unit"]), (&json!(label), &json!(unit)));
        assert!(!found["help"].as_str().unwrap().is_empty());
    }
}

/// Friction that a scenario leaves out can be added.
#[test]
fn friction_is_added_from_nothing() {
    let page = Page::new();
    let friction = |state: &Value| {
        let all = controls(state);
        all.into_iter().find(|one| one["pointer"] == "/interfaces/0/friction").unwrap()
    };
    let none = friction(&state(&page, &json!([])));
    assert_eq!((&none["label"], &none["chosen"]), (&json!("Friction"), &json!("none")));
    let given = &none["options"][1]["value"];
    let with = state(&page, &json!([["/interfaces/0/friction", given]]));
    assert_eq!(friction(&with)["chosen"], "given");
    assert!(with["faults"].as_array().unwrap().is_empty(), "{}", with["faults"]);
    assert!(
        controls(&with).iter().any(|one| one["pointer"] == "/interfaces/0/friction/slip_force_n")
    );
}

/// Every option of every choice of the scenarios is accepted.
#[test]
fn every_choice_gives_a_valid_scenario() {
    for path in scenarios().into_iter().chain([block()]) {
        let page = Page::of(&path, &ExploreOptions::default());
        for one in controls(&state(&page, &json!([]))) {
            for option in one["options"].as_array().into_iter().flatten() {
                if option["value"].is_null() {
                    continue;
                }
                let changed = state(&page, &json!([[one["pointer"], option["value"]]]));
                let faults = changed["faults"].as_array().unwrap();
                assert!(faults.is_empty(), "{}: {option}: {faults:?}", path.display());
            }
        }
    }
}

/// A law of another kind has about the stiffness at rest of the one before.
#[test]
fn a_newly_chosen_law_is_as_stiff_at_rest() {
    let page = Page::new();
    let all = controls(&state(&page, &json!([])));
    let kinds = all.iter().find(|one| one["pointer"] == "/laws/rough").unwrap();
    let options = kinds["options"].as_array().unwrap();
    assert!(options.len() >= 9, "{kinds}");
    let frequency = |law: &Value| {
        let lines = page.compute("hit", &[], &json!([["/laws/rough", law]]));
        let words = crate::client::line(&lines, "words")["text"].as_str().unwrap().to_owned();
        let number =
            words.lines().next().unwrap().split_whitespace().rev().nth(1).unwrap().to_owned();
        number.parse::<f64>().unwrap()
    };
    let own = frequency(&options.iter().find(|one| one["label"] == "power").unwrap()["value"]);
    for option in options.iter().filter(|one| one["label"] != "in_series") {
        let ratio = frequency(&option["value"]) / own;
        assert!((0.6..1.5).contains(&ratio), "{option}: {ratio}");
    }
}

/// A force can be drawn: the choice of samples begins with points as high and as long as the present pulse, which are a
/// control; points that a document does not take are faults in their places.
#[test]
fn a_force_can_be_drawn() {
    let page = Page::new();
    let described = |changes: Value| -> Value {
        serde_json::from_str(&page.post("state", &json!({ "changes": changes })).body).unwrap()
    };
    let control = |described: &Value, pointer: &str, kind: &str| -> Value {
        let groups = described["groups"].as_array().unwrap().iter();
        let mut controls = groups.flat_map(|group| group["controls"].as_array().unwrap());
        let is_wanted = |one: &&Value| one["pointer"] == pointer && one["control"] == kind;
        controls.find(is_wanted).unwrap_or_else(|| panic!("{pointer}: {described}")).clone()
    };
    let kinds = control(&described(json!([])), "/excitation", "choice");
    let options = kinds["options"].as_array().unwrap();
    let samples = options.iter().find(|option| option["label"] == "samples").unwrap();
    let points: Vec<[f64; 2]> = serde_json::from_value(samples["value"]["points"].clone()).unwrap();
    // A gamma pulse of 5 N with a rise time of 0.3 ms.
    assert_eq!((points[0], points[2], points[10]), ([0.0, 0.0], [3e-4, 5.0], [1.5e-3, 0.0]));
    let drawn = json!([[0, 0], [4e-4, 7.5], [6e-4, 2], [1e-3, 0]]);
    let changes = json!([["/excitation", samples["value"]], ["/excitation/points", drawn]]);
    let state = described(changes.clone());
    assert_eq!(state["faults"], json!([]));
    let pad = control(&state, "/excitation/points", "pairs");
    assert_eq!((&pad["pulse"], &pad["columns"]), (&json!(true), &json!(["t (s)", "F (N)"])));
    assert_eq!(pad["value"].as_array().unwrap().len(), 4);
    let lines = page.compute("hit", &["history"], &changes);
    let data = line(&lines, "picture")["data"].as_str().unwrap().to_owned();
    assert!(data.contains("Force"), "{data}");
    for (points, place) in [
        (json!([[0, 0], [1e-3, 1], [5e-4, 0]]), "/excitation/points/2/0"),
        (json!([[0, 0]]), "/excitation/points"),
        (json!((0..10_001).map(|n| [n, 1]).collect::<Vec<_>>()), "/excitation/points"),
        (json!([[0, "/etc/passwd"], [1, 0]]), "/excitation/points"),
    ] {
        let state =
            described(json!([["/excitation", samples["value"]], ["/excitation/points", points]]));
        assert_eq!(state["faults"][0]["pointer"], place, "{}", state["faults"]);
    }
}
