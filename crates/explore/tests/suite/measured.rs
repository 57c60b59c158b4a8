//! Measured hits beside computed ones.

use std::path::Path;

use asperity_experiment::{AnalysisOptions, ResponseChoice, analyse};
use asperity_explore::ExploreOptions;
use asperity_identify::IdentificationProblem;
use asperity_measure::{Format, WriteOptions, write};
use asperity_scenario::Document;
use asperity_simulation::record::measurement_record;
use asperity_simulation::run::simulate;
use serde_json::{Value, json};

use crate::client::{Page, block, changed, line};

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
    // A draft comes before.
    let words = lines.iter().rev().find(|line| line["answer"] == "words").unwrap();
    let words = words["text"].as_str().unwrap();
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

/// Hits by half-sines, recorded and analysed, beside a scenario with another pulse: each hit is computed under its own
/// force, as a hit of the page may be, and chi-square tells no difference.
#[test]
fn hits_are_computed_under_their_own_forces() {
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for force in FORCES {
        let mut document = Document::read(block()).unwrap();
        let pulse = json!({ "kind": "half_sine", "peak_n": force, "duration_s": 1.2e-3 });
        document.set("/excitation", &pulse.to_string()).unwrap();
        document.set("/duration_s", "0.12").unwrap();
        let run = simulate(&document, &document.scenario().unwrap()).unwrap();
        let file = folder.path().join(format!("hit_{force}.uff"));
        let record = [measurement_record(&run, None)];
        write(&file, &record, Format::UniversalBinary, &WriteOptions::default()).unwrap();
        files.push(file);
    }
    let options = AnalysisOptions {
        responses: ResponseChoice::of(&["displacement".into()]),
        ..AnalysisOptions::default()
    };
    let analysis = analyse(&files, &options).unwrap();
    let mut report = serde_json::to_value(&analysis.responses[0].report).unwrap();
    for hit in report["hits"].as_array_mut().unwrap() {
        for (place, relative) in [("frequency", 1e-4), ("magnitude", 1e-3)] {
            let fundamental = hit["fundamental"].as_object_mut().unwrap();
            let (value, deviation) = match place {
                "frequency" => ("frequency_hz", "frequency_uncertainty_hz"),
                _ => ("magnitude", "magnitude_uncertainty"),
            };
            let found = fundamental[value].as_f64().unwrap();
            fundamental.insert(deviation.to_owned(), json!(relative * found));
        }
    }
    let chi_square = |report: &Value| {
        let path = folder.path().join("analysis.json");
        std::fs::write(&path, report.to_string()).unwrap();
        let mut options = ExploreOptions::default();
        options.data = Some(path);
        let page = Page::of_document(changed("/duration_s", "0.12"), &options);
        let lines = page.compute("levels", &["levels"], &json!([]));
        let words = lines.iter().rev().find(|line| line["answer"] == "words").unwrap();
        let words = words["text"].as_str().unwrap().to_owned();
        let data =
            lines.iter().rev().find(|line| line["answer"] == "picture").unwrap()["data"].clone();
        (page, words, data.as_str().unwrap().to_owned())
    };
    let value = |words: &str, name: &str| -> f64 {
        let found =
            words.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("{words}"));
        found.split(": ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
    };
    let (page, words, data) = chi_square(&report);
    assert!(words.contains("each under its own measured force"), "{words}");
    assert!(data.contains("computed, own force"));
    let own: f64 = FEATURES.iter().map(|name| value(&words, name)).sum();
    // The force of a hit becomes that of the scenario.
    let asked = json!({ "changes": [], "hit": 1 });
    let pulse: Value = serde_json::from_str(&page.post("pulse", &asked).body).unwrap();
    let changes = json!([["/excitation", pulse["excitation"]]]);
    let state = page.post("state", &json!({ "changes": changes }));
    let state: Value = serde_json::from_str(&state.body).unwrap();
    assert_eq!((&state["driven"], &state["faults"]), (&json!(1), &json!([])), "{pulse}");
    assert_eq!(state["hits"][1], json!({ "force_n": "6", "pulse": true }));
    let words = page.compute("hit", &["frf"], &changes);
    let words = line(&words, "words")["text"].as_str().unwrap().to_owned();
    let mut same = changed("/duration_s", "0.12");
    let force = json!({ "kind": "half_sine", "peak_n": 6, "duration_s": 1.2e-3 });
    same.set("/excitation", &force.to_string()).unwrap();
    let run = simulate(&same, &same.scenario().unwrap()).unwrap();
    let first = words
        .lines()
        .find(|line| line.contains("fundamental"))
        .unwrap_or_else(|| panic!("{words}"));
    let found = first.split_whitespace().find_map(|word| word.parse::<f64>().ok()).unwrap();
    assert!((found / run.summary.fundamental.unwrap().frequency_hz - 1.0).abs() < 2e-5, "{words}");
    let none = page.post("pulse", &json!({ "changes": [], "hit": 3 })).body;
    assert!(none.contains("no measured force"), "{none}");
    // Without the records the pulse is the scenario's, and the page says why.
    for hit in report["hits"].as_array_mut().unwrap() {
        let name = hit["file"].as_str().unwrap();
        hit["file"] = json!(format!("elsewhere/{}", name.replace("hit_", "no_")));
    }
    let (_page, words, data) = chi_square(&report);
    assert!(
        words.contains("with the pulse of the scenario") && words.contains("was not found"),
        "{words}"
    );
    assert!(!data.contains("computed, own force"));
    let scaled: f64 = FEATURES.iter().map(|name| value(&words, name)).sum();
    assert!(
        own < 0.1 && scaled > 3.0 * own,
        "{own} under own forces, {scaled} under the scenario's"
    );
}

const FEATURES: [&str; 2] = ["fundamental.frequency_hz", "fundamental.receptance_m_per_n"];
