//! Several responses of one test: files, modal table, and another program's modes.

use std::path::Path;
use std::process::Command;

use asperity_measure::{ChannelUnit, Format, Record};
use serde_json::Value;

use super::exact::{mode_under_blows, noisy};
use super::hammer::channel;
use super::store;
use crate::{answer, asperity};

/// Natural frequency \[Hz\], damping ratio, and modal constants at two places \[1/kg\].
const MODES: [(f64, f64, [f64; 2]); 2] = [(400.0, 0.012, [1.0, -0.7]), (730.0, 0.008, [0.6, 0.9])];

/// Six hits of growing force with the accelerations at both places in closed form and 1 % of noise;
/// a temperature that is no response.
fn record() -> Record {
    let peaks = [8.0, 9.0, 10.0, 11.0, 12.0, 13.0];
    let mut force = Vec::new();
    let mut places = [Vec::new(), Vec::new()];
    for (natural, damping, constants) in MODES {
        for (place, constant) in places.iter_mut().zip(constants) {
            let [own, .., acceleration] = mode_under_blows((natural, damping, constant), &peaks);
            place.resize(acceleration.len(), 0.0);
            place.iter_mut().zip(acceleration).for_each(|(sum, a)| *sum += a);
            force = own;
        }
    }
    let constant = vec![20.0; force.len()];
    let [first, second] = places;
    let size = |samples: &[f64]| 0.01 * samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    Record {
        channels: vec![
            channel("top left", "m/s^2", noisy(&first, size(&first), 1)),
            channel("hammer", "N", noisy(&force, size(&force), 2)),
            channel("oven", "K", constant),
            channel("top/right", "m/s^2", noisy(&second, size(&second), 3)),
        ],
        ..Record::default()
    }
}

/// A cell of a table, by its column.
fn cell<'a>(table: &'a str, row: usize, column: &str) -> &'a str {
    let place = table.lines().next().unwrap().split(',').position(|name| name == column).unwrap();
    table.lines().nth(row + 1).unwrap().split(',').nth(place).unwrap()
}

fn number(table: &str, row: usize, column: &str) -> f64 {
    cell(table, row, column).parse().unwrap()
}

/// Verified against the closed form: every frequency, damping ratio and modal constant is within
/// four of its standard deviations, the constant with 3 % for the neighbouring mode; and against the
/// analysis of one response alone, whose tables are the same to the last byte.
#[test]
fn the_modal_table_has_the_exact_modes() {
    let folder = tempfile::tempdir().unwrap();
    let file = store(folder.path(), "test.uff", record(), Format::UniversalBinary);
    let asked = ["analyse", &file, "--response", "all", "--band", "300:850", "--frfs", "uff"];
    let out = asperity(folder.path(), &[&asked[..], &["--out", "all"]].concat());
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let printed = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(printed.contains("\ntop/right:\naverage of 6 of 6 hits"), "{printed}");
    assert!(printed.contains("constant 1/kg"), "{printed}");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let table = read("all/modes.csv");
    assert_eq!(table.lines().count(), 5);
    for (mode, (natural, damping, constants)) in MODES.into_iter().enumerate() {
        for (place, constant) in constants.into_iter().enumerate() {
            let row = 2 * mode + place;
            assert_eq!(number(&table, row, "mode"), mode as f64 + 1.0);
            assert_eq!(cell(&table, row, "response"), ["top left", "top/right"][place]);
            let of = |column: &str| number(&table, row, column);
            let near = |column: &str, sigma: &str, exact: f64, more: f64| {
                let (value, sigma) = (of(column), of(sigma));
                assert!(
                    (value - exact).abs() < 4.0 * sigma + more,
                    "{column} {value} {exact} {sigma}"
                );
                // And the deviation is of some use.
                assert!(sigma < 0.05 * exact.abs() && sigma > 0.0, "{column} {sigma}");
            };
            near("natural_frequency_hz", "natural_frequency_uncertainty_hz", natural, 0.0);
            near("damping_ratio", "damping_ratio_uncertainty", damping, 0.0);
            let size = of("modal_constant_real_per_kg").hypot(of("modal_constant_imag_per_kg"));
            let sigma = of("modal_constant_uncertainty_per_kg");
            let off = (size - constant.abs()).abs();
            assert!(off < 4.0 * sigma + 0.03 * constant.abs(), "{size} {constant} {sigma}");
            assert_eq!(of("modal_constant_real_per_kg") < 0.0, constant < 0.0);
        }
    }
    let report: Value = serde_json::from_str(&read("all/analysis.json")).unwrap();
    assert_eq!(report["other_responses"], serde_json::json!(["top/right"]));
    assert_eq!(report["modes"].as_array().unwrap().len(), 2);

    let alone = ["analyse", &file, "--response", "top/right", "--band", "300:850", "--out", "one"];
    answer(folder.path(), &[&alone[..], &["--json"]].concat());
    for name in ["hits", "frf", "backbone"] {
        let of_all = read(&format!("all/{name}_top-right.csv"));
        assert_eq!(of_all, read(&format!("one/{name}.csv")), "{name}");
    }
    for name in ["responses.svg", "report_top-right.html", "analysis_top-right.json", "frfs.uff"] {
        assert!(folder.path().join("all").join(name).is_file(), "{name}");
    }
    other_modes(&folder.path().join("all/frfs.uff"), &table);
}

/// Poles of the averaged functions of both responses by pyEMA.
const SCRIPT: &str = "
import json, sys
import numpy as np
try:
    import pyuff
    from pyEMA import Model
except ImportError:
    print(json.dumps(None)); sys.exit()
sets = [s for s in pyuff.UFF(sys.argv[1]).read_sets() if s['type'] == 58]
mean = [s for s in sets if 'average' in s['id1']]
model = Model(np.array([s['data'] for s in mean]), mean[0]['x'], lower=250, upper=900,
              pol_order_high=30, frf_form='receptance')
model.get_poles(show_progress=False)
model.select_closest_poles([400.0, 730.0])
print(json.dumps({'nodes': [int(s['rsp_node']) for s in mean],
                  'modes': [[float(f), float(x)] for f, x in zip(model.nat_freq, model.nat_xi)]}))
";

/// Verified against pyEMA's least-squares complex frequency estimate of the poles of both responses,
/// within four standard deviations of the table. Skipped where it is not installed.
fn other_modes(functions: &Path, table: &str) {
    let skip = |reason: &str| eprintln!("skipped the comparison with pyEMA: {reason}");
    let output = Command::new("python3").args(["-c", SCRIPT]).arg(functions).output();
    let Ok(output) = output else { return skip("no python3") };
    let text = String::from_utf8_lossy(&output.stdout);
    let Ok(found) = serde_json::from_str::<Value>(text.lines().last().unwrap_or_default()) else {
        return skip(&format!("python3 failed: {}", String::from_utf8_lossy(&output.stderr)));
    };
    if found.is_null() {
        return skip("no pyuff or pyEMA");
    }
    assert_eq!(found["nodes"], serde_json::json!([1, 2]));
    for mode in 0..2 {
        let row = 2 * mode;
        let [frequency, damping] = [0, 1].map(|at| found["modes"][mode][at].as_f64().unwrap());
        let of = |column: &str| number(table, row, column);
        let off = (frequency - of("natural_frequency_hz")).abs();
        assert!(off < 4.0 * of("natural_frequency_uncertainty_hz"), "{frequency} {off}");
        let off = (damping - of("damping_ratio")).abs();
        assert!(off < 4.0 * of("damping_ratio_uncertainty"), "{damping} {off}");
    }
}

/// A response taken for the force rings, and the message asks about it, with its name, once.
#[test]
fn a_force_that_rings_is_asked_about() {
    let folder = tempfile::tempdir().unwrap();
    let mut record = record();
    for (channel, unit) in record.channels.iter_mut().zip(["N", "m/s^2", "K", "m/s^2"]) {
        channel.unit = ChannelUnit::of_text(unit);
    }
    let file = store(folder.path(), "test.uff", record, Format::UniversalBinary);
    let asked = ["analyse", &file, "--response", "top/right", "--out", "a"];
    let failed = asperity(folder.path(), &asked);
    assert_eq!(failed.status.code(), Some(1));
    let message = String::from_utf8_lossy(&failed.stderr);
    assert!(message.contains("`top left` rings for 0."), "{message}");
    assert!(message.contains("s after the blow: is it a force?"), "{message}");
    assert!(message.contains("--force CHANNEL"), "{message}");
    assert!(message.len() < 400, "{message}");

    let all = answer(folder.path(), &[&asked[..], &["--keep-all", "--json"]].concat());
    let verdicts = all["hits"][0]["verdicts"].as_array().unwrap();
    let rings = |text: &&Value| text.as_str().unwrap().starts_with("the force rings for 0.");
    assert_eq!(verdicts.iter().filter(rings).count(), 1, "{verdicts:?}");
    let notices = all["notices"].as_array().unwrap();
    assert!(notices.iter().any(|one| one.as_str().unwrap().ends_with("is it a force?")));
}

/// The history of a simulation is read at its acceleration, and has the features of its summary.
#[test]
fn the_history_of_a_simulation_is_analysed() {
    let folder = tempfile::tempdir().unwrap();
    let rig =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/nouira2020-modified.json");
    let run = asperity(folder.path(), &["simulate", rig, "--set", "/method=modal", "--out", "run"]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let asked = ["analyse", "run/history.csv", "--band", "700:1000", "--out", "analysed"];
    let found = asperity(folder.path(), &asked);
    assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    let read = |name: &str| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(folder.path().join(name)).unwrap()).unwrap()
    };
    let (summary, analysis) = (read("run/summary.json"), read("analysed/analysis.json"));
    assert_eq!(analysis["channels"][1]["name"], "acceleration", "{analysis:#}");
    let of_summary = summary["fundamental"]["frequency_hz"].as_f64().unwrap();
    let of_hit = analysis["hits"][0]["fundamental"]["frequency_hz"].as_f64().unwrap();
    assert!((of_hit / of_summary - 1.0).abs() < 1e-3, "{of_hit} {of_summary}");
}
