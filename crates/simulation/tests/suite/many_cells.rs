//! Steady responses of a structure of matrices with more than a hundred cells, against time integration.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use asperity_scenario::Document;
use asperity_simulation::patches::{assemble_patches, steady_cells};
use asperity_simulation::steady::{BodyModel, SteadyRequest, steady};

/// Nodes along a side of a lattice, and cells: one under each node.
const SIDE: usize = 12;

/// Files of a square lattice of masses that move along z, with springs between neighbours, and two patches under it: of
/// every third node, and of the others.
fn write_lattice(folder: &Path) {
    let (mut stiffness, mut mass, mut rows) = (String::new(), String::new(), String::new());
    let (mut patches, mut loads) = ([String::new(), String::new()], String::new());
    for patch in &mut patches {
        patch.push_str("cell,area_m2,node,direction,weight\n");
    }
    loads.push_str("node,direction,force_n\n");
    for row in 0..SIDE {
        for column in 0..SIDE {
            let node = row * SIDE + column + 1;
            let mut neighbours = 0;
            for (inside, other) in [
                (column > 0, node.wrapping_sub(1)),
                (row > 0, node.wrapping_sub(SIDE)),
                (column + 1 < SIDE, node + 1),
                (row + 1 < SIDE, node + SIDE),
            ] {
                neighbours += usize::from(inside);
                if inside && other < node {
                    writeln!(stiffness, "{other} {node} -2e7").unwrap();
                }
            }
            writeln!(stiffness, "{node} {node} {:e}", 2e7 * neighbours as f64).unwrap();
            writeln!(mass, "{node} {node} 0.02").unwrap();
            writeln!(rows, "{node}.3").unwrap();
            writeln!(patches[usize::from(node.is_multiple_of(3))], "{node},1e-5,{node},3,-1")
                .unwrap();
            writeln!(loads, "{node},3,{:.3}", -1.0 - 0.5 * (0.9 * node as f64).sin()).unwrap();
        }
    }
    for (name, text) in [
        ("plate.sti", &stiffness),
        ("plate.mas", &mass),
        ("plate.dof", &rows),
        ("low.csv", &patches[1]),
        ("high.csv", &patches[0]),
        ("loads.csv", &loads),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
}

const SCENARIO: &str = r#"{"schema": "asperity/scenario/1",
 "bodies": [{"name": "plate", "reduction": {"modes": 30},
             "matrices": {"format": "calculix", "stiffness": "plate.sti", "mass": "plate.mas", "rows": "plate.dof"}}],
 "loads": [{"body": "plate", "file": "loads.csv"}],
 "interfaces": [{"name": "high", "law": "rough", "body": "plate", "cells": "high.csv"},
                {"name": "low", "law": "rough", "body": "plate", "cells": "low.csv", "initial_gap_m": 3.2e-6}],
 "laws": {"rough": {"kind": "power", "coefficient": 2.5e8, "exponent": 0.5}},
 "damping": {"kind": "rayleigh", "rate_per_s": 200, "time_s": 2e-6},
 "excitation": {"kind": "harmonic", "amplitude_n": 1, "frequency_hz": 1000,
                "at": {"body": "plate", "node": 14, "direction": [0, 0, -1]}},
 "sensors": [{"name": "far", "at": {"body": "plate", "node": 130, "direction": [0, 0, 1]}, "kind": "displacement"}],
 "duration_s": 0.01}"#;

/// 144 cells, of which 12 open and 29 of the 36 that are open at rest close in each period, with 10 harmonics: 3024 unknowns.
#[test]
fn a_hundred_cells_vibrate_as_in_time() {
    let folder = tempfile::tempdir().unwrap();
    write_lattice(folder.path());
    let document = Document::parse(SCENARIO, folder.path().join("plate.json")).unwrap();
    let assembly = assemble_patches(&document.structure_scenario().unwrap(), document.folder());
    let assembly = assembly.unwrap();
    let request = SteadyRequest {
        amplitudes: vec![60.0],
        from_hz: 1100.0,
        to_hz: 1200.0,
        harmonics: Some(10),
        backbone: false,
        verify: true,
        bodies: BodyModel::Auto,
        time_sweep: None,
    };
    let found = steady(&assembly, &request).unwrap();
    let level = &found.levels[0];
    let branch = level.outcome.as_ref().unwrap();
    assert!(branch.is_complete());
    assert!(branch.points.iter().all(|point| point.stable() == Some(true)));
    let cells = steady_cells(&assembly.structure, &found).to_csv();
    let cells: Vec<Vec<&str>> = cells.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| cells[0].iter().position(|own| *own == name).unwrap();
    let [rest, most] = ["pressure_at_rest_pa", "pressure_max_pa"].map(column);
    let number = |row: &[&str], column: usize| row[column].parse::<f64>().unwrap();
    assert_eq!(cells.len(), 1 + SIDE * SIDE);
    let closes = |row: &&Vec<&str>| number(row, rest) == 0.0 && number(row, most) > 1e3;
    let closing = cells[1..].iter().filter(closes).count();
    let largest = branch.highest().unwrap();
    let opening = largest.pressures.iter().filter(|range| range.contact_lost).count();
    assert!(closing > 20 && opening > 8, "{closing} {opening}");
    let check = level.check.unwrap();
    assert!(check.settled && check.relative_difference < 1e-5, "{check:?}");
}
