//! Studies over designs.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc;

use asperity_figure::Figure;
use asperity_simulation::sweep::on_threads;
use asperity_study::{
    AnswerOptions, RunOptions, Shard, StudyAnswers, StudyError, StudyFolder, StudyPlan, answers,
};
use asperity_table::DataTable;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;

use crate::background::Watched;
use crate::{background, columns, exception, figure, json};

/// A study under way.
#[derive(Default)]
struct Study {
    /// Bits of the fraction.
    fraction: AtomicU64,
    stop: AtomicBool,
}

impl Watched for Study {
    fn fraction(&self) -> f64 {
        f64::from_bits(self.fraction.load(Ordering::Relaxed))
    }

    fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// Tables of a finished study with its answers.
struct Found {
    results: DataTable,
    answers: StudyAnswers,
    document: Value,
    figures: Vec<(&'static str, Figure)>,
}

impl Found {
    /// Runs the study in its folder, as far as it is not asked to stop, which is no error: nobody
    /// receives the results then.
    fn of(
        plan: &StudyPlan,
        run: &RunOptions<'_>,
        options: &AnswerOptions,
        watched: &Study,
    ) -> Result<Self, StudyError> {
        let simulator = plan.simulator()?;
        asperity_study::run(plan, &simulator, run, &watched.stop, &|done, all| {
            let fraction = done as f64 / all.max(1) as f64;
            watched.fraction.store(fraction.to_bits(), Ordering::Relaxed);
        })?;
        let folder = StudyFolder::open(run.folder)?;
        let answers = answers(plan, &folder, options)?;
        let inputs = plan.coordinates();
        Ok(Self {
            results: folder.results()?,
            document: answers.to_json(&inputs),
            figures: asperity_plot::answers(&answers, &inputs),
            answers,
        })
    }
}

/// Tables and answers of a study, as a dict.
#[pyfunction]
#[pyo3(signature = (study, folder, out, resume, level, probabilities, exceed, threads, progress))]
#[allow(clippy::too_many_arguments, reason = "the options of the function in Python")]
pub(crate) fn study<'py>(
    py: Python<'py>,
    study: &Bound<'py, PyAny>,
    folder: Option<PathBuf>,
    out: Option<PathBuf>,
    resume: bool,
    level: f64,
    probabilities: Vec<f64>,
    exceed: Vec<(String, f64)>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let document = json::document_of(study, folder, "study", "a path, JSON text or a dict")?;
    let plan =
        py.detach(|| StudyPlan::of(document)).map_err(|error| exception::of_design(py, &error))?;
    // Kept until the work ends.
    let own = match &out {
        Some(_) => None,
        None => Some(tempfile::tempdir().map_err(PyOSError::new_err)?),
    };
    let options = AnswerOptions { level, probabilities, thresholds: exceed };
    // Without a sender from the end of the work on.
    let (working, ended) = mpsc::channel::<()>();
    let found = background::run_watched(py, progress, Arc::new(Study::default()), move |watched| {
        let _working = working;
        let folder = own.as_ref().map(tempfile::TempDir::path).or(out.as_deref());
        let folder = folder.unwrap_or(".".as_ref());
        let run = RunOptions { folder, resume, shard: Shard::WHOLE };
        on_threads(threads, || Found::of(&plan, &run, &options, watched))
    });
    if found.is_err() {
        // The folder is left alone before the caller has it again.
        let _ = py.detach(move || ended.recv());
    }
    let found = found?;
    let found = found.ok_or_else(|| exception::no_threads(threads))?;
    let found = found.map_err(|error| exception::of_design(py, &error))?;
    let dict = PyDict::new(py);
    let tables = [
        ("histograms", found.answers.histograms()),
        ("exceedance", found.answers.exceedance()),
        ("results", found.results),
    ];
    for (name, table) in tables {
        dict.set_item(name, columns::of_table(py, table)?)?;
    }
    let frf = found.answers.frf.as_ref().map(|frf| columns::of_table(py, frf.table()));
    dict.set_item("frf", frf.transpose()?)?;
    dict.set_item("answers", json::to_python(py, &found.document)?)?;
    dict.set_item("figures", figure::by_name(py, found.figures)?)?;
    Ok(dict)
}
