//! Laws of structures of matrices, from hits on all rows of their matrices by an integrator of the test.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::lattice::{Lattice, RATE_HZ};
use crate::twin::{Noise, is_long};
use asperity_experiment::{AnalysisOptions, FrequencyBand, ResponseChoice, analyse};
use asperity_identify::{Identification, IdentificationProblem, Usability, identify};
use asperity_measure::{Format, ReadOptions, WriteOptions};
use asperity_scenario::Document;
use asperity_simulation::patches::assemble_patches;
use serde_json::{Value, json};

/// The law of the twin.
const TRUTH: [f64; 2] = [1.2e8, 0.45];

/// Preloads, and peaks of hits on each \[N\].
const PRELOADS: [f64; 2] = [60.0, 120.0];
const PEAKS: [f64; 3] = [3.0, 24.0, 12.0];

/// Peaks of the hits: two of them in the short tests.
fn peaks() -> &'static [f64] {
    if is_long() { &PEAKS } else { &PEAKS[..2] }
}

/// Standard deviations of f1 and A1 over their values.
const NOISE: [f64; 2] = [3e-4, 5e-3];

/// Hits of the twin with noise, one data set for each preload.
fn measured(lattice: &Lattice, seed: u64) -> Vec<Value> {
    let mut noise = Noise::new(seed);
    let of_preload = |preload: f64| {
        let hits = peaks().iter().map(|&peak| {
            let found = lattice.hit(TRUTH, preload, peak);
            let mut shown = |value: f64, relative: f64| json!({"value": value * (1.0 + relative * noise.normal()), "standard_deviation": relative * value});
            json!({"force_peak_n": peak, "features": {
                "fundamental.frequency_hz": shown(found[0], NOISE[0]),
                "fundamental.receptance_m_per_n": shown(found[1], NOISE[1]),
            }})
        });
        let hits: Vec<Value> = hits.collect();
        json!({"kind": "hits", "name": format!("{preload} N"), "set": {"/loads/0/force_n": preload}, "hits": hits})
    };
    PRELOADS.map(of_preload).into()
}

fn problem(lattice: &Lattice, folder: &Path, law: &Value, more: &Value) -> IdentificationProblem {
    lattice.write(folder);
    let mut problem = json!({
        "schema": "asperity/identify/1",
        "scenario": Lattice::scenario(law),
        "starts": 1,
        "draws": 100,
    });
    for (key, value) in more.as_object().into_iter().flatten() {
        match key.strip_prefix("scenario/") {
            Some(key) => problem["scenario"][key] = value.clone(),
            None => problem[key] = value.clone(),
        }
    }
    let path = folder.join("problem.json");
    IdentificationProblem::of(Document::parse(&problem.to_string(), path).unwrap()).unwrap()
}

fn power(coefficient: f64, exponent: f64) -> Value {
    json!({"kind": "power", "coefficient": coefficient, "exponent": exponent})
}

fn power_law() -> Value {
    json!([
        {"kind": "scalar", "pointer": "/laws/rough/coefficient", "bounds": [1e7, 1e10]},
        {"kind": "scalar", "pointer": "/laws/rough/exponent", "bounds": [0.1, 0.9]},
    ])
}

/// Numbers of pressures with the true stiffness inside its band and of informed ones.
fn coverage(found: &Identification) -> (usize, usize) {
    let law = &found.law;
    let informed: Vec<usize> = (0..law.pressure.len()).filter(|&i| law.informed[i]).collect();
    let inside = informed.iter().filter(|&&i| {
        let exact = TRUTH[0] * law.pressure[i].powf(TRUTH[1]);
        (law.lower[i]..=law.upper[i]).contains(&exact)
    });
    (inside.count(), informed.len())
}

/// Hits at two preloads: coefficient and exponent of the power law, with the truth inside the band. The model keeps six
/// of 24 modes.
#[test]
fn a_power_law_is_identified_from_hits_on_a_structure_of_matrices() {
    let (lattice, folder) = (Lattice::new(), tempfile::tempdir().unwrap());
    let more = json!({"unknowns": power_law(), "data": measured(&lattice, 1)});
    let problem = problem(&lattice, folder.path(), &power(2e8, 0.6), &more);
    let found = identify(&if is_long() { problem } else { problem.fast() }).unwrap();
    let (inside, informed) = coverage(&found);
    assert!(informed > 20 && inside == informed, "{inside} of {informed}: {:?}", found.fit.point);
    assert!(found.explains() && found.has_converged(), "{:?}", found.goodness);
    // A hundredth of the preload is half of one of the stiffness, which grows with its root.
    let load = found.given.iter().find(|one| one.pointer == "/loads/0/force_n").unwrap();
    assert!((-0.6..-0.3).contains(&load.sensitivity), "{load:?}");
    assert!(found.rigid_support.is_none() && found.explanations.is_empty());
    let numerical = found.feature_errors.iter().map(|one| one.deviations).fold(0.0, f64::max);
    assert!(numerical < 0.5 && found.hits.len() == 2 * peaks().len(), "{numerical}");
    let files: Vec<&str> = found.files.iter().map(|one| one.file.as_str()).collect();
    assert_eq!(files, ["a.sti", "a.mas", "a.dof", "cells.csv"]);
    if is_long() {
        assert_eq!(found.judgement().usability, Usability::Yes);
    }
}

/// A constant stiffness does not explain hits at two preloads.
#[test]
fn a_wrong_law_of_a_structure_is_of_no_use() {
    let (lattice, folder) = (Lattice::new(), tempfile::tempdir().unwrap());
    let unknowns = json!([{"kind": "scalar", "pointer": "/laws/rough/stiffness_pa_per_m", "bounds": [1e9, 1e12]}]);
    let law = json!({"kind": "constant", "stiffness_pa_per_m": 3e10});
    let more = json!({"unknowns": unknowns, "data": measured(&lattice, 2)});
    let found = identify(&problem(&lattice, folder.path(), &law, &more).fast()).unwrap();
    assert_eq!(found.judgement().usability, Usability::No);
    assert!(!found.explains());
}

/// Numbers of the reduction are no parameters, and features are read at every sensor.
#[test]
fn parameters_of_a_structure_leave_its_reduction() {
    let (lattice, folder) = (Lattice::new(), tempfile::tempdir().unwrap());
    let data = |feature: &str| {
        let measured = json!({"value": 1.0, "standard_deviation": 1.0});
        json!([{"kind": "hits", "hits": [{"features": {feature: measured}}]}])
    };
    let modes =
        json!([{"kind": "scalar", "pointer": "/bodies/0/reduction/modes", "bounds": [2, 9]}]);
    let more = json!({"unknowns": modes, "data": data("fundamental.frequency_hz")});
    let words = |more: &Value| {
        let problem = problem(&lattice, folder.path(), &power(2e8, 0.5), more);
        identify(&problem.fast()).unwrap_err().to_string()
    };
    let found = words(&more);
    assert!(found.contains("/bodies/0/reduction/modes") && found.contains("setting"), "{found}");
    let more = json!({"unknowns": power_law(), "data": data("tip:fundamental.frequency_hz")});
    let found = words(&more);
    assert!(found.contains("tip:fundamental.frequency_hz"), "{found}");
    // Two parameters from one observation, so that the feature itself is known.
    let more = json!({"unknowns": power_law(), "data": data("corner:fundamental.frequency_hz")});
    let found = words(&more);
    assert!(found.contains("1 observations"), "{found}");
}

/// A hit as a record in two formats, as its receptance and as its analysis: each gives back the law within what it
/// measures. The saved scenario finds its files from its own folder.
#[test]
fn every_kind_of_data_gives_back_the_law_of_a_structure() {
    let (lattice, folder) = (Lattice::new(), tempfile::tempdir().unwrap());
    let (forces, motion) = lattice.motion(TRUTH, PRELOADS[0], 12.0, 0.08);
    let before = 600;
    let mut text = String::from("time_s,hammer (N),top (m)\n");
    let silence = std::iter::repeat_n((0.0, 0.0), before);
    let samples = silence.chain(forces.iter().copied().zip(motion.iter().copied()));
    for (sample, (force, motion)) in samples.enumerate() {
        writeln!(text, "{:.7},{force:.9e},{motion:.9e}", sample as f64 / RATE_HZ).unwrap();
    }
    fs::write(folder.path().join("hit.csv"), text).unwrap();
    let read =
        asperity_measure::read(&folder.path().join("hit.csv"), &ReadOptions::default()).unwrap();
    let universal = folder.path().join("hit.uff");
    asperity_measure::write(
        &universal,
        &read.records,
        Format::UniversalBinary,
        &WriteOptions::default(),
    )
    .unwrap();
    let analysed = AnalysisOptions {
        responses: ResponseChoice::of(&["top".into()]),
        band_hz: Some(FrequencyBand { low_hz: 300.0, high_hz: 1500.0 }),
        ..AnalysisOptions::default()
    };
    let analysis = analyse(&[universal], &analysed).unwrap();
    let analysis = serde_json::to_value(&analysis.responses[0].report).unwrap();
    let frequencies: Vec<f64> = (0..40).map(|i| 500.0 + 20.0 * f64::from(i)).collect();
    let lines: Vec<[f64; 2]> =
        frequencies.iter().map(|&f| Lattice::receptance(&forces, &motion, f)).collect();
    let parts = [0, 1].map(|part| lines.iter().map(|line| line[part]).collect::<Vec<f64>>());
    let table =
        json!({"frequency_hz": frequencies, "real_m_per_n": parts[0], "imag_m_per_n": parts[1]});
    let spread = json!({"relative": 2e-3});
    let floor = json!({"fundamental.frequency_hz": {"relative": 3e-4}, "fundamental.receptance_m_per_n": {"relative": 5e-3},
                       "harmonic_ratio": {"relative": 2e-2}});
    let kinds = [
        json!({"kind": "records", "files": ["hit.csv"], "response": "top", "band_hz": [500, 1300], "spread": spread}),
        json!({"kind": "records", "files": ["hit.uff"], "response": "top", "band_hz": [500, 1300], "spread": spread}),
        json!({"kind": "frf", "file": table, "hit": {"force_peak_n": 12}, "band_hz": [500, 1300], "spread": spread}),
        json!({"kind": "analysis", "file": analysis, "floor": floor}),
    ];
    let unknown = json!([{"kind": "scalar", "pointer": "/laws/rough/coefficient", "bounds": [6e7, 2.5e8], "start": 1.35e8}]);
    for data in kinds {
        let more = json!({"unknowns": unknown, "data": [data], "scenario/duration_s": 0.08});
        let problem = problem(&lattice, folder.path(), &power(2e8, TRUTH[1]), &more).fast();
        let found = identify(&problem).unwrap();
        let off = found.fit.point[0] / TRUTH[0] - 1.0;
        assert!(off.abs() < 1e-3 && found.explains(), "{}: {off:e}", data["kind"]);
        let saved = found.scenario_json(&problem).unwrap();
        let elsewhere = tempfile::tempdir().unwrap();
        let saved =
            Document::parse(&saved.to_string(), elsewhere.path().join("scenario.json")).unwrap();
        let scenario = saved.structure_scenario().unwrap();
        assemble_patches(&scenario, saved.folder()).unwrap();
    }
}

/// A law as a table of four points, and one without an assumed form, carried to their ends with the data of the power
/// law: the truth is inside the bands. A long test.
#[test]
fn tables_and_free_laws_of_a_structure_are_identified() {
    if !is_long() {
        eprintln!("skipped: ASPERITY_LONG is not set");
        return;
    }
    let (lattice, folder) = (Lattice::new(), tempfile::tempdir().unwrap());
    let stiffness = |pressure: f64| 0.8 * TRUTH[0] * pressure.powf(TRUTH[1]);
    let pressures = [3e4, 8e4, 1.6e5, 3.2e5];
    let points: Vec<[f64; 2]> = pressures.iter().map(|&p| [p, stiffness(p)]).collect();
    let table = json!({"kind": "table", "points": points});
    let cases = [
        (table, json!([{"kind": "monotone_law", "law": "rough"}])),
        (power(1e8, 0.5), json!([{"kind": "free_law", "law": "rough", "points": 10}])),
    ];
    for (law, unknowns) in cases {
        let more = json!({"unknowns": unknowns, "data": measured(&lattice, 1)});
        let found = identify(&problem(&lattice, folder.path(), &law, &more).fast()).unwrap();
        let (inside, informed) = coverage(&found);
        assert!(informed > 5 && inside == informed, "{inside} of {informed}");
        // Whether the sampler has converged is another matter: 100 draws are few for four parameters.
        assert!(found.explains(), "{:?}", found.goodness);
    }
}
