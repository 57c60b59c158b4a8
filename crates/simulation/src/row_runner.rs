//! Runs of one scenario for rows of values: the core of sweeps and of studies.
//!
//! Rows that differ in the force alone share a prepared scenario. Modal rows are integrated many at a
//! time in the lanes of vectors and refined by error control; rows by finite differences one by one.
//! The result of a row depends on its own values alone, not on other rows, threads, or lanes.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::Batch;
use asperity_scenario::{Document, ExcitationSpec, Scenario, set_value, validate_json};
use asperity_signal::{Complex64, transform_at};
use rayon::prelude::*;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::assemble::{Assembly, load_case};
use crate::error::SimulationError;
use crate::error_control::{ConvergedRun, ErrorControl, RunRequest};
use crate::finite_differences::integrate;
use crate::observables::Observables;
use crate::prepared_scenario::PreparedScenario;

/// Rows of one task, over the lanes of a batch: enough to fill the lanes again when some rows need
/// a second attempt.
const ROWS_A_LANE: usize = 4;

/// Prepared scenarios that are kept for other rows.
const MOST_PREPARED: usize = 64;

/// One input of a row: the places of the scenario that take its value.
pub type Places = Vec<String>;

/// The observables of a row, and their names, which rows share.
pub(crate) type Row = (Arc<[String]>, Observables);

/// Runs one scenario with rows of values.
#[derive(Debug)]
pub(crate) struct RowRunner {
    document: Document,
    places: Vec<Places>,
    /// True if each row is checked as a whole scenario before it is run.
    checks_rows: bool,
    /// Frequencies \[Hz\] at which the receptance is found.
    frequencies: Vec<f64>,
    control: ErrorControl,
    /// Prepared scenarios by the values that change more than the force.
    prepared: Mutex<HashMap<Vec<String>, Arc<PreparedScenario>>>,
}

/// A row that has been set up.
enum Started {
    /// A request for each sensor.
    Modal(Vec<RunRequest>),
    Done(Row),
}

impl RowRunner {
    /// A runner of the scenario of `document`; the values of a row go to `places`, in their order.
    pub(crate) fn new(document: Document, places: Vec<Places>, checks_rows: bool) -> Self {
        let control = ErrorControl::new(Batch::default());
        let (frequencies, prepared) = (Vec::new(), Mutex::default());
        Self { document, places, checks_rows, frequencies, control, prepared }
    }

    /// The same, with the magnitude of the receptance at these frequencies \[Hz\] in each row.
    pub(crate) fn with_frf(self, frequencies: Vec<f64>) -> Self {
        let highest = frequencies.iter().copied().fold(0.0, f64::max);
        Self { frequencies, control: self.control.keeping(highest), ..self }
    }

    /// Observables of `count` rows, or their errors, in order; none if `stop` is set before all rows
    /// are begun. `row` gives the values of a row, as JSON or bare text; `progress` receives the number
    /// of finished rows.
    pub(crate) fn run<T: AsRef<str>>(
        &self,
        count: usize,
        row: impl Fn(usize) -> Vec<T> + Sync,
        stop: &AtomicBool,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Option<Vec<Result<Row, SimulationError>>> {
        let size = Batch::default().room() * ROWS_A_LANE;
        let finished = AtomicUsize::new(0);
        let task = |task: usize| {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let rows = task * size..((task + 1) * size).min(count);
            let length = rows.len();
            let found = self.run_task(rows, &row);
            progress(finished.fetch_add(length, Ordering::Relaxed) + length);
            Some(found)
        };
        let found: Option<Vec<Vec<_>>> =
            (0..count.div_ceil(size)).into_par_iter().map(task).collect();
        Some(found?.into_iter().flatten().collect())
    }

    /// Some rows: the modal ones in one batch, the others one by one.
    fn run_task<T: AsRef<str>>(
        &self,
        numbers: Range<usize>,
        row: &impl Fn(usize) -> Vec<T>,
    ) -> Vec<Result<Row, SimulationError>> {
        let (mut requests, mut places) = (Vec::new(), Vec::new());
        let mut rows: Vec<Option<Result<Row, SimulationError>>> = Vec::with_capacity(numbers.len());
        for number in numbers {
            rows.push(match self.start(&row(number)) {
                Ok(Started::Modal(of_sensors)) => {
                    if let Some(first) = of_sensors.first() {
                        places.push((rows.len(), Arc::clone(&first.prepared), of_sensors.len()));
                    }
                    requests.extend(of_sensors);
                    None
                }
                Ok(Started::Done(row)) => Some(Ok(row)),
                Err(error) => Some(Err(error)),
            });
        }
        let mut outcomes = self.control.run(&requests).into_iter();
        for (place, prepared, sensors) in places {
            let run = ConvergedRun::joined(outcomes.by_ref().take(sensors));
            rows[place] = Some(run.map(|mut run| {
                run.observables.frf =
                    self.magnitudes(|| self.control.receptance(&run, &self.frequencies));
                (Arc::clone(&prepared.names), run.observables)
            }));
        }
        rows.into_iter().flatten().collect()
    }

    /// The request of a row, or its observables if it is not modal.
    fn start<T: AsRef<str>>(&self, row: &[T]) -> Result<Started, SimulationError> {
        let folder = self.document.folder();
        if self.checks_rows {
            let faults = validate_json(&self.value(row)?, folder);
            if !faults.is_empty() {
                let words: Vec<String> = faults.iter().map(ToString::to_string).collect();
                return Err(SimulationError::Scenario(words.join("; ")));
            }
        }
        let scenario = || deserialised::<Scenario>(self.value(row)?);
        let prepared = self.prepared(row, scenario)?;
        if prepared.modal().is_some() {
            let bodies = prepared.assembly.structure.stack().bodies();
            let load = load_case(&self.excitation(row)?, bodies, folder)?;
            return Ok(Started::Modal(RunRequest::at_sensors(&prepared, &load, None)));
        }
        let assembly = Assembly::new(&scenario()?, folder)?;
        let (transient, mut found) = integrate(&assembly, &prepared.at_rest, &|_| ())?;
        found.frf = self.magnitudes(|| {
            let (history, rate) = (&transient.history, assembly.sampling.rate());
            let receptance = |frequency: &f64| {
                let [response, force] = [&history.sensors[0].displacement, &history.load]
                    .map(|samples| transform_at(samples, rate, *frequency));
                response / force
            };
            let known = |frequency: &&f64| **frequency < 0.5 * rate;
            Some(self.frequencies.iter().take_while(known).map(receptance).collect())
        });
        Ok(Started::Done((Arc::clone(&prepared.names), found)))
    }

    /// The document of a row.
    fn value<T: AsRef<str>>(&self, row: &[T]) -> Result<Value, SimulationError> {
        let mut value = self.document.value().clone();
        for (places, text) in self.places.iter().zip(row) {
            for place in places {
                set_value(&mut value, place, text.as_ref())?;
            }
        }
        Ok(value)
    }

    /// The force of a row.
    fn excitation<T: AsRef<str>>(&self, row: &[T]) -> Result<ExcitationSpec, SimulationError> {
        let mut part = match self.document.value().get("excitation") {
            Some(excitation) => json!({ "excitation": excitation }),
            None => json!({}),
        };
        for (places, text) in self.places.iter().zip(row) {
            for place in places.iter().filter(|place| is_of_force(place)) {
                set_value(&mut part, place, text.as_ref())?;
            }
        }
        deserialised(part.get_mut("excitation").map(Value::take).unwrap_or_default())
    }

    /// The prepared scenario of a row, which rows that differ in the force alone share.
    fn prepared<T: AsRef<str>>(
        &self,
        row: &[T],
        scenario: impl FnOnce() -> Result<Scenario, SimulationError>,
    ) -> Result<Arc<PreparedScenario>, SimulationError> {
        let of_structure = |places: &Places| !places.iter().all(|place| is_of_force(place));
        let inputs = self.places.iter().zip(row).filter(|(places, _)| of_structure(places));
        let key: Vec<String> = inputs.map(|(_, text)| text.as_ref().to_owned()).collect();
        let known = || self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(prepared) = known().get(&key) {
            return Ok(Arc::clone(prepared));
        }
        let prepared = Arc::new(PreparedScenario::new(&scenario()?, self.document.folder())?);
        let mut all = known();
        if all.len() >= MOST_PREPARED {
            all.clear();
        }
        // Another task may have been faster; both results are the same.
        Ok(Arc::clone(all.entry(key).or_insert(prepared)))
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
}

/// True for a place in the scenario's load that does not change its kind.
fn is_of_force(place: &str) -> bool {
    place.starts_with("/excitation/") && place != "/excitation/kind"
}

fn deserialised<T: DeserializeOwned>(value: Value) -> Result<T, SimulationError> {
    serde_json::from_value(value).map_err(|error| SimulationError::Scenario(error.to_string()))
}
