//! Runs of one scenario for rows of given values, such as those of a design.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::Batch;
use asperity_scenario::{Document, Scenario, set_value, validate_json};
use asperity_signal::{Complex64, transform_at};
use rayon::prelude::*;
use serde_json::Value;

use crate::assemble::excitation;
use crate::error::SimulationError;
use crate::error_control::{ErrorControl, Request};
use crate::finite_differences::integrate;
use crate::observables::Observables;
use crate::prepared_scenario::PreparedScenario;
use crate::quantity::frf_name;

/// Hits of one task over the lanes of a batch.
const HITS_A_LANE: usize = 4;

/// Prepared scenarios that are kept for other rows.
const MOST_PREPARED: usize = 64;

/// One input of a row: the places of the scenario that take its value.
pub type Places = Vec<String>;

/// Runs one scenario with rows of values, each checked as a whole.
///
/// A row's result depends on its own values alone, not on other rows, threads, or vector lanes.
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
    document: Document,
    places: Vec<Places>,
    /// Marks inputs that change the force alone.
    force_only: Vec<bool>,
    names: Arc<[String]>,
    columns: Vec<String>,
    /// Frequencies \[Hz\] at which the receptance is found.
    frequencies: Vec<f64>,
    batch: Batch,
    prepared: Prepared,
}

/// Prepared scenarios by the values that change more than the force.
type Prepared = Mutex<HashMap<String, Arc<PreparedScenario>>>;

/// A row that has been set up.
enum Started {
    Hit(Request),
    Done(Observables),
}

impl RowSimulator {
    /// A simulator of the valid scenario of `document`; the numbers of a row go to `places`, in their
    /// order.
    ///
    /// # Errors
    /// [`SimulationError`] when the scenario itself cannot be set up.
    pub fn new(document: Document, places: Vec<Places>) -> Result<Self, SimulationError> {
        let fault = |text: String| SimulationError::Scenario(text);
        let scenario = document.scenario().map_err(|error| fault(error.to_string()))?;
        let names = Arc::clone(&PreparedScenario::new(&scenario, document.folder())?.names);
        let of_force = |place: &String| place == "/excitation" || place.starts_with("/excitation/");
        let force_only = places.iter().map(|all| all.iter().all(of_force)).collect();
        Ok(Self {
            document,
            places,
            force_only,
            columns: names.to_vec(),
            names,
            frequencies: Vec::new(),
            batch: Batch::default(),
            prepared: Prepared::default(),
        })
    }

    /// The same, with the magnitude of the receptance at these frequencies \[Hz\] in each row.
    #[must_use]
    pub fn with_frf(mut self, frequencies: Vec<f64>) -> Self {
        self.columns = self.names.to_vec();
        self.columns.extend(frequencies.iter().map(|&frequency| frf_name(frequency)));
        self.frequencies = frequencies;
        self
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

    /// As [`run`](Self::run), none if `stop` is set before all rows are begun: some tens of runs on each
    /// thread later.
    pub fn run_unless(
        &self,
        rows: &[Vec<Value>],
        stop: &AtomicBool,
    ) -> Option<Vec<Result<Observables, SimulationError>>> {
        let highest = self.frequencies.iter().copied().fold(0.0, f64::max);
        let control = ErrorControl::new(self.batch).keeping(highest);
        let size = self.batch.room() * HITS_A_LANE;
        let task = |rows| (!stop.load(Ordering::Relaxed)).then(|| self.run_task(&control, rows));
        let found: Option<Vec<Vec<_>>> = rows.par_chunks(size.max(1)).map(task).collect();
        Some(found?.into_iter().flatten().collect())
    }

    fn run_task(
        &self,
        control: &ErrorControl,
        rows: &[Vec<Value>],
    ) -> Vec<Result<Observables, SimulationError>> {
        let started: Vec<Result<Started, SimulationError>> =
            rows.iter().map(|row| self.start(row)).collect();
        let mut places = Vec::new();
        let mut requests = Vec::new();
        let mut outcomes: Vec<Option<Result<Observables, SimulationError>>> = Vec::new();
        for (place, one) in started.into_iter().enumerate() {
            outcomes.push(match one {
                Ok(Started::Hit(request)) => {
                    places.push(place);
                    requests.push(request);
                    None
                }
                Ok(Started::Done(found)) => Some(Ok(found)),
                Err(error) => Some(Err(error)),
            });
        }
        for (place, outcome) in places.into_iter().zip(control.run(&requests)) {
            outcomes[place] = Some(outcome.map(|mut done| {
                done.observables.frf =
                    self.magnitudes(|| control.receptance(&done, &self.frequencies));
                done.observables
            }));
        }
        outcomes.into_iter().flatten().collect()
    }

    fn start(&self, row: &[Value]) -> Result<Started, SimulationError> {
        let mut value = self.document.value().clone();
        let mut structure = String::new();
        for ((places, number), force_only) in self.places.iter().zip(row).zip(&self.force_only) {
            let text = number.to_string();
            for place in places {
                set_value(&mut value, place, &text)?;
            }
            if !force_only {
                structure.push_str(&text);
                structure.push('\n');
            }
        }
        let faults = validate_json(&value, self.document.folder());
        if !faults.is_empty() {
            let words: Vec<String> = faults.iter().map(ToString::to_string).collect();
            return Err(SimulationError::Scenario(words.join("; ")));
        }
        let scenario: Scenario = serde_json::from_value(value)
            .map_err(|error| SimulationError::Scenario(error.to_string()))?;
        let prepared = self.prepared(structure, &scenario)?;
        if prepared.names != self.names {
            return Err(SimulationError::OtherColumns);
        }
        if prepared.modal().is_some() {
            let excitation = excitation(&scenario.excitation, self.document.folder())?;
            return Ok(Started::Hit(Request { prepared, excitation, duration: None }));
        }
        let assembly = crate::assemble::Assembly::new(&scenario, self.document.folder())?;
        let (transient, mut found) = integrate(&assembly, &prepared.at_rest, &|_| ())?;
        found.frf = self.magnitudes(|| {
            let (history, rate) = (&transient.history, assembly.sampling.rate());
            let receptance = |frequency: &f64| {
                let [response, force] = [&history.displacement, &history.force]
                    .map(|samples| transform_at(samples, rate, *frequency));
                response / force
            };
            let known = |frequency: &&f64| **frequency < 0.5 * rate;
            Some(self.frequencies.iter().take_while(known).map(receptance).collect())
        });
        Ok(Started::Done(found))
    }

    /// Magnitudes of a receptance at the frequencies asked for; NaN where it is not known.
    fn magnitudes(&self, receptance: impl FnOnce() -> Option<Vec<Complex64>>) -> Box<[f64]> {
        if self.frequencies.is_empty() {
            return Box::default();
        }
        let found = receptance().unwrap_or_default();
        let known = found.iter().map(|value| value.norm());
        known.chain(std::iter::repeat(f64::NAN)).take(self.frequencies.len()).collect()
    }

    fn prepared(
        &self,
        structure: String,
        scenario: &Scenario,
    ) -> Result<Arc<PreparedScenario>, SimulationError> {
        let lock = || self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = lock().get(&structure) {
            return Ok(Arc::clone(known));
        }
        let new = Arc::new(PreparedScenario::new(scenario, self.document.folder())?);
        let mut all = lock();
        if all.len() >= MOST_PREPARED {
            all.clear();
        }
        Ok(Arc::clone(all.entry(structure).or_insert(new)))
    }
}
