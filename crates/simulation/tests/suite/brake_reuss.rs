//! The Brake-Reuss beam, reduced and with all of its rows, against references by an independent program.
//!
//! The references are not part of this repository; without them the tests are skipped by name.

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use crate::bricks::Bricks;
use asperity_scenario::Document;
use asperity_simulation::patches::{assemble_patches, patch_modes, simulate_patches};
use asperity_structure::PreloadedContact;
use serde_json::Value;

/// The folder of the data; none where there are none, which is said for `test`.
fn data(test: &str) -> Option<PathBuf> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/fe/brake_reuss");
    if !data.is_dir() {
        eprintln!("skipped {test}: no data of brake_reuss");
        return None;
    }
    Some(data)
}

const LINEAR: &str = r#"{"kind": "constant", "stiffness_pa_per_m": 1042475690030.8336}"#;
const POWER: &str = r#"{"kind": "power", "coefficient": 2.5e9, "exponent": 0.5}"#;

const REDUCED: &str = r#"{"schema": "asperity/scenario/1",
 "bodies": [{"name": "beam", "matrices": {"format": "reduced", "stiffness": "brake_reuss_reduced.mat"}, "reduction": {"modes": 100}}],
 "loads": [{"body": "beam", "array": "f"}],
 "interfaces": [{"name": "lap", "body": "beam", "array": "W", "law": LAW}],
 "damping": {"kind": "mass_proportional", "rate_per_s": 6},
 "excitation": {"kind": "haversine", "peak_n": 100, "duration_s": 6e-4, "at": {"body": "beam", "response": 0}},
 "sensors": [{"name": "end", "at": {"body": "beam", "response": 1}, "kind": "acceleration"}],
 "duration_s": 0.02}"#;

const WHOLE: &str = r#"{"schema": "asperity/scenario/1",
 "bodies": [{"name": "beam", "mesh": "brake_reuss.inp.gz", "reduction": {"modes": 80},
             "matrices": {"format": "calculix", "stiffness": "beam.sti", "mass": "beam.mas", "rows": "beam.dof"}}],
 "loads": [{"body": "beam", "file": "loads.csv"}],
 "interfaces": [{"name": "lap", "body": "beam", "cells": "cells.csv", "law": LAW}],
 "damping": {"kind": "mass_proportional", "rate_per_s": 6},
 "excitation": {"kind": "haversine", "peak_n": 100, "duration_s": 6e-4, "at": {"body": "beam", "node": 2049, "direction": [0, 0, 1]}},
 "sensors": [{"name": "end", "at": {"body": "beam", "node": 3444, "direction": [0, 0, 1]}, "kind": "acceleration"}],
 "duration_s": 0.02}"#;

/// The ten elastic modes about the state at rest \[Hz\], after six rigid ones.
fn elastic(scenario: &str, law: &str, folder: &Path) -> Vec<f64> {
    let text = scenario.replace("LAW", law);
    let document = Document::parse(&text, folder.join("beam.json")).unwrap();
    let scenario = document.structure_scenario().unwrap();
    let assembly = assemble_patches(&scenario, document.folder()).unwrap();
    let modes = patch_modes(&assembly, 16).unwrap().modes;
    modes.iter().map(|mode| mode.frequency_hz).filter(|hz| *hz > 1.0).collect()
}

/// The frequencies of linear cells and of the power law, and the pressures of the latter, by the reference.
struct Reference {
    linear: Vec<f64>,
    power: Vec<f64>,
    pressures: Vec<f64>,
}

impl Reference {
    fn read(data: &Path) -> Self {
        let text = fs::read_to_string(data.join("reference.json")).unwrap();
        let all: Value = serde_json::from_str(&text).unwrap();
        let numbers = |list: &Value| {
            serde_json::from_value::<Vec<f64>>(list["frequency_hz"].clone()).unwrap()
        };
        let cells = all["static"]["cells"].as_array().unwrap();
        Self {
            linear: numbers(&all["modes_linear_cells"]),
            power: numbers(&all["modes"]),
            pressures: cells.iter().map(|cell| cell["pressure_pa"].as_f64().unwrap()).collect(),
        }
    }
}

fn largest_off(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    found.iter().zip(expected).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
}

/// The bolted beam from its reduced file, whose modes are those of the full matrices within 1e-5. Six motions of the free
/// beam close no cell; rounding gives one of them closures of 5e-9, which hold nothing.
#[test]
fn the_reduced_beam_vibrates_as_by_the_reference() {
    let Some(data) = data("the_reduced_beam_vibrates_as_by_the_reference") else { return };
    let reference = Reference::read(&data);
    let folder = tempfile::tempdir().unwrap();
    let file = "brake_reuss_reduced.mat";
    fs::copy(data.join(file), folder.path().join(file)).unwrap();
    for (law, expected) in [(LINEAR, &reference.linear), (POWER, &reference.power)] {
        let off = largest_off(&elastic(REDUCED, law, folder.path()), expected);
        assert!(off < 1.2e-5, "{law}: {off}");
    }
    let text = REDUCED.replace("LAW", POWER);
    let document = Document::parse(&text, folder.path().join("beam.json")).unwrap();
    let run =
        simulate_patches(&document, &document.structure_scenario().unwrap(), &|_| ()).unwrap();
    assert_eq!(run.cells[0].len(), 76);
    let least = run.cells[0].iter().map(|cell| cell.pressure_pa).fold(f64::INFINITY, f64::min);
    assert!((least / 305_605.438_374_5 - 1.0).abs() < 1e-7, "{least}");
    assert!(run.run.transient.energy.residual_relative() < 1e-3);
}

/// The beam with all of its 19,326 rows, whose matrices are made here from its deck: traces, pressures of all cells and
/// modes of the reference, which has the matrices of CalculiX. Of the modes that are left out of 80 the eighth and ninth frequencies take 3e-6.
#[test]
fn the_whole_beam_rests_and_vibrates_as_by_the_reference() {
    let Some(data) = data("the_whole_beam_rests_and_vibrates_as_by_the_reference") else { return };
    let reference = Reference::read(&data);
    let folder = tempfile::tempdir().unwrap();
    for file in ["brake_reuss.inp.gz", "cells.csv", "loads.csv"] {
        fs::copy(data.join(file), folder.path().join(file)).unwrap();
    }
    let mut deck = String::new();
    let packed = fs::File::open(data.join("brake_reuss.inp.gz")).unwrap();
    flate2::read::GzDecoder::new(packed).read_to_string(&mut deck).unwrap();
    let traces = Bricks::read(&deck).write(folder.path(), "beam");
    let expected = [65_024_302_377_353.06, 10.135_897_310_776_745];
    assert!(largest_off(&traces, &expected) < 1e-10, "{traces:?}");
    for (law, expected) in [(LINEAR, &reference.linear), (POWER, &reference.power)] {
        let off = largest_off(&elastic(WHOLE, law, folder.path()), expected);
        assert!(off < 5e-6, "{law}: {off}");
    }
    let document =
        Document::parse(&WHOLE.replace("LAW", POWER), folder.path().join("beam.json")).unwrap();
    let assembly =
        assemble_patches(&document.structure_scenario().unwrap(), document.folder()).unwrap();
    let contacts = assembly.structure.structure.contacts();
    let found: Vec<f64> = contacts.iter().map(PreloadedContact::pressure).collect();
    let off = largest_off(&found, &reference.pressures);
    assert!(off < 1e-6, "{off}");
}
