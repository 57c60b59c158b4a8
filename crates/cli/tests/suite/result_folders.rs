//! Result folders: replaced as a whole, by one run at a time, with nothing of a user lost.

#[cfg(unix)]
mod full_disk;
#[cfg(unix)]
mod killed;
mod provenance;

use std::fs;
use std::path::{Path, PathBuf};

use asperity_simulation::output::{OutputFolder, OutputRequest};
use serde_json::{Value, json};

use crate::{asperity, files, fixture, text};

/// A quick run of the rig.
const QUICK: [&str; 4] = ["--set", "/method/cell_m=0.005", "--set", "/duration_s=0.04"];

fn rig() -> Value {
    let path = fixture("scenarios/nouira2020-modified.json");
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// Stores a scenario, with folders where there are none.
fn store(path: &Path, scenario: &Value) -> PathBuf {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, scenario.to_string()).unwrap();
    path.to_owned()
}

/// Runs a command that succeeds.
fn succeed(folder: &Path, arguments: &[&str]) {
    let output = asperity(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
}

/// Runs a command that is refused with status 2, and returns its message.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = asperity(folder, arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    message
}

/// All entries of a folder, hidden ones included, sorted.
fn entries(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A record of a force.
#[cfg(unix)]
fn hammer_csv(rows: usize) -> String {
    let row = |row: usize| format!("{},{}", row as f64 * 1e-4, row % 7);
    let rows: Vec<String> = (0..rows).map(row).collect();
    format!("time_s,hammer (N)\n{}\n", rows.join("\n"))
}

#[test]
fn tables_of_laws_that_no_longer_exist_are_removed() {
    let folder = tempfile::tempdir().unwrap();
    let mut scenario = rig();
    let path = store(&folder.path().join("rig.json"), &scenario);
    succeed(folder.path(), &["law", "rig.json"]);
    let out = folder.path().join("out/rig");
    assert!(files(&out).contains(&"law-constant.csv".to_owned()));
    scenario["laws"] = json!({"modified": scenario["laws"]["modified"]});
    store(&path, &scenario);
    succeed(folder.path(), &["law", "rig.json"]);
    assert_eq!(files(&out), ["law-modified.csv", "law.json", "law.svg"]);
}

#[test]
fn commands_on_one_scenario_share_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    store(&folder.path().join("rig.json"), &rig());
    succeed(folder.path(), &[&["simulate", "rig.json"], &QUICK[..]].concat());
    let mut both = files(&folder.path().join("out/rig"));
    succeed(folder.path(), &["modes", "rig.json"]);
    both.extend(["modes.csv", "modes.json", "modes.svg"].map(str::to_owned));
    both.sort();
    assert_eq!(files(&folder.path().join("out/rig")), both);
    assert_eq!(entries(&folder.path().join("out")), ["rig"]);
}

/// Neither by default nor in one folder does `steady` replace what `simulate` has written, and a run
/// without a result keeps the earlier one.
#[test]
fn steady_after_simulate_keeps_its_files() {
    let folder = tempfile::tempdir().unwrap();
    store(&folder.path().join("rig.json"), &rig());
    succeed(folder.path(), &[&["simulate", "rig.json"], &QUICK[..]].concat());
    let simulated = files(&folder.path().join("out/rig"));
    let steady = ["steady", "rig.json", "--amplitude", "1", "--from", "700", "--to", "1000"];
    succeed(folder.path(), &steady);
    assert_eq!(files(&folder.path().join("out/rig")), simulated);
    let found = files(&folder.path().join("out/rig-steady"));
    assert!(found.contains(&"steady.csv".to_owned()) && found.contains(&"summary.json".to_owned()));
    let message = refused(folder.path(), &[&steady[..], &["--out", "out/rig"]].concat());
    assert!(message.contains("`simulate`, which would be replaced"), "{message}");
    assert!(message.contains("--overwrite"), "{message}");
    assert_eq!(files(&folder.path().join("out/rig")), simulated);
    let table = || fs::read(folder.path().join("out/sweep/sweep.csv")).unwrap();
    let sweep = |values: &str| {
        let vary = format!("/excitation/peak_n={values}");
        let asked = ["sweep", "rig.json", "--vary", &vary, "--out", "out/sweep"];
        asperity(folder.path(), &[&asked[..], &QUICK].concat())
    };
    assert!(sweep("1,2").status.success());
    let before = table();
    let failed = sweep("1e300");
    if !failed.status.success() {
        let message = text(&failed.stderr);
        assert!(message.contains("keeps its earlier result"), "{message}");
        assert_eq!(table(), before);
    }
}

/// A command with its values and its folder.
type Run<'a> = &'a dyn Fn(&str, &str) -> std::process::Output;

/// A run of which a part fails is written beside the finished result of the folder, and in its place once
/// that is partial, too.
#[test]
fn partial_runs_keep_the_finished_result() {
    let folder = tempfile::tempdir().unwrap();
    store(&folder.path().join("rig.json"), &rig());
    let modal = ["--set", "/method=modal", "--set", "/duration_s=0.04"];
    let sweep = |values: &str, out: &str| {
        let vary = format!("/excitation/peak_n={values}");
        let asked = ["sweep", "rig.json", "--vary", &vary, "--out", out];
        asperity(folder.path(), &[&asked[..], &modal].concat())
    };
    let steady = |amplitudes: &str, out: &str| {
        let range = ["--from", "700", "--to", "1000", "--harmonics", "5"];
        let asked = ["steady", "rig.json", "--amplitude", amplitudes, "--out", out];
        asperity(folder.path(), &[&asked[..], &range].concat())
    };
    let cases: [(Run<'_>, [&str; 2], &str); 2] =
        [(&sweep, ["1,2", "1,1e300"], "sweep.csv"), (&steady, ["0.5", "0.6,1e9"], "steady.csv")];
    for (run, [good, partial], table) in cases {
        let read = |out: &str| fs::read(folder.path().join(out).join(table)).unwrap();
        let output = run(good, table);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let before = read(table);
        let output = run(partial, table);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        let beside = format!("{table}-partial");
        assert!(message.contains("keeps its finished result") && message.contains(&beside));
        assert_eq!(read(table), before);
        assert_ne!(read(&beside), before);
        // A first run, and one after it, have nothing to keep.
        for _ in 0..2 {
            let output = run(partial, &format!("new-{table}"));
            assert_eq!(output.status.code(), Some(1));
            assert!(!text(&output.stderr).contains("finished result"));
        }
    }
}

/// Results of measurements are not replaced by those of another file.
#[test]
fn the_analysis_of_another_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.uff", "b.uff"] {
        crate::watch::hit(folder.path(), name, &[(0.02, 10.0)]);
    }
    let analyse = |name: &'static str| ["analyse", name, "--band", "400:600", "--out", "result"];
    succeed(folder.path(), &analyse("a.uff"));
    let message = refused(folder.path(), &analyse("b.uff"));
    assert!(message.contains("a.uff") && message.contains("--overwrite"), "{message}");
    succeed(folder.path(), &analyse("a.uff"));
    succeed(folder.path(), &[&analyse("b.uff")[..], &["--overwrite"]].concat());
}

/// By default both write to `out/rig`.
#[test]
fn two_scenarios_of_one_name_do_not_share_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a/rig.json", "b/rig.json"] {
        store(&folder.path().join(name), &rig());
    }
    succeed(folder.path(), &["law", "a/rig.json"]);
    let first = fs::read(folder.path().join("out/rig/law.json")).unwrap();
    for command in ["law", "modes"] {
        let message = refused(folder.path(), &[command, "b/rig.json"]);
        let other = Path::new("a").join("rig.json").display().to_string();
        assert!(message.contains(&other) && message.contains("--out"), "{message}");
    }
    assert_eq!(fs::read(folder.path().join("out/rig/law.json")).unwrap(), first);
    succeed(folder.path(), &["law", "a/rig.json"]);
    succeed(folder.path(), &["modes", "b/rig.json", "--out", "out/b"]);
    succeed(folder.path(), &["modes", "b/rig.json", "--overwrite"]);
    let out = folder.path().join("out/rig");
    assert_eq!(files(&out), ["modes.csv", "modes.json", "modes.svg"]);
    // A folder that is named holds what was written last.
    succeed(folder.path(), &["modes", "a/rig.json", "--out", "out/rig"]);
}

#[test]
fn files_of_the_user_are_listed_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    store(&folder.path().join("rig.json"), &rig());
    succeed(folder.path(), &["modes", "rig.json"]);
    let out = folder.path().join("out/rig");
    fs::write(out.join("thesis.tex"), "x").unwrap();
    fs::create_dir(out.join("photographs")).unwrap();
    fs::write(out.join("photographs/rig.jpg"), "x").unwrap();
    let message = refused(folder.path(), &["modes", "rig.json"]);
    assert!(message.contains("photographs, thesis.tex"), "{message}");
    assert!(message.contains("--overwrite") && message.contains("--out"), "{message}");
    succeed(folder.path(), &["modes", "rig.json", "--overwrite", "--count", "2"]);
    let modes = fs::read_to_string(out.join("modes.json")).unwrap();
    let modes: Value = serde_json::from_str(&modes).unwrap();
    assert_eq!(modes["modes"].as_array().unwrap().len(), 2);
    assert_eq!(fs::read_to_string(out.join("thesis.tex")).unwrap(), "x");
    assert_eq!(fs::read_to_string(out.join("photographs/rig.jpg")).unwrap(), "x");
    assert!(!out.join(".asperity").exists());
}

/// A receptance of one line, at zero frequency, has no curve.
#[test]
fn a_figure_that_cannot_be_drawn_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    store(&folder.path().join("rig.json"), &rig());
    let set = ["--set", "/duration_s=8e-5", "--set", "/bodies/0/mass_kg=60"];
    let output = asperity(folder.path(), &[&["simulate", "rig.json"], &set[..]].concat());
    let message = text(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(message.contains("frf.svg cannot be drawn"), "{message}");
    let written = files(&folder.path().join("out/rig"));
    assert_eq!(
        written,
        ["frf.csv", "history.csv", "history.svg", "pressure-closure.svg", "summary.json"]
    );
}

#[test]
fn two_runs_do_not_write_to_one_folder_at_the_same_time() {
    let folder = tempfile::tempdir().unwrap();
    let document = store(&folder.path().join("rig.json"), &rig());
    let out = folder.path().join("out/rig");
    let request = OutputRequest {
        folder: &out,
        command: "simulate",
        document: &document,
        replace_other_document: false,
        overwrite: false,
    };
    let other_run = OutputFolder::claim(&request).unwrap();
    let message = refused(folder.path(), &["modes", "rig.json"]);
    assert!(message.contains("another run") && message.contains("--out"), "{message}");
    succeed(folder.path(), &["modes", "rig.json", "--out", "out/other"]);
    drop(other_run);
    succeed(folder.path(), &["modes", "rig.json"]);
}

/// The working directory is not exchanged: a shell in it would be left in a removed folder.
#[cfg(unix)]
#[test]
fn the_working_directory_stays_the_same_folder() {
    use std::os::unix::fs::MetadataExt;
    let folder = tempfile::tempdir().unwrap();
    let path = store(&folder.path().join("rig.json"), &rig()).display().to_string();
    let out = folder.path().join("here");
    fs::create_dir(&out).unwrap();
    let before = fs::metadata(&out).unwrap().ino();
    for count in ["3", "2"] {
        succeed(&out, &["modes", &path, "--out", ".", "--count", count]);
        assert_eq!(fs::metadata(&out).unwrap().ino(), before);
        assert_eq!(entries(&out), [".asperity.json", "modes.csv", "modes.json", "modes.svg"]);
    }
    assert_eq!(entries(folder.path()), ["here", "rig.json"]);
}
