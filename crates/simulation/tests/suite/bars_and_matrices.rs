//! Bars beside bodies of matrices in one structure, against the stack of bars alone.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use asperity_scenario::Document;
use asperity_simulation::modes::linearised_modes;
use asperity_simulation::patches::{
    PatchRun, assemble_patches, mesh_modes, patch_modes, simulate_patches,
};
use asperity_simulation::prepared_scenario::PreparedScenario;
use asperity_simulation::quantity::Quantity;
use asperity_simulation::run::simulate;
use asperity_simulation::steady::{BodyModel, SteadyRequest, steady};
use serde_json::{Value, json};

/// Length \[m\], section \[m2\], modulus \[Pa\] and density \[kg/m3\] of the upper and the lower bar.
const UPPER: [f64; 4] = [0.2, 1e-3, 200e9, 7800.0];
const LOWER: [f64; 4] = [0.05, 2e-4, 70e9, 2700.0];

/// Nodes of a bar as one spectral element.
const NODES: usize = 24;

/// Legendre polynomial of degree `n` and its derivative.
fn legendre(n: usize, x: f64) -> [f64; 2] {
    let (mut before, mut now) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
    }
    [now, n as f64 * (before - x * now) / (1.0 - x * x)]
}

/// The Gauss-Lobatto-Legendre points.
fn lobatto_points() -> Vec<f64> {
    let degree = NODES - 1;
    let inner = |k: usize| {
        // Roots of P', by Newton steps with Legendre's equation for P''.
        let mut x = -(std::f64::consts::PI * k as f64 / degree as f64).cos();
        for _ in 0..50 {
            let [p, slope] = legendre(degree, x);
            let curvature = (2.0 * x * slope - (degree * (degree + 1)) as f64 * p) / (1.0 - x * x);
            x -= slope / curvature;
        }
        x
    };
    let inner = (1..degree).map(inner);
    std::iter::once(-1.0).chain(inner).chain(std::iter::once(1.0)).collect()
}

/// Files `bar.sti`, `.mas`, `.dof` and `foot.csv` of a bar along x as one spectral element with the exact mass
/// matrix; node 1 is its upper end.
fn write_bar(folder: &Path, [length, section, modulus, density]: [f64; 4]) {
    let points = lobatto_points();
    // More Gauss points than the polynomials need; those of degree 2 NODES.
    let order = NODES + 2;
    let gauss = |k: usize| {
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (order as f64 + 0.5)).cos();
        for _ in 0..50 {
            let [p, slope] = legendre(order, x);
            x -= p / slope;
        }
        let [_, slope] = legendre(order, x);
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    let shape = |i: usize, x: f64| -> [f64; 2] {
        let others = || (0..NODES).filter(move |&j| j != i);
        let factor = |j: usize, x: f64| (x - points[j]) / (points[i] - points[j]);
        let slope = others().map(|j| {
            let rest = others().filter(|&k| k != j).map(|k| factor(k, x));
            rest.product::<f64>() / (points[i] - points[j])
        });
        [others().map(|j| factor(j, x)).product(), slope.sum()]
    };
    let mut matrices = vec![[0.0; 2]; NODES * NODES];
    for (x, weight) in (0..order).map(gauss) {
        let shapes: Vec<[f64; 2]> = (0..NODES).map(|i| shape(i, x)).collect();
        for i in 0..NODES {
            for j in 0..NODES {
                let entry = &mut matrices[i * NODES + j];
                entry[0] += weight * shapes[i][1] * shapes[j][1] * 2.0 * modulus * section / length;
                entry[1] += weight * shapes[i][0] * shapes[j][0] * density * section * length / 2.0;
            }
        }
    }
    let (mut stiffness, mut mass, mut rows) = (String::new(), String::new(), String::new());
    for i in 0..NODES {
        for j in 0..=i {
            let [k, m] = matrices[i * NODES + j];
            writeln!(stiffness, "{} {} {k:.17e}", i + 1, j + 1).unwrap();
            writeln!(mass, "{} {} {m:.17e}", i + 1, j + 1).unwrap();
        }
        writeln!(rows, "{}.1", i + 1).unwrap();
    }
    fs::write(folder.join("bar.sti"), stiffness).unwrap();
    fs::write(folder.join("bar.mas"), mass).unwrap();
    fs::write(folder.join("bar.dof"), rows).unwrap();
    let foot = format!("cell,area_m2,node,direction,weight\n0,1e-4,{NODES},1,1\n");
    fs::write(folder.join("foot.csv"), foot).unwrap();
}

/// Both bodies as bars of a stack.
fn stack() -> Value {
    let body = |name: &str, [length, area, modulus, density]: [f64; 4]| {
        json!({"name": name, "length_m": length, "area_m2": area, "youngs_modulus_pa": modulus,
               "density_kg_per_m3": density})
    };
    let [middle, foot] = dampings();
    let interface = |name: &str, damping: &Value| json!({"name": name, "area_m2": 1e-4, "law": "rough", "damping": damping});
    common(json!({
        "bodies": [body("upper", UPPER), body("lower", LOWER)],
        "gravity_m_per_s2": 9.81,
        "interfaces": [interface("middle", &middle), interface("foot", &foot)],
        "sensors": [{"name": "top", "at": {"body": "upper", "end": "upper"}, "kind": "displacement"},
                    {"name": "middle", "at": {"body": "lower", "end": "upper"}, "kind": "displacement"}],
    }))
}

/// Damping of the interfaces.
fn dampings() -> [Value; 2] {
    let power = json!({"kind": "power", "coefficient_pa_s_per_m": 4e6, "reference_pa": 1e5, "exponent": 0.7});
    [json!({"kind": "kelvin_voigt", "time_s": 6e-6}), power]
}

/// One body as a bar, the other as matrices.
fn mixed(lower_is_bar: bool) -> Value {
    let bar = |name: &str, [length, area, modulus, density]: [f64; 4]| {
        json!({"name": name, "reduction": {"modes": 20},
               "bar": {"length_m": length, "area_m2": area, "youngs_modulus_pa": modulus,
                       "density_kg_per_m3": density, "direction": [2, 0, 0]}})
    };
    let matrices = |name: &str| {
        json!({"name": name, "reduction": {"modes": 20},
               "matrices": {"format": "calculix", "stiffness": "bar.sti", "mass": "bar.mas", "rows": "bar.dof"}})
    };
    let node = |body: &str, node: usize| json!({"body": body, "node": node});
    let at_node =
        |body: &str, node: usize| json!({"body": body, "node": node, "direction": [1, 0, 0]});
    let end = |body: &str, end: &str| json!({"body": body, "end": end});
    let (bodies, [above, below, top, middle], foot) = if lower_is_bar {
        let places = [
            node("upper", NODES),
            end("lower", "upper"),
            at_node("upper", 1),
            end("lower", "upper"),
        ];
        let foot = json!({"name": "foot", "law": "rough", "area_m2": 1e-4,
                          "above": {"body": "lower", "end": "lower"}});
        ([matrices("upper"), bar("lower", LOWER)], places, foot)
    } else {
        let places =
            [end("upper", "lower"), node("lower", 1), end("upper", "upper"), at_node("lower", 1)];
        let foot = json!({"name": "foot", "law": "rough", "body": "lower", "cells": "foot.csv"});
        ([bar("upper", UPPER), matrices("lower")], places, foot)
    };
    let mut scenario = common(json!({
        "bodies": bodies,
        "gravity_m_per_s2": [9.81, 0, 0],
        "interfaces": [{"name": "middle", "law": "rough", "area_m2": 1e-4, "above": above, "below": below}, foot],
        "sensors": [{"name": "top", "at": top, "kind": "displacement"},
                    {"name": "middle", "at": middle, "kind": "displacement"}],
    }));
    scenario["excitation"]["at"] = top;
    for (number, damping) in dampings().into_iter().enumerate() {
        scenario["interfaces"][number]["damping"] = damping;
    }
    scenario
}

/// The keys that both kinds of scenario share.
fn common(mut scenario: Value) -> Value {
    let more = json!({
        "schema": "asperity/scenario/1",
        "laws": {"rough": {"kind": "power", "coefficient": 2e10, "exponent": 0.4}},
        "damping": {"kind": "mass_proportional", "rate_per_s": 200.0},
        "excitation": {"kind": "haversine", "peak_n": 8.0, "duration_s": 4e-4},
        "duration_s": 0.04,
    });
    for (key, value) in more.as_object().unwrap() {
        scenario[key] = value.clone();
    }
    scenario
}

fn document(scenario: &Value, folder: &Path) -> Document {
    Document::parse(&scenario.to_string(), folder.join("scenario.json")).unwrap()
}

fn run(document: &Document) -> PatchRun {
    simulate_patches(document, &document.structure_scenario().unwrap(), &|_| ()).unwrap()
}

fn close(found: f64, expected: f64, tolerance: f64) {
    let off = found / expected - 1.0;
    assert!(off.abs() < tolerance, "{found:e} {expected:e}: {off:e} > {tolerance:e}");
}

/// Pressures at rest and modes are those of the stack of bars, whichever of them is given by matrices. Frequencies lack
/// the inertia of the modes left out, with an error that falls as the third power of their number.
#[test]
fn rest_and_modes_are_those_of_the_stack_of_bars() {
    let folder = tempfile::tempdir().unwrap();
    let of_bars = document(&stack(), folder.path());
    let prepared = PreparedScenario::new(&of_bars.scenario().unwrap(), folder.path()).unwrap();
    let exact = linearised_modes(&prepared.assembly, 3).unwrap().modes;
    for lower_is_bar in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        write_bar(folder.path(), if lower_is_bar { UPPER } else { LOWER });
        let mut errors = Vec::new();
        for count in [8, 16] {
            let mut scenario = mixed(lower_is_bar);
            for body in 0..2 {
                scenario["bodies"][body]["reduction"]["modes"] = json!(count);
            }
            let own = document(&scenario, folder.path());
            let scenario = own.structure_scenario().unwrap();
            let assembly = assemble_patches(&scenario, folder.path()).unwrap();
            let at_rest = assembly.structure.at_rest();
            for (found, bars) in at_rest.interfaces.iter().zip(&prepared.at_rest.interfaces) {
                close(found.pressure_pa, bars.pressure_pa, 1e-12);
                close(found.stiffness_pa_per_m, bars.stiffness_pa_per_m, 1e-12);
            }
            let modes = patch_modes(&assembly, 3).unwrap().modes;
            // Of the bodies and of both contacts.
            close(modes[0].damping_ratio, exact[0].damping_ratio, 1e-5);
            let off = |k: usize| modes[k].frequency_hz / exact[k].frequency_hz - 1.0;
            errors.push([off(0), off(1), off(2)]);
        }
        for (mode, (coarse, fine)) in errors[0].iter().zip(&errors[1]).enumerate() {
            assert!((0.0..2e-5).contains(fine), "mode {mode}: {fine:e}");
            assert!((5.0..12.0).contains(&(coarse / fine)), "mode {mode}: {coarse:e} {fine:e}");
        }
    }
}

/// A hit has the numbers of the stack of bars within its accuracy, under a force and a motion of the base. Which of the bars
/// is given by matrices makes no difference within that accuracy.
#[test]
fn hits_are_those_of_the_stack_of_bars() {
    let base = json!({"kind": "base_motion",
        "acceleration": {"kind": "haversine", "peak_m_per_s2": 3.0, "duration_s": 4e-4}});
    for is_base in [false, true] {
        let mut own = stack();
        if is_base {
            own["excitation"] = base.clone();
        }
        let folder = tempfile::tempdir().unwrap();
        let of_bars = document(&own, folder.path());
        let bars = simulate(&of_bars, &of_bars.scenario().unwrap()).unwrap();
        let features = [Quantity::FundamentalFrequency, Quantity::FundamentalReceptance];
        let mut histories = Vec::new();
        for lower_is_bar in [false, true] {
            let folder = tempfile::tempdir().unwrap();
            write_bar(folder.path(), if lower_is_bar { UPPER } else { LOWER });
            let mut scenario = mixed(lower_is_bar);
            scenario["accuracy"] = json!(1e-4);
            if is_base {
                scenario["excitation"] = base.clone();
                scenario["excitation"]["direction"] = json!([1, 0, 0]);
            }
            let own = document(&scenario, folder.path());
            let found = run(&own).run;
            for feature in features {
                let [own, bars] = [&found.observables, &bars.observables];
                let [own, bars] = [own, bars].map(|of| of.get(feature, None).unwrap());
                close(own, bars, 5e-4);
            }
            for (own, bars) in found.transient.contacts.iter().zip(&bars.transient.contacts) {
                close(own.pressure_min, bars.pressure_min, 5e-4);
                close(own.pressure_max, bars.pressure_max, 5e-4);
            }
            histories.push(found.transient.history);
        }
        let [one, other] = [0, 1].map(|k: usize| &histories[k].sensors[1].displacement);
        let most = one.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let off = one.iter().zip(other).fold(0.0, |off: f64, (x, y)| off.max((x - y).abs()));
        assert!(most > 1e-8 && off < 2e-4 * most, "{most:e} {off:e}");
    }
}

/// Harmonic balance finds the resonance of the stack of bars.
#[test]
fn steady_responses_are_those_of_the_stack_of_bars() {
    let folder = tempfile::tempdir().unwrap();
    let of_bars = document(&stack(), folder.path());
    let prepared = PreparedScenario::new(&of_bars.scenario().unwrap(), folder.path()).unwrap();
    let natural = prepared.at_rest.natural_frequency_hz.unwrap();
    let request = SteadyRequest {
        amplitudes: vec![0.3],
        from_hz: 0.9 * natural,
        to_hz: 1.1 * natural,
        harmonics: Some(5),
        backbone: false,
        verify: false,
        bodies: BodyModel::Elastic,
        time_sweep: None,
    };
    let bars = steady(&prepared.assembly, &request).unwrap();
    let bars = bars.levels[0].outcome.as_ref().unwrap().highest().unwrap();
    assert!(bars.amplitude(2) > 1e-3 * bars.amplitude(1));
    for lower_is_bar in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        write_bar(folder.path(), if lower_is_bar { UPPER } else { LOWER });
        let own = document(&mixed(lower_is_bar), folder.path());
        let assembly = assemble_patches(&own.structure_scenario().unwrap(), folder.path()).unwrap();
        let found = steady(&assembly, &request).unwrap();
        let found = found.levels[0].outcome.as_ref().unwrap().highest().unwrap();
        close(found.frequency_hz(), bars.frequency_hz(), 1e-7);
        close(found.amplitude(1), bars.amplitude(1), 1e-7);
        close(found.amplitude(2), bars.amplitude(2), 1e-6);
    }
}

/// Files of a cube with a mesh whose corners move along z: four springs of 1e9 N/m from the foot to the top, corners of
/// 0.1 kg.
fn write_cube(folder: &Path) {
    let (mut stiffness, mut mass, mut rows) = (String::new(), String::new(), String::new());
    let mut deck = "*NODE\n".to_owned();
    for node in 1..=8 {
        let corner = [[0, 0], [1, 0], [1, 1], [0, 1]][(node - 1) % 4];
        let z = 0.1 * ((node - 1) / 4) as f64;
        writeln!(
            deck,
            "{node}, {}, {}, {z}",
            0.1 * f64::from(corner[0]),
            0.1 * f64::from(corner[1])
        )
        .unwrap();
        writeln!(stiffness, "{node} {node} 1e9").unwrap();
        if node > 4 {
            writeln!(stiffness, "{node} {} -1e9", node - 4).unwrap();
        }
        writeln!(mass, "{node} {node} 0.1").unwrap();
        writeln!(rows, "{node}.3").unwrap();
    }
    deck += "*ELEMENT, TYPE=C3D8, ELSET=CUBE\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*SURFACE, NAME=TOP, TYPE=ELEMENT\nCUBE, S2\n*SURFACE, NAME=FOOT, TYPE=ELEMENT\nCUBE, S1\n*NSET, NSET=TOPS\n5, 6, 7, 8\n";
    for (name, text) in [("sti", stiffness), ("mas", mass), ("dof", rows), ("inp", deck)] {
        fs::write(folder.join(format!("cube.{name}")), text).unwrap();
    }
}

/// A bar on a cube on the ground, pressed down at its top; `middle` is the interface between them.
fn bar_on_cube(middle: &Value) -> Value {
    let mut scenario = common(json!({
        "bodies": [
            {"name": "bar", "bar": {"length_m": 0.2, "mass_kg": 2.0, "youngs_modulus_pa": 200e9, "density_kg_per_m3": 7800.0}},
            {"name": "cube", "mesh": "cube.inp",
             "matrices": {"format": "calculix", "stiffness": "cube.sti", "mass": "cube.mas", "rows": "cube.dof"}}],
        "gravity_m_per_s2": [0, 0, -9.81],
        "loads": [{"body": "bar", "end": "upper", "force_n": 200.0}],
        "interfaces": [middle, {"name": "foot", "law": "rough", "above": {"body": "cube", "surface": "FOOT"}}],
        "sensors": [{"name": "side", "at": {"body": "bar", "position_m": 0.1}, "kind": "acceleration"}],
    }));
    scenario["excitation"]["at"] = json!({"body": "bar", "end": "upper"});
    scenario
}

/// An end of a bar presses on all cells of a surface alike where the surface does not tilt: as one contact with the mean of its
/// nodes does. The lower end above the surface, and the upper end below a face that looks down, close alike.
#[test]
fn an_end_of_a_bar_meets_a_surface() {
    let folder = tempfile::tempdir().unwrap();
    write_cube(folder.path());
    let end = json!({"body": "bar", "end": "lower"});
    let top = json!({"body": "cube", "surface": "TOP"});
    let cells =
        json!({"name": "middle", "law": "rough", "above": end, "below": top, "split": [2, 2]});
    let mut turned = cells.clone();
    (turned["above"], turned["below"]) = (top, end.clone());
    let mean = json!({"name": "middle", "law": "rough", "above": end, "area_m2": 0.01,
                      "below": {"body": "cube", "set": "TOPS"}});
    let force = 200.0 + 2.0 * 9.81;
    let mut lowest = Vec::new();
    for (middle, count) in [(&cells, 4), (&turned, 4), (&mean, 1)] {
        let own = document(&bar_on_cube(middle), folder.path());
        let assembly = assemble_patches(&own.structure_scenario().unwrap(), folder.path()).unwrap();
        assert_eq!(assembly.structure.patches[0].cells.len(), count);
        let at_rest = assembly.structure.at_rest();
        close(at_rest.interfaces[0].pressure_pa, force / 0.01, 1e-9);
        close(at_rest.interfaces[1].pressure_pa, (force + 0.8 * 9.81) / 0.01, 1e-9);
        let modes = patch_modes(&assembly, 6).unwrap().modes;
        // Motions of the corners against each other do not move the bar.
        let moves = modes.iter().find(|mode| mode.ports[assembly.structure.load].abs() > 1e-3);
        lowest.push(moves.unwrap().frequency_hz);
    }
    close(lowest[1], lowest[0], 1e-10);
    close(lowest[2], lowest[0], 1e-10);

    // The twelve edges of the cube as a trace line for modal programs, and the displacement at rest on its top.
    let own = document(&bar_on_cube(&cells), folder.path());
    let scenario = own.structure_scenario().unwrap();
    let assembly = assemble_patches(&scenario, folder.path()).unwrap();
    let modes = patch_modes(&assembly, 2).unwrap();
    let meshes = mesh_modes(&scenario, &assembly.structure, &modes, folder.path()).unwrap();
    let text = meshes[0].universal_file();
    let set = text.split("    -1\n").find(|set| set.starts_with("    82\n")).unwrap();
    let lines: Vec<&str> = set.lines().collect();
    assert_eq!(lines[1], format!("{:>10}{:>10}{:>10}", 1, 36, 8));
    assert_eq!(lines[2], "cube");
    assert!(lines[3..].iter().all(|line| line.len() <= 80));
    let nodes: Vec<i64> = lines[3..]
        .iter()
        .flat_map(|line| line.split_whitespace())
        .map(|n| n.parse().unwrap())
        .collect();
    let edges: Vec<[i64; 2]> = nodes.chunks(3).map(|three| [three[0], three[1]]).collect();
    assert!(nodes.chunks(3).all(|three| three[2] == 0));
    let along = [[1, 2], [2, 3], [3, 4], [1, 4]];
    let expected = along.iter().copied().chain(along.map(|edge| edge.map(|n| n + 4)));
    let expected = expected.chain((1..=4).map(|n| [n, n + 4]));
    assert_eq!(edges.len(), 12);
    for edge in expected {
        assert!(edges.contains(&edge), "{edge:?}");
    }
    let [top, foot] = [5, 1].map(|node| meshes[0].at_rest(node).unwrap()[2]);
    // Four springs of 1e9 N/m carry the force on the top and half of the weight of the cube.
    close(foot - top, (force + 0.4 * 9.81) / 4e9, 1e-6);
}

/// Places that a bar does not have are named, with what is accepted.
#[test]
fn places_that_bars_do_not_have_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    write_cube(folder.path());
    let side = |body: &str, key: &str, name: &str| json!({"body": body, key: name});
    let cells = json!({"name": "middle", "law": "rough", "above": side("bar", "end", "lower"),
                       "below": side("cube", "surface", "TOP")});
    let good = bar_on_cube(&cells);
    let cases = [
        ("/interfaces/0/above", side("bar", "end", "upper"), "does not face the other"),
        ("/interfaces/0/above", side("cube", "end", "lower"), "body \"cube\" is no bar"),
        ("/interfaces/0/area_m2", json!(1e-4), "the side of a contact with an area is no place"),
        (
            "/interfaces/1/above",
            side("bar", "end", "upper"),
            "/interfaces/1: the contact of an end of a bar has no area",
        ),
        (
            "/bodies/0/bar/direction",
            json!([0, 0, 0]),
            "/bodies/0/bar/direction: the axis has no direction",
        ),
        ("/bodies/0/mesh", json!("cube.inp"), "/bodies/0/mesh: a bar is given in SI"),
        ("/bodies/0/reduction", json!({"modes": 2000}), ""),
        (
            "/loads/0",
            json!({"body": "cube", "end": "upper", "force_n": 1.0}),
            "/loads/0/end: body \"cube\" is no bar",
        ),
        ("/sensors/0/at", json!({"body": "bar", "position_m": 0.3}), "/sensors/0/at: "),
        (
            "/sensors/0/at",
            json!({"body": "bar", "node": 1, "direction": [0, 0, 1]}),
            "/sensors/0/at: ",
        ),
        (
            "/held",
            json!([{"body": "bar", "node": 1, "direction": [0, 0, 1]}]),
            "/held/0: reduced models and bars have no nodes",
        ),
    ];
    for (pointer, value, expected) in cases {
        let mut scenario = good.clone();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = scenario.pointer_mut(parent).unwrap();
        match key.parse::<usize>() {
            Ok(number) => parent[number] = value,
            Err(_) => parent[key] = value,
        }
        let scenario = document(&scenario, folder.path()).structure_scenario().unwrap();
        let found = assemble_patches(&scenario, folder.path());
        if expected.is_empty() {
            assert!(found.is_ok(), "{pointer}: {found:?}");
        } else {
            let error = found.err().unwrap().to_string();
            assert!(error.contains(expected), "{pointer}: {error}");
        }
    }
}
