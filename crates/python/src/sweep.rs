//! Many runs of one scenario.

use asperity_scenario::Document;
use asperity_simulation::error::SimulationError;
use asperity_simulation::row_simulator::RowSimulator;
use asperity_simulation::sweep::{
    Sweep, SweepError, Variation, VariationError, on_threads, sweep_with_progress,
};
use asperity_simulation::warning::Warning;
use asperity_table::{ColumnData, DataTable};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use serde_json::Value;

use crate::figure::PyFigure;
use crate::scenario::PyScenario;
use crate::{background, columns, exception};

/// Rows that are begun before the next report of progress.
const ROWS_A_REPORT: usize = 512;

/// A place and its values: JSON texts, or the text of `--vary`.
type Varied<'py> = (String, Bound<'py, PyAny>);

/// Columns of the product of the variations, and its figure.
#[pyfunction]
#[pyo3(signature = (scenario, vary, threads, progress))]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
    vary: Vec<Varied<'py>>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, Option<PyFigure>)> {
    let scenario = PyScenario::of(scenario, None)?;
    let variations = vary.into_iter().map(variation).collect::<PyResult<Vec<_>>>()?;
    let count = variations.len();
    let work = move |progress: &background::Progress| {
        let report = |done: usize, all: usize| progress.report(done as f64 / all.max(1) as f64);
        let work = || sweep_with_progress(&scenario.document, &variations, &report);
        let tabulated = |found: Sweep| (found.table(), asperity_plot::sweep(&found));
        on_threads(threads, work).map(|found| found.map(tabulated))
    };
    let found =
        background::run(py, progress, work)?.ok_or_else(|| exception::no_threads(threads))?;
    let (table, figure) = found.map_err(|error| of_sweep(py, &error))?;
    Ok((columns::of_table(py, with_numbers(table, count))?, figure.map(PyFigure::from)))
}

/// Columns of runs for rows of values.
#[pyfunction]
#[pyo3(signature = (scenario, rows, threads, progress))]
pub(crate) fn sweep_rows<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, PyAny>,
    rows: Vec<(String, Vec<String>)>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let scenario = PyScenario::of(scenario, None)?;
    let count = rows.len();
    let work = move |progress: &background::Progress| {
        on_threads(threads, || run_rows(scenario.document, rows, progress))
    };
    let found =
        background::run(py, progress, work)?.ok_or_else(|| exception::no_threads(threads))?;
    let table = found.map_err(|error| exception::of_study(py, &error))?;
    columns::of_table(py, with_numbers(table, count))
}

/// The table of the runs of rows, as that of a sweep.
fn run_rows(
    document: Document,
    inputs: Vec<(String, Vec<String>)>,
    progress: &background::Progress,
) -> Result<DataTable, SimulationError> {
    let places = inputs.iter().map(|(pointer, _)| vec![pointer.clone()]).collect();
    let simulator = RowSimulator::new(document, places)?;
    let value =
        |text: &String| serde_json::from_str(text).unwrap_or_else(|_| Value::from(text.as_str()));
    let count = inputs.first().map_or(0, |(_, values)| values.len());
    let rows: Vec<Vec<Value>> = (0..count)
        .map(|row| inputs.iter().map(|(_, values)| value(&values[row])).collect())
        .collect();
    let names = simulator.columns();
    let mut numbers = vec![Vec::with_capacity(count); names.len()];
    let (mut errors, mut warnings) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for part in rows.chunks(ROWS_A_REPORT) {
        for outcome in simulator.run(part) {
            let found = outcome.as_ref().ok();
            for (at, column) in numbers.iter_mut().enumerate() {
                column.push(found.and_then(|row| row.values.get(at)).map_or(f64::NAN, |x| *x));
            }
            let mut kinds: Vec<&str> =
                found.iter().flat_map(|row| &row.warnings).map(Warning::kind).collect();
            kinds.dedup();
            warnings.push(kinds.join(" "));
            errors.push(outcome.err().map(|error| error.to_string()).unwrap_or_default());
        }
        progress.report(errors.len() as f64 / count as f64);
    }
    let names = names.to_vec();
    let mut table = inputs
        .into_iter()
        .fold(DataTable::new(), |table, (pointer, values)| table.with(pointer, values));
    for (name, values) in names.into_iter().zip(numbers) {
        table = table.with(name, values);
    }
    Ok(table.with("error", errors).with("warnings", warnings))
}

/// The table with those of the first `count` columns as numbers whose texts all are.
fn with_numbers(table: DataTable, count: usize) -> DataTable {
    let columns = table.into_columns().into_iter().enumerate();
    columns.fold(DataTable::new(), |table, (at, (name, data))| match data {
        ColumnData::Texts(texts) if at < count => {
            let numbers: Option<Vec<f64>> =
                texts.iter().map(|text| serde_json::from_str(text).ok()).collect();
            match numbers {
                Some(numbers) => table.with(name, numbers),
                None => table.with(name, texts),
            }
        }
        data => table.with(name, data),
    })
}

fn variation((pointer, values): Varied<'_>) -> PyResult<Variation> {
    let wrong = |error: VariationError| PyValueError::new_err(error.to_string());
    if let Ok(text) = values.cast::<PyString>() {
        return Variation::parse(&format!("{pointer}={}", text.to_cow()?)).map_err(wrong);
    }
    let values: Vec<String> = values.extract()?;
    if values.is_empty() {
        return Err(PyValueError::new_err(format!("{pointer}: no values")));
    }
    Ok(Variation { pointer, values })
}

fn of_sweep(py: Python<'_>, error: &SweepError) -> PyErr {
    let message = error.to_string();
    match error {
        SweepError::Set { source, .. } => exception::of_set(py, message, source),
        SweepError::Invalid { source, .. } => exception::of_faults(py, message, source),
        _ => PyValueError::new_err(message),
    }
}
