//! Standard output and standard error that are closed, full, or no terminal.
#![cfg(unix)]

use std::fs::OpenOptions;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::{FILES_OF_A_RUN, files, fixture, text};

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_asperity"));
    command.args(arguments).current_dir(folder);
    command
}

/// A device that accepts no byte, where the system has one.
fn full() -> Option<Stdio> {
    OpenOptions::new().write(true).open("/dev/full").ok().map(Stdio::from)
}

/// Every command with an answer, on files that it accepts. Measurements are simulated.
fn answers(folder: &Path) -> Vec<Vec<String>> {
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    let quick = "--set=/duration_s=0.01";
    let record = ["simulate", &rig, quick, "--record", "csv", "--quiet", "--out", "hits"];
    assert!(command(folder, &record).status().unwrap().success());
    let commands: [&[&str]; 11] = [
        &["--help"],
        &["--version"],
        &["help", "sweep"],
        &["schema"],
        &["check", &rig],
        &["check", &rig, "--json"],
        &["simulate", &rig, quick],
        &["sweep", &rig, quick, "--vary", "/excitation/peak_n=1,2", "--json"],
        &["law", &rig],
        &["modes", &rig],
        &["convert", "hits/record.csv", "record.npz", "--overwrite"],
    ];
    let owned = |part: &[&str]| part.iter().map(|&word| word.to_owned()).collect();
    commands.into_iter().map(owned).collect()
}

fn assert_answer_failed(output: &Output, arguments: &[&str]) {
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    assert!(message.contains("cannot be written to standard output"), "{arguments:?}: {message}");
}

#[test]
fn a_full_or_closed_standard_output_ends_every_command_with_status_1() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in answers(folder.path()) {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        if let Some(full) = full() {
            let output = command(folder.path(), &arguments).stdout(full).output().unwrap();
            assert_answer_failed(&output, &arguments);
        }
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = command(folder.path(), &arguments).stdout(writer).output().unwrap();
        assert_answer_failed(&output, &arguments);
        if cfg!(target_os = "linux") {
            let output = Command::new("sh")
                .args(["-c", "exec \"$0\" \"$@\" >&-", env!("CARGO_BIN_EXE_asperity")])
                .args(&arguments)
                .current_dir(folder.path())
                .output()
                .unwrap();
            assert_answer_failed(&output, &arguments);
        }
    }
    // The answer comes after the files.
    let written = files(&folder.path().join("out/nouira2020-constant"));
    assert!(FILES_OF_A_RUN.iter().all(|name| written.contains(&(*name).to_owned())), "{written:?}");
}

#[test]
fn a_command_without_an_answer_needs_no_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    let Some(full) = full() else { return };
    let arguments = ["simulate", &rig, "--set", "/duration_s=0.01", "--quiet"];
    let output = command(folder.path(), &arguments).stdout(full).output().unwrap();
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn a_full_standard_error_changes_no_status() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("broken.json"), "{\"schema\": 1,}").unwrap();
    std::fs::write(folder.path().join("empty.json"), "{}").unwrap();
    let rig = fixture("scenarios/nouira2020-constant.json").display().to_string();
    let no_rest: [&str; 6] =
        ["simulate", &rig, "--set", "/gravity_m_per_s2=0", "--set", "/interfaces/0/law=pl"];
    let cases: [(&[&str], i32); 9] = [
        (&["check", "broken.json"], 2),
        (&["check", "empty.json"], 2),
        (&["check", "empty.json", "--log-format", "json"], 2),
        (&["check", "nowhere.json"], 2),
        (&["check", "--nonsense"], 2),
        (&["simulate", &rig, "--set", "/duration_s=0.01", "-vv"], 0),
        (&["sweep", &rig, "--set", "/duration_s=0.01", "--vary", "/excitation/peak_n=1,2"], 0),
        (&["check", &rig, "-vv", "--log-format", "json"], 0),
        (&no_rest, 1),
    ];
    for (arguments, status) in cases {
        let Some(full) = full() else { return };
        let output = command(folder.path(), arguments).stderr(full).output().unwrap();
        assert_eq!(output.status.code(), Some(status), "{arguments:?}");
    }
}

#[test]
fn no_escape_sequence_reaches_a_standard_error_that_is_no_terminal() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("broken.json"), "{\"a\": \u{1b}[31m}").unwrap();
    std::fs::write(folder.path().join("empty.json"), "{}").unwrap();
    let cases: [&[&str]; 5] = [
        &["check", "broken.json"],
        &["check", "empty.json", "-vv"],
        &["check", "\u{1b}[31mred.json"],
        &["check", "--nonsense"],
        &["schema", "-vv"],
    ];
    for arguments in cases {
        // Variables by which programs colour their output although no terminal reads it.
        for (name, value) in [("CLICOLOR_FORCE", "1"), ("FORCE_COLOR", "1"), ("NO_COLOR", "1")] {
            let mut command = command(folder.path(), arguments);
            let output = command.env(name, value).env("TERM", "xterm-256color").output().unwrap();
            let message = text(&output.stderr);
            assert!(!message.contains('\u{1b}'), "{arguments:?} {name}: {message:?}");
        }
    }
}
