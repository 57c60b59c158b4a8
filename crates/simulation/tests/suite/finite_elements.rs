//! Structures of matrices: against references by an independent program, and against bars in modal
//! coordinates.
//!
//! The references are not part of this repository; without them their test is skipped by name.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use asperity_dynamics::{Batch, Modal, ModalModel, Sampling, TransientCase};
use asperity_harmonic::{
    ContactSystem, Continuation, FourierResolution, HarmonicSettings, LawEvaluation, SystemPort,
    trace,
};
use asperity_law::{ContactLaw, Power};
use asperity_mesh::{
    Body, ComponentModes, Interface, ModeCount, Port, ResidualFlexibility, Stack, Support,
};
use asperity_scenario::Document;
use asperity_simulation::patches::{
    PatchRun, assemble_patches, patch_modes, simulate_patches, steady_cells,
};
use asperity_simulation::record::history_columns;
use asperity_simulation::row_simulator::RowSimulator;
use asperity_simulation::steady::{
    BodyModel, SteadyRequest, SweepDirection, TimeSweepRequest, steady, steady_table,
};
use asperity_simulation::sweep::{Variation, sweep};
use asperity_structure::{Damping, LoadCase, PreloadedStructure, TimeFunction};
use serde_json::Value;
use tempfile::TempDir;

const SCENARIO: &str = r#"{"schema": "asperity/scenario/1",
 "title": "two blocks",
 "bodies": [{"name": "blocks", "mesh": "two_blocks.inp", "reduction": {"modes": 60},
             "matrices": {"format": "calculix", "stiffness": "two_blocks.sti", "mass": "two_blocks.mas", "rows": "two_blocks.dof"}}],
 "gravity_m_per_s2": [0, 0, -9.81],
 "loads": [{"body": "blocks", "file": "loads.csv"}],
 "interfaces": [{"name": "patch", "law": "rough", "body": "blocks", "cells": "cells.csv"}],
 "laws": {"rough": {"kind": "power", "coefficient": 1e8, "exponent": 0.5}},
 "damping": {"kind": "rayleigh", "rate_per_s": 60, "time_s": 4e-7},
 "excitation": {"kind": "haversine", "peak_n": 100, "duration_s": 0.25e-3,
                "at": {"body": "blocks", "node": 172, "direction": [0, 0, -1]}},
 "sensors": [{"name": "hammer", "at": {"body": "blocks", "node": 172, "direction": [0, 0, 1]}, "kind": "displacement"},
             {"name": "corner", "at": {"body": "blocks", "node": 230, "direction": [0, 0, 1]}, "kind": "displacement"}],
 "duration_s": 0.005}"#;

/// A copy of the data of the two blocks; none where there are no data, which is said for `test`.
fn two_blocks(test: &str) -> Option<TempDir> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/fe/two_blocks");
    if !data.is_dir() {
        eprintln!("skipped {test}: no data of two_blocks");
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    for file in fs::read_dir(&data).unwrap().flatten() {
        fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    Some(folder)
}

fn simulate(document: &Document) -> PatchRun {
    let scenario = document.structure_scenario().unwrap();
    simulate_patches(document, &scenario, &|_| ()).unwrap()
}

fn largest(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

#[test]
fn two_blocks_move_as_by_the_reference() {
    let Some(folder) = two_blocks("two_blocks_move_as_by_the_reference") else { return };
    let path = folder.path().join("scenario.json");
    fs::write(&path, SCENARIO).unwrap();
    let found = simulate(&Document::read(&path).unwrap());
    let history = &found.run.transient.history;
    for (sensor, expected) in history.sensors.iter().zip([5.81247e-6, 5.67676e-6]) {
        let own = largest(&sensor.displacement);
        assert!((own / expected - 1.0).abs() < 1e-3, "{own:e} {expected:e}");
    }
    let lost = found.cells[0][0].contact_lost_s;
    assert!((lost - 1.3645e-3).abs() < 1e-5, "{lost}");
    let open = found.cells[0].iter().filter(|cell| cell.contact_lost_s > 0.0).count();
    assert_eq!(open, 4);
    let accuracy = found.run.summary.accuracy.as_ref().unwrap();
    assert!(accuracy.estimated_error < 0.05, "{accuracy:?}");
    let columns = history_columns(&found.run);
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let expected = [
        "time_s",
        "force_n",
        "hammer:displacement_m",
        "corner:displacement_m",
        "patch:pressure_pa",
        "patch:closure_m",
        "patch:stiffness_pa_per_m",
    ];
    assert_eq!(names, expected);

    // Harder hits in the same structure: the fundamental falls as the patch opens.
    let document = Document::read(&path).unwrap();
    let forces = Variation::parse("/excitation/peak_n=20:100:3").unwrap();
    let sweep = sweep(&document, &[forces]).unwrap();
    let f1 = [0, 1, 2].map(|run| sweep.number(run, "fundamental.frequency_hz").unwrap());
    assert!(f1[0] > f1[1] && f1[1] > f1[2], "{f1:?}");
    let same = found.run.summary.fundamental.unwrap().frequency_hz;
    assert!((f1[2] / same - 1.0).abs() < 1e-12);

    // The second run reads its reduction, and every format gives the same numbers.
    let again = simulate(&Document::read(&path).unwrap());
    assert_eq!(again.run.transient.history, found.run.transient.history);
    let formats = [
        r#"{"format": "matrix_market", "stiffness": "two_blocks_stiffness.mtx", "mass": "two_blocks_mass.mtx", "rows": "two_blocks.dof"}"#,
        r#"{"format": "abaqus", "stiffness": "two_blocks_abaqus_STIF1.mtx", "mass": "two_blocks_abaqus_MASS1.mtx"}"#,
        r#"{"format": "matlab", "stiffness": "two_blocks.mat"}"#,
        r#"{"format": "matlab", "stiffness": "two_blocks_permuted.mat"}"#,
    ];
    let expected =
        [3_429.416_61, 3_642.384_94, 4_383.656_10, 12_060.538_8, 17_288.410_9, 21_862.558_7];
    for format in formats {
        let mut document = Document::read(&path).unwrap();
        document.set("/bodies/0/matrices", format).unwrap();
        let scenario = document.structure_scenario().unwrap();
        let assembly = assemble_patches(&scenario, document.folder()).unwrap();
        let modes = patch_modes(&assembly, 6).unwrap();
        for (mode, frequency) in modes.modes.iter().zip(expected) {
            let off = mode.frequency_hz / frequency - 1.0;
            assert!(off.abs() < 2e-6, "{format}: {} {frequency}", mode.frequency_hz);
        }
    }
}

/// Cells between the surfaces of the deck in place of the file of cells: pressures and modes of the reference. The
/// file's areas have ten digits.
#[test]
fn cells_between_surfaces_carry_the_pressures_of_the_reference() {
    let test = "cells_between_surfaces_carry_the_pressures_of_the_reference";
    let Some(folder) = two_blocks(test) else { return };
    let text = fs::read_to_string(folder.path().join("reference.json")).unwrap();
    let reference: serde_json::Value = serde_json::from_str(&text).unwrap();
    let expected = reference["static"]["cells"].as_array().unwrap();
    let surfaces = SCENARIO.replace(
        r#""body": "blocks", "cells": "cells.csv""#,
        r#""above": {"body": "blocks", "surface": "contact_upper"}, "below": {"body": "blocks", "surface": "CONTACT_LOWER"}, "split": [4, 4]"#,
    );
    for run in ["reduced", "kept"] {
        let document = Document::parse(&surfaces, folder.path().join("s.json")).unwrap();
        let scenario = document.structure_scenario().unwrap();
        let structure = assemble_patches(&scenario, document.folder()).unwrap().structure;
        for (contact, expected) in structure.structure.contacts().iter().zip(expected) {
            let off = contact.pressure() / expected["pressure_pa"].as_f64().unwrap() - 1.0;
            assert!(off.abs() < 1e-9, "{run} {}: {off:e}", contact.name());
        }
        assert_eq!(structure.patches[0].outlines.len(), 16);
    }
}

/// A block of eight nodes that move up and down, on the ground: its deck, matrices and cell.
fn write_block(folder: &Path) {
    let (mut nodes, mut stiffness, mut mass, mut rows) =
        (String::from("*NODE\n"), String::new(), String::new(), String::new());
    let square = [[0, 0], [2, 0], [2, 1], [0, 1]];
    for node in 0..8 {
        let [x, y] = square[node % 4];
        writeln!(nodes, "{},{x}e-2,{y}e-2,{}e-2", node + 1, node / 4).unwrap();
        writeln!(mass, "{0} {0} 0.01", node + 1).unwrap();
        writeln!(rows, "{}.3", node + 1).unwrap();
        // Columns above each corner, and a ring of springs in each layer.
        let (next, layer) = (4 * (node / 4) + (node + 1) % 4, 4 * (node / 4));
        writeln!(stiffness, "{0} {0} 5e7", node + 1).unwrap();
        let (a, b) = (node.min(next) + 1, node.max(next) + 1);
        writeln!(stiffness, "{a} {b} -2e7").unwrap();
        if layer == 0 {
            writeln!(stiffness, "{} {} -1e7", node + 1, node + 5).unwrap();
        }
    }
    let deck = format!(
        "{nodes}*ELEMENT, TYPE=C3D8, ELSET=ALL\n1,1,2,3,4,5,6,7,8\n*NSET, NSET=FOOT\n1,2,3,4\n*SURFACE, NAME=SOLE, TYPE=ELEMENT\nALL,S1\n*SURFACE, NAME=SIDE, TYPE=ELEMENT\nALL,S3\n"
    );
    fs::write(folder.join("block.inp"), deck).unwrap();
    fs::write(folder.join("block.sti"), stiffness).unwrap();
    fs::write(folder.join("block.mas"), mass).unwrap();
    fs::write(folder.join("block.dof"), rows).unwrap();
    let weights = (1..=4).map(|node| format!("a,2e-4,{node},3,-0.25\n"));
    let cells = weights.collect::<String>();
    let header = "cell,area_m2,node,direction,weight\n";
    fs::write(folder.join("cells.csv"), format!("{header}{cells}")).unwrap();
}

const BLOCK: &str = r#"{"schema": "asperity/scenario/1",
     "bodies": [{"name": "block", "mesh": "block.inp", "reduction": {"modes": 8},
                 "matrices": {"format": "calculix", "stiffness": "block.sti", "mass": "block.mas", "rows": "block.dof"}}],
     "gravity_m_per_s2": [0, 0, -9.81],
     "interfaces": [{"name": "sole", "law": "rough", "body": "block", "cells": "cells.csv"}],
     "laws": {"rough": {"kind": "power", "coefficient": 1e10, "exponent": 0.5}},
     "damping": {"kind": "mass_proportional", "rate_per_s": 60},
     "excitation": {"kind": "haversine", "peak_n": 0.1, "duration_s": 1e-3,
                    "at": {"body": "block", "node": 5, "direction": [0, 0, -1]}},
     "sensors": [{"name": "top", "at": {"body": "block", "node": 7, "direction": [0, 0, 1]}, "kind": "displacement"}],
     "duration_s": 0.01}"#;

/// A surface or a set of nodes on rigid ground is the cell that a file states.
#[test]
fn a_surface_on_the_ground_is_the_cell_of_a_file() {
    let folder = tempfile::tempdir().unwrap();
    write_block(folder.path());
    let mut found = Vec::new();
    for patch in [
        r#""body": "block", "cells": "cells.csv""#,
        r#""above": {"body": "block", "surface": "SOLE"}"#,
        r#""above": {"body": "block", "set": "foot"}, "split": "faces""#,
        r#""above": {"body": "block", "set": "foot"}, "split": [1, 1], "along": [1, 1, 0]"#,
    ] {
        let text = BLOCK.replace(r#""body": "block", "cells": "cells.csv""#, patch);
        let document = Document::parse(&text, folder.path().join("block.json")).unwrap();
        let run = simulate(&document);
        assert!((run.cells[0][0].area_m2 / 2e-4 - 1.0).abs() < 1e-12);
        found.push(run.run.transient.history.sensors[0].displacement.clone());
    }
    let scale = largest(&found[0]);
    assert!(scale > 1e-9, "{scale:e}");
    for other in &found[1..] {
        let off =
            other.iter().zip(&found[0]).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(off < 1e-9 * scale, "{:e}", off / scale);
    }
    let cases = [
        (
            r#"{"body": "block", "surface": "SOIL"}"#,
            "block.inp: no surface SOIL; accepted: the deck has SIDE, SOLE",
        ),
        (r#"{"body": "blocks", "surface": "SOLE"}"#, "no body is named \"blocks\""),
        (
            r#"{"body": "block", "set": "HEAD"}"#,
            "block.inp: no node set HEAD; accepted: the deck has FOOT",
        ),
        (
            r#"{"body": "block", "surface": "SOLE"}, "split": "faces", "along": [1, 0, 0]"#,
            "/interfaces/0/along",
        ),
        (
            r#"{"body": "block", "surface": "SOLE"}, "split": [40, 40]"#,
            "/interfaces/0/split: 1600 cells in all",
        ),
        (
            r#"{"body": "block", "surface": "SOLE"}, "below": {"body": "block", "surface": "SIDE"}"#,
            "/interfaces/0/below: the surfaces SOLE and SIDE do not face each other",
        ),
        (r#"{"body": "block", "surface": "SIDE"}"#, "has no row of node 1 direction 2"),
        (r#"{"body": "block", "surface": "SOLE"}, "cells": "cells.csv""#, "/interfaces/0"),
    ];
    for (above, expected) in cases {
        let patch = format!(r#""above": {above}"#);
        let text = BLOCK.replace(r#""body": "block", "cells": "cells.csv""#, &patch);
        let document = Document::parse(&text, folder.path().join("block.json")).unwrap();
        let message = match document.structure_scenario() {
            Err(error) => format!("{:?}", error.diagnostics),
            Ok(scenario) => {
                assemble_patches(&scenario, document.folder()).map(|_| ()).unwrap_err().to_string()
            }
        };
        assert!(message.contains(expected), "{above}: {message}");
    }
}

/// Steady vibration of 16 cells by harmonic balance, near resonance: first and second harmonic.
#[test]
fn two_blocks_vibrate_steadily_as_by_the_reference() {
    let Some(folder) = two_blocks("two_blocks_vibrate_steadily_as_by_the_reference") else {
        return;
    };
    let mut document = Document::parse(SCENARIO, folder.path().join("scenario.json")).unwrap();
    document.set("/bodies/0/reduction/modes", "200").unwrap();
    let scenario = document.structure_scenario().unwrap();
    let structure = assemble_patches(&scenario, document.folder()).unwrap().structure;
    let port = SystemPort::Number;
    let system = ContactSystem::of_structure(&*structure.structure, LawEvaluation::default());
    let system =
        system.unwrap().with_ports(port(structure.load), &[port(structure.sensors[0])]).unwrap();
    let resolution = FourierResolution::Fixed { harmonics: 6, samples: 128 };
    let settings = HarmonicSettings { resolution, ..HarmonicSettings::default() };
    let sweep = Continuation::Frequency { force: 1.0, from: 3450.0, to: 3450.5 };
    let branch = trace(&system, &sweep, &settings).unwrap();
    let first = &branch.points[0];
    assert!((first.frequency_hz() - 3450.0).abs() < 1e-9);
    for (harmonic, expected) in [(1, 1.360_394e-6), (2, 3.1312e-8)] {
        let own = first.at_sensor(0, harmonic).norm();
        assert!((own / expected - 1.0).abs() < 1e-4, "{harmonic}: {own:e} {expected:e}");
    }
}

const BARS: &str = r#"{"schema": "asperity/scenario/1",
     "bodies": [{"name": "bars", "reduction": {"modes": 8},
                 "matrices": {"format": "calculix", "stiffness": "bars.sti", "mass": "bars.mas", "rows": "bars.dof"}}],
     "loads": [{"body": "bars", "file": "weight.csv"}],
     "interfaces": [{"name": "upper", "law": "pl", "body": "bars", "cells": "cells0.csv"},
                    {"name": "lower", "law": "pl", "body": "bars", "cells": "cells1.csv"}],
     "laws": {"pl": {"kind": "power", "coefficient": 1.81e10, "exponent": 0.35}},
     "damping": {"kind": "mass_proportional", "rate_per_s": 352},
     "excitation": {"kind": "gamma_pulse", "peak_n": 10, "rise_s": 0.34e-3,
                    "at": {"body": "bars", "node": 1, "direction": [1, 0, 0]}},
     "sensors": [{"name": "first", "at": {"body": "bars", "node": 1, "direction": [1, 0, 0]}, "kind": "displacement"}],
     "duration_s": 0.02, "accuracy": 1e-4}"#;

/// A block on a sample on the ground, in free modes of both bars.
fn bars() -> (Stack, ComponentModes) {
    let law: Arc<dyn ContactLaw> = Arc::new(Power::new(1.81e10, 0.35, 0.0).unwrap());
    let bodies = vec![
        Body::with_mass("guide bar", 0.229, 1.61, 71e9, 2710.0).unwrap(),
        Body::new("sample", 0.015, 1.15e-4, 71e9, 2710.0).unwrap(),
    ];
    let contact = |name| Interface::new(name, 1.15e-4, Arc::clone(&law)).unwrap();
    let contacts = vec![contact("upper"), contact("lower")];
    let stack = Stack::new(bodies, contacts, Support::Rigid, 9.81).unwrap();
    let modes = ComponentModes::of_stack(&stack, ModeCount::PerBody(4), &[Port::TOP]).unwrap();
    let zero = ResidualFlexibility::zero(modes.ports());
    let contacts = modes.contacts().to_vec();
    let modes = ComponentModes::new(modes.modes().to_vec(), zero, contacts, Vec::new()).unwrap();
    (stack, modes)
}

/// Files of matrices in modal coordinates: node n moves along x by the coordinate of mode n.
fn write_files(folder: &Path, modes: &ComponentModes) {
    let (mut stiffness, mut mass, mut rows) = (String::new(), String::new(), String::new());
    for (row, mode) in modes.modes().iter().enumerate().map(|(row, mode)| (row + 1, mode)) {
        writeln!(stiffness, "{row} {row} {:e}", mode.angular_frequency.powi(2)).unwrap();
        writeln!(mass, "{row} {row} 1.0").unwrap();
        writeln!(rows, "{row}.1").unwrap();
    }
    fs::write(folder.join("bars.sti"), stiffness).unwrap();
    fs::write(folder.join("bars.mas"), mass).unwrap();
    fs::write(folder.join("bars.dof"), rows).unwrap();
    for (number, pair) in modes.contacts().iter().enumerate() {
        let mut cells = String::from("cell,area_m2,node,direction,weight\n");
        for (row, mode) in modes.modes().iter().enumerate() {
            if mode.closure(*pair) != 0.0 {
                writeln!(cells, "0,1.15e-4,{},1,{:e}", row + 1, mode.closure(*pair)).unwrap();
            }
        }
        fs::write(folder.join(format!("cells{number}.csv")), cells).unwrap();
    }
    // Forces along the modes: the weight of rigid motions, and a hit whose shape is the first mode's.
    let mut loads = String::from("node,direction,force_n\n");
    for (row, mode) in modes.modes().iter().enumerate() {
        if mode.angular_frequency == 0.0 {
            let root_of_mass = 1.0 / largest(&mode.ports);
            writeln!(loads, "{},1,{:e}", row + 1, 9.81 * root_of_mass).unwrap();
        }
    }
    fs::write(folder.join("weight.csv"), loads).unwrap();
}

/// Bars given as matrices move as bars: at rest, in their modes, and in time by another integrator.
#[test]
fn bars_given_as_matrices_are_bars() {
    let (stack, modes) = bars();
    let folder = tempfile::tempdir().unwrap();
    write_files(folder.path(), &modes);
    let document = Document::parse(BARS, folder.path().join("bars.json")).unwrap();
    let scenario = document.structure_scenario().unwrap();
    let assembly = assemble_patches(&scenario, document.folder()).unwrap();
    let expected = PreloadedStructure::new(stack, Damping::Rate(352.0)).unwrap();
    for (own, bar) in assembly.structure.structure.contacts().iter().zip(expected.contacts()) {
        assert!((own.pressure() / bar.pressure() - 1.0).abs() < 1e-9);
    }
    let structure = PreloadedStructure::of_components(
        modes.clone(),
        expected.contacts().to_vec(),
        Damping::Rate(352.0),
    )
    .unwrap();
    let [own, bar] =
        [&*assembly.structure.structure, &structure].map(|one| one.port_modes(4).unwrap());
    for (own, bar) in own.iter().zip(&bar) {
        assert!((own.frequency_hz / bar.frequency_hz - 1.0).abs() < 1e-9);
        assert!((own.damping_ratio / bar.damping_ratio - 1.0).abs() < 1e-9);
    }

    // The force on the first coordinate is one of 1/sqrt(m) per newton on the centre of the guide bar; the
    // same load acts on a port of that shape.
    let (structure, ports) = (shaped_bars(352.0), modes.ports());
    let model = Arc::new(ModalModel::new(structure, ports, &[ports]).unwrap());
    let pulse = LoadCase::force(TimeFunction::GammaPulse { rise: 0.34e-3 }, 10.0);
    let (step, sensor, tolerance) = (Some(2.5e-7), 0, None);
    let case = TransientCase { model, load: pulse, sensor, duration: 0.02, step, tolerance };
    let batch = Batch { instructions: Modal::default().instructions };
    let bar = batch.transient(&case, &Sampling::new(0.02, 2e5).unwrap()).unwrap();
    let found = simulate(&document);
    let [own, bar] = [&found.run.transient, &bar].map(|one| &one.history.sensors[0].displacement);
    let scale = largest(bar);
    let off = own.iter().zip(bar).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    assert!(off < 2e-4 * scale, "{:e}", off / scale);
}

/// The bars of [`bars`], with a port that the first mode alone moves.
fn shaped_bars(damping: f64) -> PreloadedStructure<ComponentModes> {
    let (stack, modes) = bars();
    let expected = PreloadedStructure::new(stack, Damping::Rate(damping)).unwrap();
    let mut shaped = modes.modes().to_vec();
    for (number, mode) in shaped.iter_mut().enumerate() {
        mode.ports.push(if number == 0 { 1.0 } else { 0.0 });
    }
    let zero = ResidualFlexibility::zero(modes.ports() + 1);
    let shaped = ComponentModes::new(shaped, zero, modes.contacts().to_vec(), Vec::new()).unwrap();
    let contacts = expected.contacts().to_vec();
    PreloadedStructure::of_components(shaped, contacts, Damping::Rate(damping)).unwrap()
}

fn steady_request(amplitude: f64) -> SteadyRequest {
    SteadyRequest {
        amplitudes: vec![amplitude],
        from_hz: 700.0,
        to_hz: 1000.0,
        harmonics: Some(6),
        backbone: true,
        verify: true,
        bodies: BodyModel::Auto,
        time_sweep: Some(TimeSweepRequest { direction: SweepDirection::Up, frequencies: 4 }),
    }
}

/// Steady responses of bars given as matrices agree with the bars' own modes, and with time integration.
#[test]
fn bars_given_as_matrices_vibrate_as_bars() {
    let folder = tempfile::tempdir().unwrap();
    write_files(folder.path(), &bars().1);
    let document = Document::parse(BARS, folder.path().join("bars.json")).unwrap();
    let scenario = document.structure_scenario().unwrap();
    let assembly = assemble_patches(&scenario, document.folder()).unwrap();
    let request = steady_request(0.5);
    let found = steady(&assembly, &request).unwrap();
    let level = &found.levels[0];
    let own = level.outcome.as_ref().unwrap();

    let structure = shaped_bars(352.0);
    let port = SystemPort::Number(structure.component_modes().ports() - 1);
    let system = ContactSystem::of_structure(&structure, LawEvaluation::default()).unwrap();
    let system = system.with_ports(port, &[port]).unwrap();
    let resolution = FourierResolution::Fixed { harmonics: 6, samples: 96 };
    let settings = HarmonicSettings { resolution, ..HarmonicSettings::default() };
    let range = Continuation::Frequency { force: 0.5, from: 700.0, to: 1000.0 };
    let bar = trace(&system, &range, &settings).unwrap();
    let [own_peak, peak] = [own, &bar].map(|branch| branch.highest().unwrap());
    assert!((own_peak.frequency_hz() / peak.frequency_hz() - 1.0).abs() < 1e-8);
    assert!((own_peak.amplitude(1) / peak.amplitude(1) - 1.0).abs() < 1e-8);
    assert!(own_peak.amplitude(2) > 1e-3 * own_peak.amplitude(1));

    let check = level.check.unwrap();
    assert!(check.settled && check.relative_difference < 1e-4, "{check:?}");
    let sweep = found.time_sweeps[0].outcome.as_ref().unwrap();
    let on_branch = |hz: f64| {
        let around = own.points.windows(2);
        let mut around =
            around.filter(|pair| (pair[0].frequency_hz()..=pair[1].frequency_hz()).contains(&hz));
        let pair = around.next().unwrap();
        let [a, b] = [&pair[0], &pair[1]];
        let share = (hz - a.frequency_hz()) / (b.frequency_hz() - a.frequency_hz());
        a.amplitude(1) + share * (b.amplitude(1) - a.amplitude(1))
    };
    for point in sweep {
        // Between points of the branch amplitudes are taken as straight.
        let off = point.amplitude_1_m / on_branch(point.frequency_hz.clamp(700.001, 999.999)) - 1.0;
        assert!(off.abs() < 5e-3, "{point:?} {off}");
    }
    let backbones = found.backbones.as_ref().unwrap();
    assert!(backbones.mode.is_ok() && backbones.phase_resonance.is_ok());
    let cells = steady_cells(&assembly.structure, &found).to_csv();
    assert_eq!(cells.lines().count(), 3, "{cells}");
    let table = steady_table(&found, &["upper", "lower"]).to_csv();
    assert!(table.lines().next().unwrap().contains("upper:pressure_min_pa"), "{table}");
}

/// Rows of values are the runs of the scenarios with these values.
#[test]
fn rows_of_structures_are_their_runs() {
    let folder = tempfile::tempdir().unwrap();
    write_files(folder.path(), &bars().1);
    let document = Document::parse(BARS, folder.path().join("bars.json")).unwrap();
    let places = ["/excitation/peak_n", "/laws/pl/coefficient"];
    let of_places = places.map(|place| vec![place.to_owned()]).to_vec();
    let simulator = RowSimulator::new(document.clone(), of_places).unwrap();
    let simulator = simulator.with_frf(vec![500.0, 900.0]);
    let rows = [[5.0, 1.81e10], [15.0, 1.81e10], [5.0, 1.5e10]];
    let values: Vec<Vec<Value>> = rows.iter().map(|row| row.map(Value::from).to_vec()).collect();
    let mut values = values.clone();
    values.push(vec![Value::from(-1.0), Value::from(0.0)]);
    let found = simulator.run(&values);
    let column = simulator.columns().iter().position(|name| name == "fundamental.frequency_hz");
    for (row, one) in rows.iter().zip(&found) {
        let one = one.as_ref().unwrap();
        let mut changed = document.clone();
        for (place, value) in places.iter().zip(row) {
            changed.set(place, &value.to_string()).unwrap();
        }
        let alone = simulate(&changed).run.summary.fundamental.unwrap().frequency_hz;
        assert_eq!(one.values[column.unwrap()], alone);
        assert!(one.frf.iter().all(|magnitude| *magnitude > 0.0));
    }
    let fault = found[3].as_ref().unwrap_err().to_string();
    assert!(fault.contains("coefficient"), "{fault}");
}

/// Faults are named with their place in the scenario, or their file and line.
#[test]
fn faults_of_structures_are_named() {
    let (_, modes) = bars();
    let folder = tempfile::tempdir().unwrap();
    write_files(folder.path(), &modes);
    let cases = [
        (
            "/sensors/0/at/node",
            "77",
            "/sensors/0/at: body \"bars\" has no row of node 77 direction 1",
        ),
        (
            "/sensors/0/at/direction",
            "[0, 0, 0]",
            "/sensors/0/at/direction: the direction has no length",
        ),
        ("/sensors/0/at/body", "bar", "UnknownBody"),
        (
            "/loads/0",
            r#"{"body": "bars", "node": 1, "direction": [-1, 0, 0], "force_n": 99}"#,
            "no static equilibrium",
        ),
        ("/loads/0/file", "none.csv", "none.csv"),
        ("/interfaces/0/cells", "weight.csv", "weight.csv, line 1"),
        ("/bodies/0/matrices/stiffness", "bars.dof", "bars.dof"),
        (
            "/interfaces/0/law",
            r#"{"kind": "exponential", "length_m": 1e-7}"#,
            "/interfaces/0/law: the law never separates",
        ),
        ("/damping", r#"{"kind": "loss_factor", "loss_factor": 0.01}"#, "/damping"),
        (
            "/loads/0",
            r#"{"body": "bars", "set": "TOP", "direction": [1, 0, 0], "force_n": 9}"#,
            "has no mesh with sets and surfaces",
        ),
    ];
    for (pointer, value, expected) in cases {
        let mut document = Document::parse(BARS, folder.path().join("bars.json")).unwrap();
        document.set(pointer, value).unwrap();
        let message = match document.structure_scenario() {
            Err(error) => format!("{:?}", error.diagnostics),
            Ok(scenario) => {
                assemble_patches(&scenario, document.folder()).map(|_| ()).unwrap_err().to_string()
            }
        };
        assert!(message.contains(expected), "{pointer}: {message}");
    }
}
