//! Answers of studies against models whose answers are known, through the same files.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use asperity_study::{
    AnswerOptions, RowModel, RowResult, StudyAnswers, StudyFolder, StudyPlan, answers, run,
};
use serde_json::{Value, json};

use crate::support::{options, plan};

/// Ishigami's function of the three inputs, and a number that does not vary; fails for some rows.
struct Ishigami {
    columns: Vec<String>,
    fails_above: f64,
}

impl RowModel for Ishigami {
    fn columns(&self) -> &[String] {
        &self.columns
    }

    fn run(&self, rows: &[Vec<Value>], _stop: &AtomicBool) -> Option<Vec<RowResult>> {
        let result = |row: &Vec<Value>| {
            let x: Vec<f64> = row.iter().map(|value| value.as_f64().unwrap()).collect();
            if x[2] > self.fails_above {
                return Err("no equilibrium".to_owned());
            }
            let y = x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin();
            Ok((vec![y, 1.0], Vec::new()))
        };
        Some(rows.iter().map(result).collect())
    }
}

fn ishigami(design: &Value) -> StudyPlan {
    let input = |pointer: &str| {
        json!({"pointer": pointer,
               "distribution": {"kind": "uniform", "lower": -PI, "upper": PI}})
    };
    let text = json!({
        "schema": "asperity/study/1",
        "scenario": "block.json",
        "inputs": [input("/excitation/peak_n"), input("/duration_s"), input("/damping/ratio")],
        "design": design,
        "chunk_rows": 1000
    });
    plan(&text).unwrap()
}

fn answers_of(plan: &StudyPlan, fails_above: f64) -> StudyAnswers {
    let folder = tempfile::tempdir().unwrap();
    let model = Ishigami { columns: vec!["y".into(), "one".into()], fails_above };
    let never = AtomicBool::new(false);
    run(plan, &model, &options(folder.path()), &never, &|_, _| ()).unwrap();
    let asked = AnswerOptions { thresholds: vec![("y".into(), 7.0)], ..AnswerOptions::default() };
    answers(plan, &StudyFolder::open(folder.path()).unwrap(), &asked).unwrap()
}

#[test]
fn indices_of_ishigami_are_found_from_the_table_of_a_study() {
    let found = answers_of(&ishigami(&json!({"kind": "saltelli", "base_rows": 2048})), 10.0);
    assert_eq!((found.runs, found.failed), (2048 * 5, 0));
    let indices = found.observables[0].indices.as_ref().unwrap();
    for (estimates, truth) in [
        (&indices.first, [0.313_905, 0.442_411, 0.0]),
        (&indices.total, [0.557_589, 0.442_411, 0.243_684]),
    ] {
        for (estimate, truth) in estimates.iter().zip(truth) {
            assert!(estimate.holds(truth) && (estimate.value - truth).abs() < 0.02, "{estimate:?}");
        }
    }
    assert!(found.observables[1].indices.is_none(), "a constant has no indices");
    assert_eq!(found.observables[1].mean, Some(1.0));
}

#[test]
fn quantiles_and_exceedances_agree_with_a_fine_random_sample() {
    let fine = answers_of(&ishigami(&json!({"kind": "random", "rows": 200_000})), 10.0);
    let coarse = answers_of(&ishigami(&json!({"kind": "sobol", "rows": 4096})), 10.0);
    let (fine, coarse) = (&fine.observables[0], &coarse.observables[0]);
    for ((_, truth), (p, quantile)) in fine.quantiles.iter().zip(&coarse.quantiles) {
        assert!(quantile.holds(truth.value), "{p}: {quantile:?} for {truth:?}");
    }
    let [(_, truth), (_, found)] = [fine.exceedances[0], coarse.exceedances[0]];
    assert!(found.holds(truth.value) && truth.value > 0.05, "{found:?} for {truth:?}");
    assert!((fine.mean.unwrap() - 3.5).abs() < 0.04);
}

#[test]
fn failures_are_counted_with_their_reasons() {
    let found = answers_of(&ishigami(&json!({"kind": "grid", "levels": [4, 4, 4]})), 1.5);
    assert_eq!((found.runs, found.failed), (64, 16));
    assert_eq!(found.reasons["no equilibrium"], 16);
    assert_eq!(found.observables[0].missing, 16);
    let found = answers_of(&ishigami(&json!({"kind": "grid", "levels": [2, 2, 2]})), -9.0);
    assert_eq!((found.failed, found.observables[0].mean), (8, None));
}
