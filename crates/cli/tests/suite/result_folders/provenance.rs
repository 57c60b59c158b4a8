//! Provenance: the contents of every file that a result depends on.

use std::fs;

use asperity_scenario::file_sha256;
use serde_json::{Value, json};

use super::{QUICK, rig, store, succeed};
use crate::{answer, fixture};

const PULSE: &str = "time_s,force_n\n0,0\n0.0005,20\n0.001,0\n";

/// Name and hash of each file.
fn files_of(answer: &Value) -> Vec<(String, String)> {
    let files = answer["provenance"]["files"].as_array().unwrap();
    let text = |file: &Value, key: &str| file[key].as_str().unwrap().to_owned();
    files.iter().map(|file| (text(file, "file"), text(file, "sha256"))).collect()
}

#[test]
fn the_contents_of_samples_are_part_of_the_provenance() {
    let folder = tempfile::tempdir().unwrap();
    let mut scenario = rig();
    scenario["excitation"] = json!({"kind": "samples", "file": "forces/a.csv"});
    store(&folder.path().join("project/rig.json"), &scenario);
    let samples = folder.path().join("project/forces");
    fs::create_dir(&samples).unwrap();
    fs::write(samples.join("a.csv"), PULSE).unwrap();
    fs::write(samples.join("b.csv"), PULSE.replace("20", "30")).unwrap();
    let hash = |name: &str| (format!("forces/{name}"), file_sha256(&samples.join(name)).unwrap());
    let simulate = [&["simulate", "project/rig.json", "--json"], &QUICK[..]].concat();
    let before = answer(folder.path(), &simulate);
    assert_eq!(files_of(&before), [hash("a.csv")]);
    for command in ["modes", "law"] {
        let found = answer(folder.path(), &[command, "project/rig.json", "--json"]);
        assert_eq!(files_of(&found), [hash("a.csv")], "{command}");
    }
    let vary = ["--vary", "/excitation/file=forces/a.csv,forces/b.csv"];
    let sweep = [&["sweep", "project/rig.json", "--json"], &vary[..], &QUICK[..]].concat();
    assert_eq!(files_of(&answer(folder.path(), &sweep)), [hash("a.csv"), hash("b.csv")]);

    // The same scenario with other samples is another computation.
    fs::write(samples.join("a.csv"), PULSE.replace("20", "25")).unwrap();
    let after = answer(folder.path(), &simulate);
    assert_eq!(files_of(&after), [hash("a.csv")]);
    assert_ne!(files_of(&after), files_of(&before));
    let [old, new] = [&before, &after].map(|one| &one["provenance"]["scenario_sha256"]);
    assert_eq!(old, new);
}

#[test]
fn the_table_of_a_fit_is_part_of_the_provenance() {
    let folder = tempfile::tempdir().unwrap();
    store(&folder.path().join("rig.json"), &rig());
    let table = fixture("paper/table3.csv");
    let name = table.display().to_string();
    let found = answer(folder.path(), &["law", "rig.json", "--json", "--fit", &name]);
    assert_eq!(files_of(&found), [(name, file_sha256(&table).unwrap())]);
    succeed(folder.path(), &["law", "rig.json"]);
    let written = fs::read_to_string(folder.path().join("out/rig/law.json")).unwrap();
    assert!(files_of(&serde_json::from_str(&written).unwrap()).is_empty());
}
