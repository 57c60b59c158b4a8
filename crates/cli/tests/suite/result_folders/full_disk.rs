//! A full disk: an error of the run, the earlier result as it was, and nothing left behind.
//!
//! A limit on the size of files stands for the full disk: it fails in the same calls.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use super::{QUICK, entries, hammer_csv, rig, store, succeed};
use crate::text;

/// Runs a command that can write files of at most 8 blocks, 4 or 8 KiB, and gets an error, not a
/// signal, beyond.
fn with_full_disk(folder: &Path, arguments: &[&str]) -> Output {
    Command::new("sh")
        .args(["-c", r#"trap "" XFSZ && ulimit -f 8 && exec "$0" "$@""#])
        .arg(env!("CARGO_BIN_EXE_asperity"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap()
}

/// Contents of all files in a folder.
fn contents(folder: &Path) -> Vec<Vec<u8>> {
    entries(folder).iter().map(|name| fs::read(folder.join(name)).unwrap()).collect()
}

#[test]
fn a_full_disk_leaves_the_earlier_result() {
    let folder = tempfile::tempdir().unwrap();
    store(&folder.path().join("rig.json"), &rig());
    let out = folder.path().join("out/rig");
    let commands = [
        [&["simulate", "rig.json"], &QUICK[..]].concat(),
        vec!["law", "rig.json"],
        vec!["modes", "rig.json"],
    ];
    for arguments in &commands {
        let output = with_full_disk(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
        assert_eq!(entries(folder.path()), ["rig.json"], "{arguments:?}");
    }
    for arguments in &commands {
        succeed(folder.path(), arguments);
        let before = contents(&out);
        let output = with_full_disk(folder.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains("cannot write out/rig/"), "{message}");
        assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
        assert_eq!(contents(&out), before, "{arguments:?}");
        assert_eq!(entries(&folder.path().join("out")), ["rig"], "{arguments:?}");
    }
}

#[test]
fn a_full_disk_leaves_the_earlier_file_of_a_conversion() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("hit.csv"), hammer_csv(4000)).unwrap();
    fs::write(folder.path().join("hit.uff"), "as it was").unwrap();
    let output = with_full_disk(folder.path(), &["convert", "hit.csv", "hit.uff", "--overwrite"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("hit.uff"), "{message}");
    assert_eq!(fs::read_to_string(folder.path().join("hit.uff")).unwrap(), "as it was");
    assert_eq!(entries(folder.path()), ["hit.csv", "hit.uff"]);
}
