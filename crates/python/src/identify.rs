//! Identification of laws from measurements.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use asperity_figure::Figure;
use asperity_identify::{IdentificationError, IdentificationProblem, Work, identify as identified};
use asperity_plot::identification;
use asperity_table::DataTable;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

use crate::background::Watched;
use crate::{background, columns, exception, figure, json};

/// An identification under way.
struct Identification {
    work: Arc<Work>,
    /// Bits of the largest share so far: a part that needs more than was expected lowers the share.
    share: AtomicU64,
    done: AtomicBool,
}

impl Watched for Identification {
    fn fraction(&self) -> f64 {
        if self.done.load(Ordering::Relaxed) {
            return 1.0;
        }
        let share = self.work.progress().map_or(0.0, |progress| progress.share.clamp(0.0, 1.0));
        // Bits of numbers that are not negative are in their order.
        let before = self.share.fetch_max(share.to_bits(), Ordering::Relaxed);
        share.max(f64::from_bits(before))
    }

    fn stop(&self) {
        self.work.stop();
    }
}

/// Documents and tables of a finished identification.
struct Found {
    report: Value,
    law: Option<Value>,
    scenario: Value,
    draws: Value,
    tables: [(&'static str, DataTable); 3],
    figures: Vec<(&'static str, Figure)>,
}

impl Found {
    fn of(problem: &IdentificationProblem) -> Result<Self, IdentificationError> {
        let found = identified(problem)?;
        Ok(Self {
            report: found.report(problem),
            law: found.law_json(),
            scenario: found.scenario_json(problem)?,
            draws: found.draws_json(problem)?,
            tables: [
                ("law_band", found.law_table()),
                ("data", found.data_table()),
                ("posterior", found.posterior_table()),
            ],
            figures: identification(&found),
        })
    }
}

/// Documents and tables of an identification, as a dict.
#[pyfunction]
#[pyo3(signature = (problem, folder, progress, fast))]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    problem: &Bound<'py, PyAny>,
    folder: Option<PathBuf>,
    progress: Option<&Bound<'py, PyAny>>,
    fast: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let accepted = "a path, JSON text or a dict";
    let document = json::document_of(problem, folder, "problem", accepted)?;
    let problem = py
        .detach(|| IdentificationProblem::of(document))
        .map_err(|error| exception::of_identification(py, &error))?;
    let problem = if fast { problem.fast() } else { problem };
    let watched = Arc::new(Identification {
        work: Arc::clone(problem.work()),
        share: AtomicU64::new(0),
        done: AtomicBool::new(false),
    });
    let found = background::run_watched(py, progress, watched, move |watched| {
        let found = Found::of(&problem);
        watched.done.store(true, Ordering::Relaxed);
        found
    })?;
    let found = found.map_err(|error| exception::of_identification(py, &error))?;
    let dict = PyDict::new(py);
    dict.set_item("report", json::to_python(py, &found.report)?)?;
    dict.set_item("law", json::to_python(py, &found.law)?)?;
    dict.set_item("scenario", json::to_python(py, &found.scenario)?)?;
    dict.set_item("draws", json::to_python(py, &found.draws)?)?;
    dict.set_item("figures", figure::by_name(py, found.figures)?)?;
    for (name, table) in found.tables {
        dict.set_item(name, columns::of_table(py, table)?)?;
    }
    Ok(dict)
}
