//! The contract of the command: options, exit status, files, columns, printed JSON.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stderr, reason = "a test without its data says that it was skipped")]

mod analyse;
mod bounds;
mod command;
mod contact_export;
mod decay;
mod diagnostics;
mod explore;
mod gap_import;
mod help;
mod identify;
mod pages;
mod readme;
mod result_folders;
mod rough_surfaces;
mod steady;
mod streams;
mod study;
mod tutorial;
mod watch;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name)
}

fn asperity(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_asperity"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The JSON that a successful command prints.
fn answer(folder: &Path, arguments: &[&str]) -> Value {
    let output = asperity(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(value: &Value, pointer: &str) -> f64 {
    let found = value.pointer(pointer).and_then(Value::as_f64);
    found.unwrap_or_else(|| panic!("{pointer} is not a number in {value:#}"))
}

/// Files that `simulate` writes.
const FILES_OF_A_RUN: [&str; 6] =
    ["frf.csv", "frf.svg", "history.csv", "history.svg", "pressure-closure.svg", "summary.json"];

/// Names of the files in a folder without hidden ones, sorted; none if there is no folder.
fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .map(|entries| {
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
        })
        .unwrap_or_default();
    names.retain(|name| !name.starts_with('.'));
    names.sort();
    names
}
