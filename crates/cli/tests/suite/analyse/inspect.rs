//! `asperity inspect`, and folders and patterns as input.

use asperity_measure::Format;

use super::{store, test_record};
use crate::{answer, asperity, text};

/// The channels of a file, their ranges and roles; a file whose channels are not clear says why, and
/// one that cannot be read does not hide the others.
#[test]
fn files_are_described_before_an_analysis() {
    let folder = tempfile::tempdir().unwrap();
    let file = store(folder.path(), "test.uff", test_record(), Format::UniversalBinary);
    let found = answer(folder.path(), &["inspect", &file, "--json"]);
    assert_eq!(found["schema"], "asperity/inspection/1");
    assert_eq!((&found["force"]["channel"], &found["response"]["channel"]), (&1.into(), &2.into()));
    let force = &found["channels"][0];
    assert_eq!((&force["unit"], &force["quantity"]), (&"N".into(), &"force".into()));
    let largest = force["range"][1].as_f64().unwrap();
    assert!((largest / 30.0 - 1.0).abs() < 0.02, "{largest}");

    let printed = text(&asperity(folder.path(), &["inspect", &file]).stdout);
    assert!(printed.contains("analyse takes #1 `hammer` as the force"), "{printed}");

    std::fs::write(folder.path().join("a.csv"), "time_s,volts [V]\n0,1\n0.1,2\n0.2,1\n").unwrap();
    std::fs::write(folder.path().join("b.csv"), "not a measurement").unwrap();
    let output = asperity(folder.path(), &["inspect", "."]);
    let printed = text(&output.stdout);
    assert_eq!(output.status.code(), Some(2));
    assert!(printed.contains("force: no channel for the force"), "{printed}");
    assert!(printed.contains("b.csv: cannot be read"), "{printed}");
    assert!(printed.contains("test.uff: UFF 58b, 1 record"), "{printed}");
    assert!(text(&output.stderr).contains("b.csv"), "{}", text(&output.stderr));
}

/// A folder and a pattern are the files in them, in natural order, and give the analysis of these.
#[test]
fn folders_and_patterns_are_files() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["hit_10.uff", "hit_9.uff"] {
        store(folder.path(), name, test_record(), Format::UniversalBinary);
    }
    std::fs::write(folder.path().join("notes.md"), "two files").unwrap();
    let given = ["analyse", "hit_9.uff", "hit_10.uff", "--out", "a", "--json"];
    let expected = answer(folder.path(), &given);
    let by_pattern = answer(folder.path(), &["analyse", "hit_*.uff", "--out", "b", "--json"]);
    assert_eq!(expected, by_pattern);
    let output = asperity(folder.path(), &["analyse", "x_*.uff"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("no measurement file there"));
}
