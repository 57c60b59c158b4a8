//! One transient run.

use asperity_figure::Figure;
use asperity_plot::MagnitudeAxis;
use asperity_simulation::error::SimulationError;
use asperity_simulation::record::{frf_columns, history_columns};
use asperity_simulation::run::{receptance, simulate_with_progress};
use asperity_simulation::summary::Summary;
use asperity_simulation::warning::Warning;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::figure::PyFigure;
use crate::scenario::PyScenario;
use crate::{background, columns, exception, json};

/// Columns by their names, and the figure that the command draws of them.
type Drawn = (Vec<(String, Vec<f64>)>, Figure);

/// Summary, history and, for a run with force, FRF of one run.
fn computed(
    scenario: &PyScenario,
    progress: &background::Progress,
) -> Result<(Summary, Drawn, Option<Drawn>), SimulationError> {
    let run = simulate_with_progress(&scenario.document, &scenario.scenario, &|fraction| {
        progress.report(fraction);
    })?;
    let figure = asperity_plot::history(&run);
    let columns = history_columns(&run).into_iter();
    let columns = columns.map(|(name, values)| (name, values.into_owned())).collect();
    let frf = receptance(&run, 0)?.zip(frf_columns(&run)?).map(|(frf, columns)| {
        (columns, asperity_plot::frf(&frf, &run.summary, MagnitudeAxis::default()))
    });
    Ok((run.summary, (columns, figure), frf))
}

/// Dict of arrays, and figure.
type Shown<'py> = (Bound<'py, PyDict>, PyFigure);

/// Kinds of warnings and their texts.
pub(crate) fn in_words<'a>(
    warnings: impl IntoIterator<Item = &'a Warning>,
) -> Vec<(&'static str, String)> {
    warnings.into_iter().map(|warning| (warning.kind(), warning.to_string())).collect()
}

/// Results of one run for Python: summary, history, FRF, and warnings.
type Simulated<'py> =
    (Bound<'py, PyAny>, Shown<'py>, Option<Shown<'py>>, Vec<(&'static str, String)>);

/// Summary as a dict, history and FRF as dicts of arrays with their figures, and the warnings.
#[pyfunction]
#[pyo3(signature = (scenario, progress))]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Simulated<'py>> {
    let scenario = PyScenario::of(scenario, None)?;
    let outcome = background::run(py, progress, move |progress| computed(&scenario, progress))?;
    let (summary, history, frf) = outcome.map_err(|error| exception::of_study(py, &error))?;
    let shown = |(columns, figure): Drawn| -> PyResult<Shown<'py>> {
        Ok((columns::to_dict(py, columns)?, PyFigure::from(figure)))
    };
    let warnings = in_words(&summary.warnings);
    let frf = frf.map(shown).transpose()?;
    Ok((json::to_python(py, &summary)?, shown(history)?, frf, warnings))
}
