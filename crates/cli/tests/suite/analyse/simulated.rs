//! Simulated runs, written as records, take the way of measured ones.

use std::path::PathBuf;

use crate::{answer, number};

/// Changes of the rig: coarse cells, and an output rate at which observables are read from the output samples alone.
const COARSE: [&str; 4] = ["--set", "/method/cell_m=0.005", "--set", "/output_rate_hz=500000"];

/// A run written as a record and analysed gives its own summary again: from displacement to
/// rounding, from acceleration to what the record's start and end leave (1e-5 measured).
#[test]
fn a_simulated_run_takes_the_same_way() {
    let folder = tempfile::tempdir().unwrap();
    let fixtures = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/scenarios");
    let rig = fixtures.join("nouira2020-modified.json").display().to_string();
    for (format, file, tight) in [("uff", "record.uff", 1e-12), ("uff-ascii", "record.uff", 1e-9)] {
        let run = ["simulate", &rig, "--json", "--out", format, "--record", format];
        let summary = answer(folder.path(), &[&run[..], &COARSE].concat());
        let record = format!("{format}/{file}");
        for (response, tolerance) in [("displacement", tight), ("acceleration", 1e-3)] {
            let asked =
                ["analyse", &record, "--response", response, "--json", "--out", "a", "--overwrite"];
            let found = answer(folder.path(), &asked);
            for (direct, measured) in [
                ("/fundamental/frequency_hz", "/hits/0/fundamental/frequency_hz"),
                ("/fundamental/receptance_m_per_n", "/hits/0/fundamental/magnitude"),
                ("/harmonic_ratio", "/hits/0/harmonic_ratio"),
            ] {
                let off = number(&found, measured) / number(&summary, direct) - 1.0;
                assert!(off.abs() < tolerance, "{format} {response} {direct}: {off:e}");
            }
        }
    }
}

/// The paper's sweep of levels by a second way: runs at three forces, written as records, are one
/// test; each hit gives its run's fundamental, height and harmonic ratio, from displacement to
/// rounding, and the fundamental falls while the ratio grows.
#[test]
fn levels_of_the_rig_are_found_from_their_records() {
    let folder = tempfile::tempdir().unwrap();
    let fixtures = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/scenarios");
    let rig = fixtures.join("nouira2020-modified.json").display().to_string();
    let summaries = ["9", "20", "32"].map(|force| {
        let level = format!("/excitation/peak_n={force}");
        let run = ["simulate", &rig, "--json", "--out", force, "--set", &level, "--record", "uff"];
        answer(folder.path(), &[&run[..], &COARSE].concat())
    });
    let records = ["9/record.uff", "20/record.uff", "32/record.uff"];
    let asked = ["--response", "displacement", "--band", "600:1000", "--json"];
    let found = answer(folder.path(), &[&["analyse"], &records[..], &asked].concat());
    assert_eq!(found["average"]["hits"], 3);
    let of = |key: &str| [0, 1, 2].map(|hit| number(&found["hits"][hit], key));
    for (direct, measured) in [
        ("/fundamental/frequency_hz", "/fundamental/frequency_hz"),
        ("/fundamental/receptance_m_per_n", "/fundamental/magnitude"),
        ("/harmonic_ratio", "/harmonic_ratio"),
    ] {
        for (summary, measured) in summaries.iter().zip(of(measured)) {
            let off = measured / number(summary, direct) - 1.0;
            // The refinement of a peak ends at 1e-12 of its frequency.
            assert!(off.abs() < 1e-11, "{direct}: {off:e}");
        }
    }
    let (frequency, ratio) = (of("/fundamental/frequency_hz"), of("/harmonic_ratio"));
    assert!(frequency.windows(2).all(|pair| pair[1] < pair[0]), "{frequency:?}");
    assert!(ratio.windows(2).all(|pair| pair[1] > pair[0]), "{ratio:?}");
}
