//! Receptances of the runs of a study, and their bands.

use std::sync::atomic::AtomicBool;

use asperity_scenario::Document;
use asperity_simulation::quantity::frf_name;
use asperity_simulation::run::{receptance, simulate};
use asperity_study::{AnswerOptions, FrfBand, StudyFolder, answers, run};
use serde_json::{Value, json};

use crate::support::{options, plan, study};

/// Columns of a study have the magnitudes of the receptance of each run by itself, by both engines.
#[test]
fn columns_are_the_receptance_of_each_run() {
    let damped = "../simulation/examples/block.json";
    for method in [
        json!({"kind": "modal", "step_s": 1e-5}),
        json!({"kind": "finite_difference", "cell_m": 0.005}),
    ] {
        let mut scenario = Document::read(damped).unwrap().value().clone();
        scenario["method"] = method.clone();
        let mut text = study(&json!({"kind": "sobol", "rows": 4, "seed": 2}), 2);
        text["scenario"] = scenario.clone();
        text["frf"] = json!({"start_hz": 200, "stop_hz": 2200, "count": 41});
        let plan = plan(&text).unwrap();
        let rows = plan.values(0..4).unwrap();
        let simulator = plan.simulator().unwrap();
        assert!(simulator.columns().ends_with(&[frf_name(2150.0), frf_name(2200.0)]));
        for (row, found) in rows.iter().zip(simulator.run(&rows)) {
            scenario["excitation"]["peak_n"] = row[0].clone();
            let document = Document::parse(&scenario.to_string(), damped).unwrap();
            let alone = simulate(&document, &document.scenario().unwrap()).unwrap();
            let frf = receptance(&alone, 0).unwrap().unwrap();
            let found = found.unwrap().frf;
            assert_eq!(found.len(), 41);
            let magnitude = frf.magnitude();
            let highest = magnitude.iter().copied().fold(0.0, f64::max);
            for (i, found) in found.iter().enumerate() {
                let frequency = 200.0 + 50.0 * i as f64;
                // Between the lines of the spectrum, which are dense enough for a straight line.
                let above = frf.frequency_hz.partition_point(|&line| line < frequency);
                let [a, b] = [above - 1, above].map(|at| (frf.frequency_hz[at], magnitude[at]));
                let exact = a.1 + (b.1 - a.1) * (frequency - a.0) / (b.0 - a.0);
                let off = (found - exact).abs() / highest;
                assert!(off < 2e-3, "{method} at {frequency} Hz: {found} for {exact}");
            }
        }
    }
}

/// The band at each frequency is that of the column, and lines are no observables by themselves.
#[test]
fn bands_are_quantiles_of_the_columns() {
    let mut text = study(&json!({"kind": "latin_hypercube", "rows": 40, "seed": 5}), 16);
    text["frf"] = json!({"start_hz": 500, "stop_hz": 900, "count": 5});
    let plan = plan(&text).unwrap();
    let simulator = plan.simulator().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let never = AtomicBool::new(false);
    run(&plan, &simulator, &options(folder.path()), &never, &|_, _| ()).unwrap();
    let study = StudyFolder::open(folder.path()).unwrap();
    let name = frf_name(700.0);
    let asked = AnswerOptions { thresholds: vec![(name.clone(), 0.0)], ..AnswerOptions::default() };
    let found = answers(&plan, &study, &asked).unwrap();
    let band = found.frf.as_ref().unwrap();
    assert_eq!(band.frequency_hz, [500.0, 600.0, 700.0, 800.0, 900.0]);
    assert_eq!(band.runs, [40; 5]);
    // The one that a threshold names is an observable too.
    let lines: Vec<_> =
        found.observables.iter().filter(|one| one.name.starts_with("frf")).collect();
    assert_eq!((lines.len(), lines[0].name.as_str(), lines[0].unit()), (1, name.as_str(), "m/N"));
    assert_eq!(lines[0].exceedances[0].1.value, 1.0);
    let rows = plan.values(0..40).unwrap();
    let mut values: Vec<f64> =
        simulator.run(&rows).into_iter().map(|row| row.unwrap().frf[2]).collect();
    values.sort_by(f64::total_cmp);
    for (probability, found) in FrfBand::PROBABILITIES.into_iter().zip(band.quantiles[2]) {
        // Values stand at the middles of their weights.
        let place = (40.0 * probability - 0.5_f64).clamp(0.0, 39.0);
        let (below, above) = (values[place as usize], values[(place as usize + 1).min(39)]);
        let exact = below + (above - below) * place.fract();
        assert!((found / exact - 1.0).abs() < 1e-12, "{probability}: {found} for {exact}");
    }
    let csv = band.table().to_csv();
    assert!(csv.starts_with("frequency_hz,runs,median_m_per_n,lower_m_per_n,"), "{csv}");
    assert_eq!(csv.lines().count(), 6);
    assert!(found.to_json(&[])["frf"]["receptance_m_per_n"][4][2].is_f64());
}

#[test]
fn wrong_lines_are_refused() {
    let refused = |frf: Value| {
        let mut text = study(&json!({"kind": "sobol", "rows": 4}), 4);
        text["frf"] = frf;
        plan(&text).unwrap_err().to_string()
    };
    let order = refused(json!({"start_hz": 900, "stop_hz": 500, "count": 5}));
    assert!(order.contains("/frf/stop_hz: is 500; accepted: above start_hz, 900"), "{order}");
    refused(json!({"start_hz": 0, "stop_hz": 500, "count": 5}));
    refused(json!({"start_hz": 1, "stop_hz": 500, "count": 1}));
}
