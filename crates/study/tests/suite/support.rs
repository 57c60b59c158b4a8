//! Small studies and a cheap model.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use asperity_scenario::Document;
use asperity_study::{
    RowModel, RowResult, RunOptions, Shard, StudyError, StudyOutcome, StudyPlan, run,
};
use serde_json::{Value, json};

/// Folder whose `block.json` is the scenario of the studies.
const EXAMPLES: &str = "../simulation/examples/study.json";

/// A study of the example's scenario with two inputs.
pub(crate) fn study(design: &Value, chunk_rows: u64) -> Value {
    json!({
        "schema": "asperity/study/1",
        "scenario": "block.json",
        "inputs": [
            {"pointer": "/excitation/peak_n",
             "distribution": {"kind": "uniform", "lower": 2, "upper": 14}},
            {"pointer": "/title", "name": "case",
             "distribution": {"kind": "choice", "values": ["a, b", "=c"], "weights": [3, 1]}}
        ],
        "design": design,
        "chunk_rows": chunk_rows
    })
}

pub(crate) fn plan(study: &Value) -> Result<StudyPlan, StudyError> {
    StudyPlan::of(Document::parse(&study.to_string(), EXAMPLES).unwrap())
}

/// The square of the first input; none for some rows, a failure for others. Sets a flag after some
/// rows.
pub(crate) struct Square {
    pub(crate) columns: Vec<String>,
    pub(crate) rows: AtomicU64,
    pub(crate) stop: AtomicBool,
    pub(crate) stop_after: u64,
    /// Drops the chunk in which it sets the flag.
    pub(crate) drops: bool,
}

impl Square {
    pub(crate) fn new(stop_after: u64) -> Self {
        Self {
            columns: vec!["square".into()],
            rows: AtomicU64::new(0),
            stop: AtomicBool::new(false),
            stop_after,
            drops: false,
        }
    }
}

impl RowModel for Square {
    fn columns(&self) -> &[String] {
        &self.columns
    }

    fn run(&self, rows: &[Vec<Value>], _stop: &AtomicBool) -> Option<Vec<RowResult>> {
        let count = rows.len() as u64;
        if self.rows.load(Ordering::Relaxed) + count >= self.stop_after {
            self.stop.store(true, Ordering::Relaxed);
            if self.drops {
                return None;
            }
        }
        self.rows.fetch_add(count, Ordering::Relaxed);
        let result = |row: &Vec<Value>| {
            let x = row[0].as_f64().unwrap();
            match x {
                x if x > 13.5 => Err("too large, \"by\" far\nindeed".to_owned()),
                x if x < 2.5 => Ok((vec![f64::NAN], vec!["small"])),
                x => Ok((vec![x * x], Vec::new())),
            }
        };
        Some(rows.iter().map(result).collect())
    }
}

pub(crate) fn options(folder: &Path) -> RunOptions<'_> {
    RunOptions { folder, resume: false, shard: Shard::WHOLE }
}

/// Runs a study with [`Square`], uninterrupted, and returns its table.
pub(crate) fn table(plan: &StudyPlan) -> String {
    let folder = tempfile::tempdir().unwrap();
    let model = Square::new(u64::MAX);
    let outcome = run(plan, &model, &options(folder.path()), &model.stop, &|_, _| ()).unwrap();
    let StudyOutcome::Complete(table) = outcome else { panic!("{outcome:?}") };
    std::fs::read_to_string(table).unwrap()
}
