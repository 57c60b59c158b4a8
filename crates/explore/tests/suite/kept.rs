//! Files of a state.

use std::path::Path;

use asperity_explore::ExploreOptions;
use asperity_scenario::Document;
use asperity_simulation::record::history_csv;
use asperity_simulation::run::simulate;
use serde_json::{Value, json};

use crate::client::{Page, block};

fn page_of(out: &Path) -> Page {
    let mut options = ExploreOptions::default();
    options.out = Some(out.to_owned());
    Page::of(&block(), &options)
}

fn keep(page: &Page, overwrite: bool) -> Value {
    let changes = json!([["/excitation/peak_n", 9]]);
    let views = ["law", "frf", "history", "pressure_closure"];
    let asked = json!({ "changes": changes, "views": views, "overwrite": overwrite });
    serde_json::from_str(&page.post("keep", &asked).body).unwrap()
}

#[test]
fn saved_files_are_the_commands() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let page = page_of(&out);
    assert!(!out.exists(), "nothing is written before");
    let answer = keep(&page, false);
    let written: Vec<&str> =
        answer["written"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    for name in ["scenario.json", "law.svg", "frf.pdf", "history.png", "frf.csv", "law-rough.csv"] {
        assert!(written.contains(&name) && out.join(name).is_file(), "{name}: {answer}");
    }
    let saved = Document::read(out.join("scenario.json")).unwrap();
    assert_eq!(saved.value()["excitation"]["peak_n"], 9);
    let run = simulate(&saved, &saved.scenario().unwrap()).unwrap();
    assert_eq!(std::fs::read_to_string(out.join("history.csv")).unwrap(), history_csv(&run));
    let drawn = std::fs::read_to_string(out.join("history.svg")).unwrap();
    assert_eq!(drawn, asperity_plot::history(&run).to_svg());
    let drawn = std::fs::read_to_string(out.join("pressure-closure.svg")).unwrap();
    assert_eq!(drawn, asperity_plot::pressure_closure(&run).unwrap().to_svg());
}

#[test]
fn a_file_is_replaced_only_when_asked() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("frf.csv");
    std::fs::write(&own, "mine").unwrap();
    let page = page_of(folder.path());
    let answer = keep(&page, false);
    assert_eq!(answer["existing"], json!(["frf.csv"]));
    assert_eq!(std::fs::read_to_string(&own).unwrap(), "mine");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is written");
    assert!(keep(&page, true)["written"].is_array());
    assert_ne!(std::fs::read_to_string(&own).unwrap(), "mine");
}

#[test]
fn a_place_that_takes_no_files_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let answer = keep(&page_of(&file), false);
    assert!(answer["error"].as_str().unwrap().contains("file"), "{answer}");
}

/// The commands that are copied compute the same state.
#[test]
fn copied_commands_repeat_all_changes() {
    let mut document = Document::read(block()).unwrap();
    document.set("/damping/ratio", "0.03").unwrap();
    let mut options = ExploreOptions::default();
    options.set = vec!["/damping/ratio=0.03".to_owned()];
    let page = Page::of_document(document, &options);
    let asked = json!({ "changes": [["/excitation/peak_n", 9]],
                        "settings": { "amplitudes": [0.2], "from_hz": 1200, "to_hz": 1900 } });
    let state: Value = serde_json::from_str(&page.post("state", &asked).body).unwrap();
    let texts: Vec<&str> = state["commands"]
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["text"].as_str().unwrap())
        .collect();
    let set = "block.json --set /damping/ratio=0.03 --set /excitation/peak_n=9";
    assert!(texts.iter().all(|text| text.contains(set)), "{texts:?}");
    assert!(texts[1].contains("--vary /excitation/peak_n=0.5:7.5:24"), "{texts:?}");
    assert!(texts[2].ends_with("--amplitude 0.2 --from 1200 --to 1900"), "{texts:?}");
}
