//! Measured hits beside computed ones.

use std::path::Path;

use asperity_explore::ExploreOptions;
use asperity_identify::IdentificationProblem;
use asperity_scenario::Document;
use asperity_simulation::run::simulate;
use serde_json::{Value, json};

use crate::client::{Page, block, line};

const FORCES: [f64; 3] = [3.0, 6.0, 12.0];

/// An analysis whose hits are those of the scenario, f1 two standard deviations beside it.
fn analysis(folder: &Path) -> std::path::PathBuf {
    let hits: Vec<Value> = FORCES
        .iter()
        .enumerate()
        .map(|(index, force)| {
            let mut document = Document::read(block()).unwrap();
            document.set("/excitation/peak_n", &force.to_string()).unwrap();
            let run = simulate(&document, &document.scenario().unwrap()).unwrap();
            let first = run.summary.fundamental.unwrap();
            json!({
                "file": "a.uff", "index": index + 1, "record": 1, "time_s": 0.0, "averaged": true,
                "force_peak_n": force,
                "fundamental": {
                    "frequency_hz": first.frequency_hz + 1.0, "frequency_uncertainty_hz": 0.5,
                    "magnitude": first.amplitude.value(), "magnitude_uncertainty": 1e-10,
                },
                "harmonic_ratio": run.summary.harmonic_ratio, "harmonic_ratio_uncertainty": 1e-3,
            })
        })
        .collect();
    let analysis = json!({ "schema": "asperity/analysis/1", "hits": hits, "levels": [],
                           "settings": { "frf_form": "receptance" } });
    let path = folder.join("analysis.json");
    std::fs::write(&path, analysis.to_string()).unwrap();
    let frf = "frequency_hz,real,imag,magnitude,phase_rad\n0,0,0,0,0\n1000,1e-8,0,1e-8,0\n1400,1e-7,0,1e-7,0\n";
    std::fs::write(folder.join("frf.csv"), frf).unwrap();
    path
}

fn page_of(folder: &Path) -> Page {
    let mut options = ExploreOptions::default();
    options.data = Some(analysis(folder));
    options.out = Some(folder.join("out"));
    Page::of(&block(), &options)
}

/// Two standard deviations at each of three hits: chi-square is 12, and 0 where measured and computed values
/// are equal.
#[test]
fn chi_square_is_the_sum_over_the_hits() {
    let folder = tempfile::tempdir().unwrap();
    let page = page_of(folder.path());
    let lines = page.compute("levels", &["levels"], &json!([]));
    let words = line(&lines, "words")["text"].as_str().unwrap();
    let value = |name: &str| -> f64 {
        let found =
            words.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{words}"));
        assert!(found.ends_with(" of 3 hits"), "{found}");
        found.split(": ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
    };
    assert!((value("fundamental.frequency_hz") - 12.0).abs() < 0.2, "{words}");
    assert!(value("fundamental.receptance_m_per_n") < 0.1, "{words}");
    assert!(value("harmonic_ratio") < 0.1, "{words}");
}

#[test]
fn measured_hits_and_functions_are_in_the_figures() {
    let folder = tempfile::tempdir().unwrap();
    let page = page_of(folder.path());
    for (part, view, panels) in [("levels", "levels", 3), ("hit", "frf", 1)] {
        let lines = page.compute(part, &[view], &json!([]));
        let data = line(&lines, "picture")["data"].as_str().unwrap().to_owned();
        assert_eq!(data.matches("\"name\":\"measured\"").count(), panels, "{view}");
    }
}

/// The problem of a state is read by `identify`.
#[test]
fn the_state_becomes_a_problem() {
    let folder = tempfile::tempdir().unwrap();
    let page = page_of(folder.path());
    let asked = json!({ "changes": [["/laws/rough/exponent", 0.4]], "problem": true });
    let answer: Value = serde_json::from_str(&page.post("keep", &asked).body).unwrap();
    assert_eq!(answer["written"], json!(["scenario.json", "problem.json"]), "{answer}");
    let problem = Document::read(folder.path().join("out/problem.json")).unwrap();
    let pointers: Vec<&Value> =
        problem.value()["unknowns"].as_array().unwrap().iter().map(|one| &one["pointer"]).collect();
    assert_eq!(pointers[..2], ["/laws/rough/coefficient", "/laws/rough/exponent"]);
    let problem = IdentificationProblem::of(problem);
    assert!(problem.is_ok(), "{:?}", problem.err().map(|error| error.to_string()));
}

#[test]
fn a_file_without_hits_is_refused_at_once() {
    let mut options = ExploreOptions::default();
    options.data = Some(block());
    let error = asperity_explore::Server::open(&block(), &options).unwrap_err().to_string();
    assert!(error.contains("asperity/analysis/1"), "{error}");
}
