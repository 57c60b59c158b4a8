//! Written universal files read by pyuff, if Python and pyuff are available.

use std::path::Path;
use std::process::Command;

use asperity_measure::{Format, WriteOptions, write};

use crate::build::{channel, record};

#[test]
fn pyuff_reads_what_we_write() {
    let folder = tempfile::tempdir().unwrap();
    let wave = |scale: f64| (0..37).map(|n| scale * (0.4 * f64::from(n)).sin() / 3.0).collect();
    let hit = [record(vec![
        channel("hammer", "N", 51_200.0, wave(50.0)),
        channel("top", "m/s^2", 51_200.0, wave(-8.0)),
    ])];
    let place = |name: &str| folder.path().join(name);
    let options =
        WriteOptions { title: "beam".into(), date: "01-Nov-26".into(), ..WriteOptions::default() };
    write(&place("expected.npz"), &hit, Format::Npz, &options).unwrap();
    write(&place("text.uff"), &hit, Format::UniversalText, &options).unwrap();
    write(&place("binary.uff"), &hit, Format::UniversalBinary, &options).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pyuff_check.py");
    let python = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let run = Command::new(python)
        .arg(script)
        .args(["expected.npz", "text.uff", "binary.uff"].map(place))
        .output();
    let Ok(output) = run else {
        eprintln!("skipped: there is no python3");
        return;
    };
    let said = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(77) {
        eprintln!("skipped: {said}");
        return;
    }
    assert!(output.status.success(), "{said}");
}
