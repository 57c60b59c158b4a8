//! Runs of one scenario for rows of given values, such as those of a design.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity_scenario::Document;
use serde_json::Value;

use crate::error::SimulationError;
use crate::observables::Observables;
use crate::quantity::frf_name;
pub use crate::row_inputs::Places;
use crate::row_runner::RowRunner;

/// Runs one scenario with rows of values, each checked as a whole.
///
/// A row's result depends on its own values alone, not on other rows, threads, or vector lanes. Its errors are
/// estimated for a structure near its own, which rows close to it share.
///
/// ```
/// # use asperity_scenario::Document;
/// use asperity_simulation::row_simulator::RowSimulator;
/// use serde_json::json;
///
/// let document = Document::read("examples/block.json")?;
/// let places = vec![vec!["/excitation/peak_n".to_owned()]];
/// let simulator = RowSimulator::new(document, places)?;
/// let column = simulator.columns().iter().position(|name| name == "fundamental.frequency_hz");
/// let found = simulator.run(&[vec![json!(2.0)], vec![json!(14.0)], vec![json!("loud")]]);
/// let [f1_at_2, f1_at_14] =
///     [0, 1].map(|row| found[row].as_ref().unwrap().values[column.unwrap()]);
/// assert!(f1_at_14 < f1_at_2, "the contact softens with the force");
/// assert!(found[2].is_err(), "a force without a number is an error of its row");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct RowSimulator {
    runner: RowRunner,
    names: Arc<[String]>,
    columns: Vec<String>,
}

impl RowSimulator {
    /// A simulator of the valid scenario of `document`; the numbers of a row go to `places`, in their
    /// order.
    ///
    /// # Errors
    /// [`SimulationError`] when the scenario itself cannot be set up.
    pub fn new(document: Document, places: Vec<Places>) -> Result<Self, SimulationError> {
        let runner = RowRunner::new(document, places, true);
        let names = runner.names()?;
        Ok(Self { runner, columns: names.to_vec(), names })
    }

    /// The same, whose rows take step, modes and errors from a structure near their own: rows with equal numbers in five binary
    /// digits share it. A row depends on its own values all the same.
    #[must_use]
    pub fn with_near_structures(self) -> Self {
        Self { runner: self.runner.with_near_structures(), ..self }
    }

    /// The same, with the magnitude of the receptance at these frequencies \[Hz\] in each row.
    #[must_use]
    pub fn with_frf(self, frequencies: Vec<f64>) -> Self {
        let lines = frequencies.iter().map(|&frequency| frf_name(frequency));
        let columns = self.names.iter().cloned().chain(lines).collect();
        Self { columns, runner: self.runner.with_frf(frequencies), names: self.names }
    }

    /// Names of the observables, as
    /// [`observable_names`](crate::quantity::observable_names) orders them, then those of the receptances.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Observables of each row, or its error.
    pub fn run(&self, rows: &[Vec<Value>]) -> Vec<Result<Observables, SimulationError>> {
        self.run_unless(rows, &AtomicBool::new(false)).unwrap_or_default()
    }

    /// As [`run`](Self::run), none if `stop` is set before all rows are done: within some steps of the runs
    /// under way.
    pub fn run_unless(
        &self,
        rows: &[Vec<Value>],
        stop: &AtomicBool,
    ) -> Option<Vec<Result<Observables, SimulationError>>> {
        let texts = |row: usize| rows[row].iter().map(Value::to_string).collect();
        let found = self.runner.run::<String>(rows.len(), texts, stop, &|_| ())?.into_iter();
        let with_columns = |row| match row? {
            (names, observables) if names == self.names => Ok(observables),
            _ => Err(SimulationError::OtherColumns),
        };
        Some(found.map(with_columns).collect())
    }
}
