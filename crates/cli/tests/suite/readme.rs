//! The commands of the README, in its order, in one folder: each succeeds, and none takes files of
//! another away.

use std::collections::BTreeSet;
use std::path::Path;

use crate::{asperity, files, text, watch};

const README: &str = include_str!("../../../../README.md");

/// The commands of code blocks and of the table, without `asperity`.
fn commands() -> Vec<String> {
    let mut found = Vec::new();
    for line in README.lines() {
        if let Some(command) = line.strip_prefix("asperity ") {
            found.push(command.to_owned());
        } else if let Some(rest) = line.strip_prefix("| `asperity ")
            && let Some((command, _)) = rest.split_once('`')
        {
            found.push(command.to_owned());
        }
    }
    found
}

/// A free decay at 500 Hz.
fn decay(path: &Path) {
    let row = |n: u32| {
        let t = f64::from(n) / 5000.0;
        let since = (t - 0.1).max(0.0);
        let x = if t < 0.1 { 0.0 } else { (-30.0 * since).exp() * (3141.6 * since).sin() };
        format!("{t:.4},{x:.6}\n")
    };
    let rows: String = (0..5000).map(row).collect();
    std::fs::write(path, format!("time_s,top (m/s^2)\n{rows}")).unwrap();
}

#[test]
fn the_commands_of_the_readme_succeed_and_lose_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let scenarios = place.join("fixtures/scenarios");
    std::fs::create_dir_all(&scenarios).unwrap();
    std::fs::create_dir(place.join("hits")).unwrap();
    let scenario = "fixtures/scenarios/nouira2020-modified.json";
    std::fs::copy(crate::fixture("scenarios/nouira2020-modified.json"), place.join(scenario))
        .unwrap();
    for (name, force) in [("hits/1.uff", 10.0), ("hits/2.uff", 12.0), ("hits/3.uff", 11.0)] {
        watch::hit(place, name, &[(0.02, force)]);
    }
    decay(&place.join("decay.csv"));
    let problem = crate::identify::quick_problem(&crate::identify::rig());
    std::fs::write(place.join("problem.json"), problem.to_string()).unwrap();
    let study = serde_json::json!({
        "schema": "asperity/study/1",
        "scenario": scenario,
        "inputs": [
            {"pointer": "/excitation/peak_n", "name": "force",
             "distribution": {"kind": "uniform", "lower": 9, "upper": 12}}
        ],
        "design": {"kind": "sobol", "rows": 4, "seed": 1}
    });
    std::fs::write(place.join("study.json"), study.to_string()).unwrap();

    let folders = |out: &Path| -> BTreeSet<String> {
        files(out)
            .iter()
            .flat_map(|name| {
                let inside = files(&out.join(name));
                inside.into_iter().map(move |file| format!("{name}/{file}"))
            })
            .collect()
    };
    let mut before = BTreeSet::new();
    let commands = commands();
    assert!(commands.len() > 10, "{commands:?}");
    // The live page is open until Ctrl-C.
    for command in commands.into_iter().filter(|command| !command.starts_with("explore")) {
        let mut arguments: Vec<&str> = Vec::new();
        for word in command.split_whitespace() {
            match word {
                "SCENARIO" => arguments.push(scenario),
                "FILE..." if command.starts_with("decay") => arguments.push("decay.csv"),
                "FILE..." => arguments.extend(["hits/1.uff", "hits/2.uff"]),
                "FOLDER" => arguments.extend(["hits", "--once"]),
                "PROBLEM" => arguments.push("problem.json"),
                "STUDY" => arguments.push("study.json"),
                word => arguments.push(word),
            }
        }
        let output = asperity(place, &arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        let after = folders(&place.join("out"));
        let lost: Vec<&String> = before.difference(&after).collect();
        assert!(lost.is_empty(), "{arguments:?} takes {lost:?} away");
        before = after;
    }
    for file in ["nouira2020-modified/frf.csv", "nouira2020-modified-steady/steady.csv"] {
        assert!(before.contains(file), "{before:?}");
    }
}
