//! Motion on meshes at instants of a response, and cells over time, against the sensors and the closures of the run.

use std::fs;
use std::path::Path;

use asperity_scenario::Document;
use asperity_simulation::patches::{MeshMotion, PatchRun, simulate_patches, time_series};

use crate::structures::{STIFFNESS, scenario, write_chains};

const INSTANTS: [f64; 4] = [0.0, 1e-3, 2.04e-3, 4e-3];

/// Two chains of four masses, of which two modes are kept, joined by a spring with a damper, on one contact.
fn chains(folder: &Path, output: &str) -> String {
    write_chains(folder, [4, 4]);
    let deck = "*NODE\n1,0.0,0,0\n2,0.1,0,0\n3,0.2,0,0\n4,0.3,0,0\n";
    fs::write(folder.join("chain.inp"), deck).unwrap();
    let more = format!(
        r#", "springs": [{{"from": {{"body": "a", "node": 4, "direction": [1, 0, 0]}},
            "to": {{"body": "b", "node": 1, "direction": [1, 0, 0]}},
            "stiffness_n_per_m": {STIFFNESS:e}, "damping_n_s_per_m": 30}}], "output": {output}"#
    );
    let sensors: Vec<String> = [("a", 1), ("a", 3), ("b", 1), ("b", 4)]
        .iter()
        .map(|(body, node)| {
            format!(r#"{{"name": "{body}{node}", "at": {{"body": "{body}", "node": {node}, "direction": [1, 0, 0]}}, "kind": "displacement"}}"#)
        })
        .collect();
    let mut text = scenario(&["a", "b"], "first.csv", &more);
    for body in ["a", "b"] {
        text = text.replace(
            &format!(r#"{{"name": "{body}","#),
            &format!(r#"{{"name": "{body}", "mesh": "chain.inp", "reduction": {{"modes": 2}},"#),
        );
    }
    text.replace(r#""sensors": ["#, &format!(r#""sensors": [{},"#, sensors.join(",")))
}

fn run(text: &str, folder: &Path) -> Result<PatchRun, String> {
    let document = Document::parse(text, folder.join("chain.json")).unwrap();
    let scenario = document.structure_scenario().unwrap();
    simulate_patches(&document, &scenario, &|_| ()).map_err(|error| error.to_string())
}

/// At each instant the mesh moves at the sensors as these read, modes left out included, with their retardation and without;
/// the closure of the cell over time is the displacement of its node.
#[test]
fn meshes_move_as_sensors_and_cells_read() {
    let folder = tempfile::tempdir().unwrap();
    let output = format!(r#"{{"instants_s": {INSTANTS:?}, "cells": {{"foot": ["0"]}}}}"#);
    let text = chains(folder.path(), &output);
    let rayleigh = text.replace("mass_proportional", "rayleigh");
    let rayleigh = rayleigh.replace(r#""rate_per_s": 0"#, r#""rate_per_s": 0, "time_s": 2e-5"#);
    for text in [text, rayleigh] {
        let found = run(&text, folder.path()).unwrap();
        let document = Document::parse(&text, folder.path().join("chain.json")).unwrap();
        let scenario = document.structure_scenario().unwrap();
        let motions = found.mesh_motions(&scenario, folder.path()).unwrap();
        let bodies: Vec<&str> = motions.iter().map(MeshMotion::body).collect();
        assert_eq!(bodies, ["a", "b"]);
        let history = &found.run.transient.history;
        let sensors = found.run.assembly.sensors.iter().zip(&history.sensors);
        let read: Vec<(&str, &[f64])> = sensors
            .map(|(sensor, read)| (sensor.name.as_deref().unwrap(), &read.displacement[..]))
            .collect();
        let most = read[1].1.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let closures = &found.cell_histories[0].history.closure;
        for (number, time) in INSTANTS.into_iter().enumerate() {
            let sample = (time * found.run.assembly.sampling.rate()).round() as usize;
            for motion in &motions {
                let (at, displacements) = motion.instants().nth(number).unwrap();
                assert_eq!(at, history.time[sample]);
                for (name, displacement) in &read[..4] {
                    let Some(node) = name.strip_prefix(motion.body()) else { continue };
                    let place = motion.nodes().position(|one| one == node.parse::<i64>().unwrap());
                    let moved = displacements[place.unwrap()];
                    let off = (moved[0] - displacement[sample]).abs();
                    assert!(off < 1e-7 * most, "{name} at {time}: {off:e} of {most:e}");
                    assert_eq!(moved[1..], [0.0, 0.0]);
                }
            }
            let closed = closures[sample] - closures[0];
            assert!((closed - read[0].1[sample]).abs() < 1e-9 * most, "{closed:e}");
            // A constant law: pressures of the map are those of the cell.
            let pressure = found.cell_histories[0].history.pressure[sample];
            assert_eq!(found.states[number].pressures[0], pressure);
        }
        assert!(
            read[1].1[(4e-3 * found.run.assembly.sampling.rate()) as usize].abs() > 1e-2 * most
        );
        assert_eq!(motions[0].grids().count(), INSTANTS.len());
        let grids = found.cell_grids(&scenario, folder.path()).unwrap();
        assert_eq!(grids.len(), INSTANTS.len());
        let lines: Vec<&str> = grids[2].lines().collect();
        let value = lines.iter().position(|line| line.contains("Name=\"pressure_pa\"")).unwrap();
        assert_eq!(lines[value + 1].parse(), Ok(found.states[2].pressures[0]));
        // Dataset 55 of a transient analysis with the number of the step and its time.
        let text = motions[1].universal_file();
        let sets: Vec<&str> =
            text.split("    -1\n").filter(|set| set.starts_with("    55")).collect();
        assert_eq!(sets.len(), INSTANTS.len());
        let lines: Vec<&str> = sets[1].lines().collect();
        assert_eq!(lines[6], [1, 4, 2, 8, 2, 3].map(|code| format!("{code:>10}")).concat());
        assert_eq!(lines[7], [2, 1, 1, 2].map(|code| format!("{code:>10}")).concat());
        assert_eq!(lines[8].trim(), "1.00000E-03");
        let number: f64 = lines[10][..13].trim().parse().unwrap();
        let sensor = read[2].1[(1e-3 * found.run.assembly.sampling.rate()).round() as usize];
        assert!((number / sensor - 1.0).abs() < 1e-4, "{number:e} {sensor:e}");
    }
}

/// Without a choice there are six instants in the first period and, of a single cell, no history; an empty choice has none.
#[test]
fn instants_divide_the_first_period() {
    let folder = tempfile::tempdir().unwrap();
    let found = run(&chains(folder.path(), "{}"), folder.path()).unwrap();
    let frequency = found.run.summary.at_rest.natural_frequency_hz.unwrap();
    let interval = found.run.assembly.sampling.interval();
    let times: Vec<f64> = found.states.iter().map(|state| state.time).collect();
    assert_eq!(times.len(), 6);
    for (k, time) in (1..).zip(times) {
        assert!((time - f64::from(k) / (6.0 * frequency)).abs() <= 0.51 * interval);
    }
    assert!(found.cell_histories.is_empty() && found.cell_history_csv().is_none());
    let none = run(&chains(folder.path(), r#"{"instants_s": []}"#), folder.path()).unwrap();
    assert!(none.states.is_empty());
}

/// Instants and cells that do not exist are refused with their place and what there is.
#[test]
fn unknown_cells_and_late_instants_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (output, expected) in [
        (r#"{"instants_s": [1e-3, 7.0]}"#, ["/output/instants_s/1", "7 s", "the last sample"]),
        (r#"{"cells": {"lap": ["0"]}}"#, ["/output/cells/lap", "no interface \"lap\"", "foot"]),
        (
            r#"{"cells": {"foot": ["0", "9"]}}"#,
            ["/output/cells/foot/1", "no cell \"9\"", "1 cells"],
        ),
    ] {
        let error = run(&chains(folder.path(), output), folder.path()).unwrap_err();
        for part in expected {
            assert!(error.contains(part), "{error}");
        }
    }
}

/// A time series lists the files of each instant as parts.
#[test]
fn a_time_series_names_its_files() {
    let file = |name: &str| vec![format!("{name}-1.vtu"), format!("{name}-2.vtu")];
    let text = time_series(&[(0.5, file("a")), (0.75, file("b"))]);
    assert_eq!(text.matches("<DataSet").count(), 4);
    assert!(text.contains(r#"<DataSet timestep="7.5e-1" group="" part="1" file="b-2.vtu"/>"#));
}
