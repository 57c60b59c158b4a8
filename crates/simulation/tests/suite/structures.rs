//! Springs, dampers, held displacements and reduced models in structures of matrices: closed forms, and a second
//! integrator.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use asperity_scenario::Document;
use asperity_signal::Complex64;
use asperity_simulation::patches::{
    assemble_patches, mesh_modes, patch_grid, patch_maps, patch_modes, simulate_patches,
};
use asperity_simulation::record::frf_columns;
use asperity_simulation::row_simulator::RowSimulator;
use asperity_simulation::steady::{BodyModel, SteadyRequest, steady, steady_table};

/// Mass \[kg\] and stiffness \[N/m\] of a chain.
const MASS: f64 = 0.5;
pub(crate) const STIFFNESS: f64 = 2e6;

/// Files of free chains `a`, `b` of masses along x, with springs between neighbours, and a cell under node 1 of `a`.
pub(crate) fn write_chains(folder: &Path, counts: [usize; 2]) {
    for (name, count) in ["a", "b"].into_iter().zip(counts) {
        let (mut stiffness, mut mass, mut rows) = (String::new(), String::new(), String::new());
        for node in 1..=count {
            let ends = usize::from(node > 1) + usize::from(node < count);
            writeln!(stiffness, "{node} {node} {:e}", STIFFNESS * ends as f64).unwrap();
            if node > 1 {
                writeln!(stiffness, "{} {node} {:e}", node - 1, -STIFFNESS).unwrap();
            }
            writeln!(mass, "{node} {node} {MASS:e}").unwrap();
            writeln!(rows, "{node}.1").unwrap();
        }
        fs::write(folder.join(format!("{name}.sti")), stiffness).unwrap();
        fs::write(folder.join(format!("{name}.mas")), mass).unwrap();
        fs::write(folder.join(format!("{name}.dof")), rows).unwrap();
    }
    let cells = "cell,area_m2,node,direction,weight\n0,1e-4,1,1,1\n";
    fs::write(folder.join("first.csv"), cells).unwrap();
    fs::write(folder.join("third.csv"), cells.replace("4,1,1", "4,3,1")).unwrap();
}

/// A chain on a contact of constant stiffness under its first node; `more` adds keys.
pub(crate) fn scenario(bodies: &[&str], cells: &str, more: &str) -> String {
    let body = |name: &&str| {
        format!(
            r#"{{"name": "{name}", "matrices": {{"format": "calculix", "stiffness": "{name}.sti", "mass": "{name}.mas", "rows": "{name}.dof"}}}}"#
        )
    };
    let bodies: Vec<String> = bodies.iter().map(body).collect();
    let (law, bodies) = (STIFFNESS / 1e-4, bodies.join(","));
    format!(
        r#"{{"schema": "asperity/scenario/1", "bodies": [{bodies}],
             "interfaces": [{{"name": "foot", "law": {{"kind": "constant", "stiffness_pa_per_m": {law:e}}}, "body": "a", "cells": "{cells}"}}],
             "damping": {{"kind": "mass_proportional", "rate_per_s": 0}},
             "excitation": {{"kind": "haversine", "peak_n": 10, "duration_s": 2e-3, "at": {{"body": "a", "node": 2, "direction": [1, 0, 0]}}}},
             "sensors": [{{"name": "two", "at": {{"body": "a", "node": 2, "direction": [1, 0, 0]}}, "kind": "displacement"}}],
             "duration_s": 0.03 {more}}}"#
    )
}

fn frequencies_and_ratios(text: &str, folder: &Path) -> Vec<[f64; 2]> {
    let document = Document::parse(text, folder.join("chain.json")).unwrap();
    let scenario = document.structure_scenario().unwrap();
    let assembly = assemble_patches(&scenario, document.folder()).unwrap();
    let modes = patch_modes(&assembly, 10).unwrap().modes;
    modes.iter().map(|mode| [mode.frequency_hz, mode.damping_ratio]).collect()
}

/// Two chains of two masses joined by a spring are one chain of four, on a spring of the same stiffness:
/// `w_j = 2 sqrt(k / m) sin((2 j - 1) pi / 18)`, shapes `sin((2 j - 1) i pi / 9)`. A damper on the spring between the
/// second and the third mass has the loss of their relative motion.
#[test]
fn bodies_joined_by_a_damped_spring_are_one_chain() {
    let folder = tempfile::tempdir().unwrap();
    write_chains(folder.path(), [2, 2]);
    let damper = 3.0;
    let spring = format!(
        r#", "springs": [{{"from": {{"body": "a", "node": 2, "direction": [1, 0, 0]}},
            "to": {{"body": "b", "node": 1, "direction": [2, 0, 0]}},
            "stiffness_n_per_m": {STIFFNESS:e}, "damping_n_s_per_m": {damper}}}]"#
    );
    let text = scenario(&["a", "b"], "first.csv", &spring);
    let found = frequencies_and_ratios(&text, folder.path());
    assert_eq!(found.len(), 4);
    for (j, [frequency, ratio]) in found.into_iter().enumerate() {
        let odd = (2 * j + 1) as f64;
        let w = 2.0 * (STIFFNESS / MASS).sqrt() * (odd * PI / 18.0).sin();
        assert!((TAU * frequency / w - 1.0).abs() < 1e-9, "{frequency} {}", w / TAU);
        let shape = [1, 2, 3, 4].map(|i| (odd * f64::from(i) * PI / 9.0).sin());
        let modal_mass = MASS * shape.iter().map(|x| x * x).sum::<f64>();
        let expected = damper * (shape[2] - shape[1]).powi(2) / modal_mass / (2.0 * w);
        assert!((ratio - expected).abs() < 1e-9 * expected + 1e-15, "{ratio} {expected}");
    }
}

/// Mode shapes on a mesh, from the reduction just made and from the kept one: a chain of four on a spring, whose shapes are
/// `sin((2 j - 1) i pi / 9)` with a modal mass of 1. The map of the cell lies at its node.
#[test]
fn shapes_on_a_mesh_are_those_of_the_chain() {
    let folder = tempfile::tempdir().unwrap();
    write_chains(folder.path(), [4, 2]);
    let deck = "*NODE\n1,0.0,0,0\n2,0.1,0,0\n3,0.2,0,0\n4,0.3,0,0\n5,9,9,9\n";
    fs::write(folder.path().join("chain.inp"), deck).unwrap();
    let text = scenario(&["a"], "first.csv", "")
        .replace(r#"{"name": "a","#, r#"{"name": "a", "mesh": "chain.inp","#);
    let document = Document::parse(&text, folder.path().join("chain.json")).unwrap();
    let scenario = document.structure_scenario().unwrap();
    let shapes = || {
        let all = fs::read_dir(folder.path().join(".asperity-reductions"));
        all.map_or(0, |all| all.flatten().filter(|file| file.path().extension().is_some()).count())
    };
    let by_another_path = document.folder().join("..").join(folder.path().file_name().unwrap());
    for (kept, path) in [(0, document.folder()), (1, document.folder()), (1, &by_another_path)] {
        assert_eq!(shapes(), kept);
        let assembly = assemble_patches(&scenario, path).unwrap();
        let found = patch_modes(&assembly, 4).unwrap();
        let meshes = mesh_modes(&scenario, &assembly.structure, &found, path).unwrap();
        let text = meshes[0].universal_file();
        assert!(text.lines().all(|line| line.len() <= 80));
        let sets: Vec<Vec<&str>> = text
            .split("    -1\n")
            .map(|set| set.lines().collect())
            .filter(|set: &Vec<&str>| !set.is_empty())
            .collect();
        let numbers: Vec<&str> = sets.iter().map(|set| set[0].trim()).collect();
        // The chain has no elements, so no lines along edges.
        assert_eq!(numbers, ["164", "2411", "55", "55", "55", "55", "55"]);
        assert_eq!(
            sets[2][6..8].join(""),
            [1, 1, 2, 8, 2, 3, 1, 1, 1].map(|code| format!("{code:>10}")).concat()
        );
        assert_eq!(sets[1].len(), 1 + 2 * 5);
        assert_eq!(sets[1][3], "         2         1         1        11");
        assert_eq!(sets[1][4][..25].trim(), "1.0000000000000001E-01");
        for (j, set) in sets[3..].iter().enumerate() {
            let number = |line: usize, field: usize| -> f64 {
                set[line][13 * field..13 * (field + 1)].trim().parse().unwrap()
            };
            let odd = (2 * j + 1) as f64;
            let w = 2.0 * (STIFFNESS / MASS).sqrt() * (odd * PI / 18.0).sin();
            assert!((TAU * number(8, 0) / w - 1.0).abs() < 1e-5);
            assert_eq!(number(8, 1), 1.0);
            let shape = [1, 2, 3, 4].map(|i| (odd * f64::from(i) * PI / 9.0).sin());
            let size = (MASS * shape.iter().map(|x| x * x).sum::<f64>()).sqrt();
            let sign = number(10, 0).signum() * shape[0].signum();
            for (i, x) in shape.iter().enumerate() {
                assert!((number(10 + 2 * i, 0) - sign * x / size).abs() < 2e-5, "{j} {i}");
                assert_eq!(number(10 + 2 * i, 2), 0.0);
            }
            // The fifth node has no rows.
            assert_eq!((number(18, 0), set.len()), (0.0, 19));
        }
        assert!(meshes[0].grid().contains("Name=\"mode 4: "));
        let maps = patch_maps(&scenario, &assembly.structure, path).unwrap();
        assert_eq!(maps[0].cells[0].polygons, [vec![[0.0; 3]]]);
        assert!(patch_grid(&maps).unwrap().contains("Name=\"pressure_pa\""));
    }
    assert_eq!(shapes(), 1);
}

/// Displacements at rest of a chain of four between a contact and a spring on the ground, under gravity and a force, with two
/// modes kept: those of its stiffness matrix at every node and at a sensor, and the pressure of the contact. The
/// weight of a free body of equal masses acts on its rigid motion alone: its flexibility is zero, not rounding.
#[test]
fn displacements_at_rest_are_those_of_the_springs() {
    let folder = tempfile::tempdir().unwrap();
    write_chains(folder.path(), [4, 2]);
    let deck = "*NODE\n1,0.0,0,0\n2,0.1,0,0\n3,0.2,0,0\n4,0.3,0,0\n";
    fs::write(folder.path().join("chain.inp"), deck).unwrap();
    let more = format!(
        r#", "gravity_m_per_s2": [9.81, 0, 0], "loads": [{{"body": "a", "node": 3, "direction": [1, 0, 0], "force_n": 40}}],
            "springs": [{{"from": {{"body": "a", "node": 4, "direction": [1, 0, 0]}}, "stiffness_n_per_m": {STIFFNESS:e}}}]"#
    );
    let text = scenario(&["a"], "first.csv", &more).replace(
        r#"{"name": "a","#,
        r#"{"name": "a", "mesh": "chain.inp", "reduction": {"modes": 2},"#,
    );
    let rayleigh = text.replace("mass_proportional", "rayleigh");
    let rayleigh = rayleigh.replace(r#""rate_per_s": 0"#, r#""rate_per_s": 0, "time_s": 1e-6"#);
    let weight = MASS * 9.81;
    let loads = [weight, weight, weight + 40.0, weight].map(|force| force / STIFFNESS);
    // Between walls, the flexibility of springs of 1 N/m is min(i, j) (5 - max(i, j)) / 5.
    let exact = |i: usize| -> f64 {
        let share = |j: usize| (i.min(j) * (5 - i.max(j))) as f64 / 5.0;
        (1..).zip(loads).map(|(j, load)| share(j) * load).sum()
    };
    for text in [text, rayleigh] {
        let document = Document::parse(&text, folder.path().join("chain.json")).unwrap();
        let scenario = document.structure_scenario().unwrap();
        // The second time from what was kept.
        for _ in 0..2 {
            let assembly = assemble_patches(&scenario, document.folder()).unwrap();
            let found = patch_modes(&assembly, 2).unwrap();
            let structure = &assembly.structure;
            let meshes = mesh_modes(&scenario, structure, &found, document.folder()).unwrap();
            for node in 1..=4 {
                let at_rest = meshes[0].at_rest(node).unwrap();
                let exact = exact(node as usize);
                assert!((at_rest[0] / exact - 1.0).abs() < 1e-6, "{node}: {at_rest:?} {exact:e}");
                assert_eq!(at_rest[1..], [0.0, 0.0]);
            }
            let force = 1e-4 * structure.structure.contacts()[0].pressure();
            assert!((force / (STIFFNESS * exact(1)) - 1.0).abs() < 1e-9, "{force}");
            assert!((structure.static_displacements[0] / exact(2) - 1.0).abs() < 1e-9);
            assert!(meshes[0].grid().contains("Name=\"displacement at rest\""));
        }
        let run = simulate_patches(&document, &scenario, &|_| ()).unwrap().summary();
        let sensor = &run.static_displacements[0];
        assert_eq!(sensor.sensor, "two");
        assert!((sensor.displacement_m / exact(2) - 1.0).abs() < 1e-9);
    }
}

/// The motion of a chain with a strong damper to the ground, by fourth-order steps of its equations.
#[test]
fn a_damper_acts_in_time_as_by_another_integrator() {
    let folder = tempfile::tempdir().unwrap();
    write_chains(folder.path(), [2, 2]);
    let (spring, damper) = (5e5, 400.0);
    let more = format!(
        r#", "accuracy": 1e-4, "springs": [{{"from": {{"body": "a", "node": 2, "direction": [1, 0, 0]}},
            "stiffness_n_per_m": {spring:e}, "damping_n_s_per_m": {damper}}}]"#
    );
    let text = scenario(&["a"], "first.csv", &more);
    let document = Document::parse(&text, folder.path().join("chain.json")).unwrap();
    let run =
        simulate_patches(&document, &document.structure_scenario().unwrap(), &|_| ()).unwrap().run;
    let history = &run.transient.history;
    let accelerations = |t: f64, [x1, x2, _, v2]: [f64; 4]| {
        let force = if t < 2e-3 { 10.0 * (PI * t / 2e-3).sin().powi(2) } else { 0.0 };
        let between = STIFFNESS * (x2 - x1);
        let first = between - STIFFNESS * x1;
        let second = force - between - spring * x2 - damper * v2;
        [first / MASS, second / MASS]
    };
    let rate = |t: f64, y: [f64; 4]| {
        let [a, b] = accelerations(t, y);
        [y[2], y[3], a, b]
    };
    let ahead = |y: [f64; 4], k: [f64; 4], h: f64| [0, 1, 2, 3].map(|i| y[i] + h * k[i]);
    let interval = history.time[1] - history.time[0];
    let parts = (interval / 1e-6).ceil() as usize;
    let h = interval / parts as f64;
    let (mut y, mut most, mut off) = ([0.0_f64; 4], 0.0_f64, 0.0_f64);
    for (sample, found) in history.sensors[0].displacement.iter().enumerate() {
        most = most.max(y[1].abs());
        off = off.max((found - y[1]).abs());
        for part in 0..parts {
            let t = history.time[sample] + part as f64 * h;
            let a = rate(t, y);
            let b = rate(t + 0.5 * h, ahead(y, a, 0.5 * h));
            let c = rate(t + 0.5 * h, ahead(y, b, 0.5 * h));
            let d = rate(t + h, ahead(y, c, h));
            y = [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
    }
    assert!(most > 1e-6 && off < 2e-4 * most, "{most:e} {off:e}");
    let energy = &run.transient.energy;
    assert!(energy.dissipated > 0.9 * energy.input, "{energy:?}");
    assert!(energy.residual_relative() < 1e-3, "{energy:?}");
}

/// A chain of three whose first mass is held, on a contact under the third: `w^2 = k / m` and `3 k / m`. Under gravity
/// each mass moves by `m g / k`, and the contact carries one weight.
#[test]
fn held_displacements_are_no_motions() {
    let folder = tempfile::tempdir().unwrap();
    write_chains(folder.path(), [3, 2]);
    let more = r#", "gravity_m_per_s2": [9.81, 0, 0], "held": [{"body": "a", "node": 1, "direction": [-1, 0, 0]}]"#;
    let text = scenario(&["a"], "third.csv", more);
    let found = frequencies_and_ratios(&text, folder.path());
    assert_eq!(found.len(), 2);
    for ([frequency, _], square) in found.iter().zip([1.0, 3.0]) {
        let w = (square * STIFFNESS / MASS).sqrt();
        assert!((TAU * frequency / w - 1.0).abs() < 1e-9, "{frequency} {}", w / TAU);
    }
    let document = Document::parse(&text, folder.path().join("chain.json")).unwrap();
    let scenario = document.structure_scenario().unwrap();
    let structure = assemble_patches(&scenario, document.folder()).unwrap().structure;
    let force = 1e-4 * structure.structure.contacts()[0].pressure();
    assert!((force / (MASS * 9.81) - 1.0).abs() < 1e-9, "{force}");

    let cases = [
        ("/held/0/node", "9", "no row of node 9 direction 1"),
        (
            "/held/0/direction",
            "[1, 1, 0]",
            "/held/0/direction: the direction is not along x, y or z",
        ),
        (
            "/held/0",
            r#"{"body": "a", "set": "FOOT", "direction": [1, 0, 0]}"#,
            "/held/0/set: body \"a\" has no mesh",
        ),
        ("/held/0/body", "c", "/held/0/body: no body is named \"c\""),
        ("/excitation/at/node", "1", "/excitation/at: node 1 of body \"a\" is held there"),
    ];
    for (pointer, value, expected) in cases {
        let mut document = document.clone();
        document.set(pointer, value).unwrap();
        let scenario = document.structure_scenario().unwrap();
        let error =
            assemble_patches(&scenario, document.folder()).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// A MATLAB 5 file of full real matrices, by rows.
fn mat_file(arrays: &[(&str, &[&[f64]])]) -> Vec<u8> {
    let mut bytes = format!("{:<124}", "MATLAB 5.0 MAT-file").into_bytes();
    bytes.extend([0x00, 0x01, b'I', b'M']);
    for (name, rows) in arrays {
        let (count, columns) = (rows.len(), rows[0].len());
        let mut body: Vec<u8> = Vec::new();
        let mut element = |kind: u32, data: &[u8]| {
            body.extend(kind.to_le_bytes());
            body.extend((data.len() as u32).to_le_bytes());
            body.extend(data);
            body.resize(body.len().next_multiple_of(8), 0);
        };
        element(6, &[6, 0, 0, 0, 0, 0, 0, 0]);
        let sizes: Vec<u8> =
            [count, columns].iter().flat_map(|n| (*n as u32).to_le_bytes()).collect();
        element(5, &sizes);
        element(1, name.as_bytes());
        let values = (0..columns).flat_map(|column| rows.iter().map(move |row| row[column]));
        let values: Vec<u8> = values.flat_map(f64::to_le_bytes).collect();
        element(9, &values);
        bytes.extend(14_u32.to_le_bytes());
        bytes.extend((body.len() as u32).to_le_bytes());
        bytes.extend(body);
    }
    bytes
}

/// A reduced model whose coordinates are mixed displacements is the chain that it was made of.
#[test]
fn a_reduced_model_is_the_structure_that_it_was_made_of() {
    let folder = tempfile::tempdir().unwrap();
    write_chains(folder.path(), [2, 2]);
    // x = T q of a free chain of two masses: x1 = q1, x2 = q1 + q2.
    let (m, k) = (MASS, STIFFNESS);
    let arrays: &[(&str, &[&[f64]])] = &[
        ("K", &[&[0.0, 0.0], &[0.0, k]]),
        ("M", &[&[2.0 * m, m], &[m, m]]),
        ("W", &[&[1.0, 0.0]]),
        ("area", &[&[1e-4]]),
        ("f", &[&[4.0], &[1.5]]),
        ("R", &[&[1.0, 0.0], &[1.0, 1.0]]),
    ];
    fs::write(folder.path().join("a.mat"), mat_file(arrays)).unwrap();
    fs::write(folder.path().join("loads.csv"), "node,direction,force_n\n1,1,5\n2,1,3\n").unwrap();
    let power = |text: String| {
        let constant =
            format!(r#"{{"kind": "constant", "stiffness_pa_per_m": {:e}}}"#, STIFFNESS / 1e-4);
        text.replace(&constant, r#"{"kind": "power", "coefficient": 1e8, "exponent": 0.5}"#)
    };
    let full = scenario(&["a"], "first.csv", r#", "loads": [{"body": "a", "file": "loads.csv"}]"#);
    let full = power(full);
    let reduced = power(scenario(
        &["a"],
        "first.csv",
        r#", "loads": [{"body": "a", "array": "f", "factor": 2}]"#,
    ))
    .replace(
        r#"{"format": "calculix", "stiffness": "a.sti", "mass": "a.mas", "rows": "a.dof"}"#,
        r#"{"format": "reduced", "stiffness": "a.mat"}"#,
    )
    .replace(r#""cells": "first.csv""#, r#""array": "W""#)
    .replace(r#""node": 2, "direction": [1, 0, 0]"#, r#""response": 1"#);
    let run = |text: &str| {
        let document = Document::parse(text, folder.path().join("chain.json")).unwrap();
        simulate_patches(&document, &document.structure_scenario().unwrap(), &|_| ()).unwrap()
    };
    for _ in ["reduced", "kept"] {
        let [one, other] = [run(&full), run(&reduced)];
        let pressure = one.cells[0][0].pressure_pa;
        assert!((pressure / 8e4 - 1.0).abs() < 1e-9, "{pressure}");
        assert!((other.cells[0][0].pressure_pa / pressure - 1.0).abs() < 1e-9);
        let [one, other] =
            [&one, &other].map(|run| &run.run.transient.history.sensors[0].displacement);
        let most = one.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let off = one.iter().zip(other).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
        assert!(most > 1e-7 && off < 1e-7 * most, "{most:e} {off:e}");
    }
    let cases = [
        (
            "/sensors/0/at/response",
            "2",
            "/sensors/0/at/response: the reduced model has no response 2; accepted: 0 to 1",
        ),
        (
            "/sensors/0/at",
            r#"{"body": "a", "node": 1, "direction": [1, 0, 0]}"#,
            "/sensors/0/at: the place is none of this body",
        ),
        (
            "/bodies/0/matrices/rows",
            "a.dof",
            "/bodies/0/matrices/rows: a reduced model is one file in SI",
        ),
        ("/bodies/0/matrices/stiffness", "a.sti", "a.sti"),
    ];
    for (pointer, value, expected) in cases {
        let mut document = Document::parse(&reduced, folder.path().join("chain.json")).unwrap();
        document.set(pointer, value).unwrap();
        let scenario = document.structure_scenario().unwrap();
        let error =
            assemble_patches(&scenario, document.folder()).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// Absolute motion of the masses of a chain over that of its base, by elimination in its complex equations
/// `(K - w^2 M + i w r M) u = -M a`, `1 - w^2 u / a`; `ends` are the springs of both ends to the base.
fn transmitted(count: usize, ends: [f64; 2], rate: f64, frequency: f64) -> Vec<Complex64> {
    let w = TAU * frequency;
    let inertia = MASS * Complex64::new(-w * w, rate * w);
    let diagonal = |i: usize| {
        let below = if i == 0 { ends[0] } else { STIFFNESS };
        let above = if i + 1 == count { ends[1] } else { STIFFNESS };
        inertia + below + above
    };
    // A tridiagonal matrix, eliminated from the first row on.
    let (mut pivots, mut right) = (vec![diagonal(0)], vec![Complex64::from(-MASS)]);
    for i in 1..count {
        let factor = -STIFFNESS / pivots[i - 1];
        pivots.push(diagonal(i) + factor * STIFFNESS);
        right.push(-MASS - factor * right[i - 1]);
    }
    let mut u = vec![Complex64::ZERO; count];
    for i in (0..count).rev() {
        let next = if i + 1 < count { u[i + 1] } else { Complex64::ZERO };
        u[i] = (right[i] + STIFFNESS * next) / pivots[i];
    }
    u.into_iter().map(|u| 1.0 - w * w * u).collect()
}

/// Bars move along their axis.
#[test]
fn the_direction_of_a_base_is_refused_for_bars() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/scenarios/shaken-base.json");
    let mut document = Document::read(path).unwrap();
    assert!(document.scenario().is_ok());
    document.set("/excitation/direction", "[0, 0, 1]").unwrap();
    let found = document.scenario().unwrap_err();
    let pointers: Vec<&str> = found.diagnostics.iter().map(|one| one.pointer.as_str()).collect();
    assert_eq!(pointers, ["/excitation/direction"]);
}

/// A base that moves a chain of four on its contact, two chains of two joined by a spring, and a chain whose last node is
/// held too: the transmissibility of a pulse and of harmonic balance, at a sensor along the motion and one against it.
#[test]
fn a_moving_base_moves_a_chain_as_by_its_equations() {
    let rate = 400.0;
    let spring = format!(
        r#", "springs": [{{"from": {{"body": "a", "node": 2, "direction": [1, 0, 0]}},
            "to": {{"body": "b", "node": 1, "direction": [1, 0, 0]}}, "stiffness_n_per_m": {STIFFNESS:e}}}]"#
    );
    let held = r#", "held": [{"body": "a", "node": 5, "direction": [1, 0, 0]}]"#;
    let cases = [
        ([4, 2], &["a"][..], String::new(), ("a", 4), 0.0),
        ([2, 2], &["a", "b"], spring, ("b", 2), 0.0),
        ([5, 2], &["a"], held.to_owned(), ("a", 4), STIFFNESS),
    ];
    for (counts, bodies, more, (last, node), end) in cases {
        let folder = tempfile::tempdir().unwrap();
        write_chains(folder.path(), counts);
        let text = scenario(bodies, "first.csv", &format!(r#", "accuracy": 1e-4{more}"#));
        let mut document = Document::parse(&text, folder.path().join("chain.json")).unwrap();
        let pulse = r#"{"kind": "base_motion", "direction": [3, 0, 0],
            "acceleration": {"kind": "haversine", "peak_m_per_s2": 2, "duration_s": 1e-3}}"#;
        let against = format!(
            r#"{{"name": "last", "kind": "acceleration", "at": {{"body": "{last}", "node": {node}, "direction": [-1, 0, 0]}}}}"#
        );
        for (pointer, value) in [
            ("/excitation", pulse),
            ("/sensors/-", &against),
            ("/damping/rate_per_s", &rate.to_string()),
            ("/duration_s", "0.1"),
        ] {
            document.set(pointer, value).unwrap();
        }
        let typed = document.structure_scenario().unwrap();
        let run = simulate_patches(&document, &typed, &|_| ()).unwrap().run;
        let columns = frf_columns(&run).unwrap().unwrap();
        let column = |name: &str| &columns.iter().find(|(own, _)| own == name).unwrap().1;
        let exact = |frequency: f64| transmitted(4, [STIFFNESS, end], rate, frequency);
        for (i, &frequency) in column("frequency_hz").iter().enumerate() {
            if !(20.0..500.0).contains(&frequency) {
                continue;
            }
            let expected = exact(frequency);
            for (name, expected) in
                [("transmissibility_", expected[1]), ("last:transmissibility_", -expected[3])]
            {
                let part = |part: &str| column(&format!("{name}{part}"))[i];
                let found = Complex64::new(part("real"), part("imag"));
                let off = (found - expected).norm() / (1.0 + expected.norm());
                assert!(off < 2e-3, "{bodies:?} {name} {frequency} Hz: {found} {expected}");
            }
        }
        let energy = &run.transient.energy;
        assert!(energy.residual_relative() < 1e-4, "{energy:?}");

        let assembly = assemble_patches(&typed, document.folder()).unwrap();
        let request = SteadyRequest {
            amplitudes: vec![0.5],
            from_hz: 60.0,
            to_hz: 400.0,
            harmonics: Some(2),
            backbone: false,
            verify: true,
            bodies: BodyModel::Auto,
            time_sweep: None,
        };
        let found = steady(&assembly, &request).unwrap();
        let check = found.levels[0].check.unwrap();
        assert!(check.settled && check.relative_difference < 1e-3, "{check:?}");
        let table = steady_table(&found, &["foot"]).to_csv();
        let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let place = |name: &str| header.iter().position(|own| *own == name).unwrap();
        let places = ["frequency_hz", "transmissibility_1", "last:transmissibility_1"].map(place);
        for line in table.lines().skip(1) {
            let row: Vec<&str> = line.split(',').collect();
            let [frequency, first, other] = places.map(|place| row[place].parse::<f64>().unwrap());
            let expected = exact(frequency);
            assert!((first / expected[1].norm() - 1.0).abs() < 1e-7, "{frequency} {first}");
            assert!((other / expected[3].norm() - 1.0).abs() < 1e-7, "{frequency} {other}");
        }
        let rows = RowSimulator::new(document.clone(), vec![]).unwrap();
        assert!(rows.columns().iter().any(|name| name == "fundamental.receptance_s2"));

        document.set("/excitation/direction", "[0, 0, 0]").unwrap();
        let typed = document.structure_scenario().unwrap();
        let found = assemble_patches(&typed, document.folder()).unwrap_err().to_string();
        assert!(found.contains("/excitation/direction"), "{found}");
    }
}
