//! One transient run.

use asperity_study::error::StudyError;
use asperity_study::record::{frf_columns, history_columns};
use asperity_study::run::{receptance, simulate_with_progress};
use asperity_study::summary::Summary;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::scenario::PyScenario;
use crate::{background, columns, exception, json};

/// Columns by their names.
type Columns = Vec<(String, Vec<f64>)>;

/// Summary, history and, for a run with force, FRF of one run.
fn computed(
    scenario: &PyScenario,
    progress: &background::Progress,
) -> Result<(Summary, Columns, Option<Columns>), StudyError> {
    let run = simulate_with_progress(&scenario.document, &scenario.scenario, &|fraction| {
        progress.report(fraction);
    })?;
    let names: Vec<&str> =
        scenario.scenario.interfaces.iter().map(|face| face.name.as_str()).collect();
    let history = history_columns(&run.transient.history, &names);
    let history = history.into_iter().map(|(name, values)| (name, values.to_vec())).collect();
    let frf = receptance(&run)?.map(|frf| {
        frf_columns(&frf).into_iter().map(|(name, values)| (name.to_owned(), values)).collect()
    });
    Ok((run.summary, history, frf))
}

/// Summary as a dict, history and FRF as dicts of arrays.
#[pyfunction]
#[pyo3(signature = (scenario, progress))]
#[expect(clippy::type_complexity, reason = "a tuple of dicts")]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>, Option<Bound<'py, PyDict>>)> {
    let scenario = PyScenario::of(scenario, None)?;
    let outcome = background::run(py, progress, move |progress| computed(&scenario, progress))?;
    let (summary, history, frf) = outcome.map_err(|error| exception::of_study(py, &error))?;
    let frf = frf.map(|frf| columns::to_dict(py, frf)).transpose()?;
    Ok((json::to_python(py, &summary)?, columns::to_dict(py, history)?, frf))
}
