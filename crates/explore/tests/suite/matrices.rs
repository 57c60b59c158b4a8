//! Structures of matrices: what they show is the command's.

use std::fs;
use std::path::{Path, PathBuf};

use asperity_explore::ExploreOptions;
use asperity_scenario::Document;
use asperity_simulation::patches::simulate_patches;
use serde_json::{Value, json};

use crate::client::{Page, line};

const SCENARIO: &str = r#"{"schema": "asperity/scenario/1",
 "bodies": [{"name": "blocks", "mesh": "two_blocks.inp", "reduction": {"modes": 30},
             "matrices": {"format": "calculix", "stiffness": "two_blocks.sti", "mass": "two_blocks.mas", "rows": "two_blocks.dof"}}],
 "gravity_m_per_s2": [0, 0, -9.81],
 "loads": [{"body": "blocks", "file": "loads.csv"}],
 "interfaces": [{"name": "patch", "law": "rough", "body": "blocks", "cells": "cells.csv"}],
 "laws": {"rough": {"kind": "power", "coefficient": 1e8, "exponent": 0.5}},
 "damping": {"kind": "rayleigh", "rate_per_s": 60, "time_s": 4e-7},
 "excitation": {"kind": "haversine", "peak_n": 20, "duration_s": 0.25e-3,
                "at": {"body": "blocks", "node": 172, "direction": [0, 0, -1]}},
 "sensors": [{"name": "hammer", "at": {"body": "blocks", "node": 172, "direction": [0, 0, 1]}, "kind": "displacement"}],
 "duration_s": 0.005}"#;

/// The scenario beside its files, which are a condition of the repository's neighbour.
#[allow(clippy::print_stderr, reason = "a test says that it was skipped")]
fn copied() -> Option<(tempfile::TempDir, PathBuf)> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/fe/two_blocks");
    if !data.is_dir() {
        eprintln!("skipped: no data of two_blocks");
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    for file in fs::read_dir(&data).unwrap().flatten() {
        fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    let path = folder.path().join("scenario.json");
    fs::write(&path, SCENARIO).unwrap();
    Some((folder, path))
}

#[test]
fn a_structure_of_matrices_is_shown() {
    let Some((_folder, path)) = copied() else { return };
    let page = Page::of(&path, &ExploreOptions::default());
    let changes = json!([["/laws/rough/coefficient", 2e8]]);
    let lines = page.compute("hit", &["law", "frf", "history"], &changes);
    let drawn: Vec<&Value> = lines.iter().filter(|line| line["answer"] == "picture").collect();
    assert_eq!(drawn.len(), 3, "the laws, the receptance and the history");
    assert!(drawn.iter().any(|picture| picture["view"] == "law"));
    let mut document = Document::read(&path).unwrap();
    document.set("/laws/rough/coefficient", "2e8").unwrap();
    let scenario = document.structure_scenario().unwrap();
    let found = simulate_patches(&document, &scenario, &|_| ()).unwrap();
    let words = asperity_plot::run_words(&found.run.summary);
    let own = line(&lines, "words")["text"].as_str().unwrap();
    for line in words.lines().filter(|line| !line.starts_with("run ")) {
        assert!(own.contains(line), "{line}: {own}");
    }
    let lines = page.compute("levels", &["levels"], &changes);
    assert_eq!(line(&lines, "picture")["view"], "levels");
    let settings = json!({ "amplitudes": [0.5], "from_hz": 3300, "to_hz": 3500 });
    let lines = page.compute_with("steady", &["steady"], &changes, &settings);
    assert!(line(&lines, "words")["text"].as_str().unwrap().contains("Hz"), "{lines:?}");
    let state = page.post("state", &json!({ "changes": changes }));
    let state: Value = serde_json::from_str(&state.body).unwrap();
    let text = state["groups"].to_string();
    assert!(text.contains("/laws/rough/coefficient") && text.contains("/damping/rate_per_s"));
    // A file that is not the scenario's is not read.
    let other = json!([["/bodies/0/matrices/stiffness", "/etc/passwd"]]);
    assert!(
        line(&page.compute("hit", &["frf"], &other), "faults")["faults"][0]["text"]
            .as_str()
            .unwrap()
            .contains("neither in the scenario")
    );
}

/// A law of another kind has the stiffness of its patch at the mean pressure at rest.
#[test]
fn a_newly_chosen_law_is_as_stiff_at_rest() {
    let Some((_folder, path)) = copied() else { return };
    let page = Page::of(&path, &ExploreOptions::default());
    let described = page.post("state", &json!({ "changes": [] }));
    let described: Value = serde_json::from_str(&described.body).unwrap();
    let groups = described["groups"].as_array().unwrap().iter();
    let mut controls = groups.flat_map(|group| group["controls"].as_array().unwrap());
    let kinds = controls.find(|one| one["pointer"] == "/laws/rough").unwrap();
    let options = kinds["options"].as_array().unwrap().iter();
    let law = |wanted: &str| {
        let mut options = options.clone();
        options.find(|one| one["label"] == wanted).unwrap_or_else(|| panic!("{wanted}: {kinds}"))["value"].clone()
    };
    let frequency = |law: &Value| -> f64 {
        let lines = page.compute("hit", &[], &json!([["/laws/rough", law]]));
        let words = line(&lines, "words")["text"].as_str().unwrap().to_owned();
        let first = words.lines().next().unwrap_or_else(|| panic!("{law}: {lines:?}"));
        first.split_whitespace().rev().nth(1).unwrap().parse().unwrap()
    };
    let own = frequency(&law("power"));
    for kind in ["constant", "table"] {
        let ratio = frequency(&law(kind)) / own;
        assert!((0.8..1.25).contains(&ratio), "{kind}: {ratio}");
    }
}

/// The saved scenario finds its files from another folder.
#[test]
fn a_saved_structure_finds_its_files() {
    let Some((folder, path)) = copied() else { return };
    let mut options = ExploreOptions::default();
    let out = folder.path().join("elsewhere/out");
    options.out = Some(out.clone());
    let page = Page::of(&path, &options);
    let answer: Value =
        serde_json::from_str(&page.post("keep", &json!({ "changes": [] })).body).unwrap();
    assert_eq!(answer["written"], json!(["scenario.json"]), "{answer}");
    let saved = Document::read(out.join("scenario.json")).unwrap();
    let scenario = saved.structure_scenario().unwrap();
    assert!(simulate_patches(&saved, &scenario, &|_| ()).is_ok());
}
