//! Runs of one scenario for rows of values: the core of sweeps and of studies.
//!
//! Rows that differ in the force alone share a prepared scenario, or an assembled structure of matrices. Modal rows are integrated many at a
//! time in the lanes of vectors and refined by error control; rows by finite differences one by one.
//! The result of a row depends on its own values alone, not on other rows, threads, or lanes.
//!
//! Rows of a study take step, modes and errors from a structure near their own, with the numbers of the row rounded
//! to five binary digits: rows close to each other share it.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::Batch;
use asperity_scenario::{Document, InvalidDocument, MethodSpec, Scenario};
use asperity_structure::LoadCase;
use rayon::prelude::*;

use crate::assemble::{Assembly, load_case};
use crate::error::SimulationError;
use crate::error_control::{ConvergedRun, ErrorControl, RunRequest};
use crate::finite_differences::{FineResponse, integrate};
use crate::observables::Observables;
use crate::patches::PatchRows;
use crate::prepared_scenario::PreparedScenario;
use crate::row_inputs::{Places, RowInputs, magnitudes, receptance_of, rounded};

/// Rows of one task, over the lanes of a batch: enough to fill the lanes again when some rows need
/// a second attempt.
const ROWS_A_LANE: usize = 4;

/// Prepared scenarios that are kept for other rows.
const MOST_PREPARED: usize = 64;
const MOST_NEAR: usize = 1024;

/// Difference of natural frequencies, as a share, up to which a structure is near another.
const NEAR: f64 = 0.1;

/// Prepared scenarios by the values that change more than the force; none for values that are not valid.
type Known = HashMap<Vec<String>, Option<Arc<PreparedScenario>>>;

/// The observables of a row, and their names, which rows share.
pub(crate) type Row = (Arc<[String]>, Observables);

/// Runs one scenario with rows of values.
#[derive(Debug)]
pub(crate) struct RowRunner {
    inputs: RowInputs,
    /// Frequencies \[Hz\] at which the receptance is found.
    frequencies: Vec<f64>,
    control: ErrorControl,
    /// Prepared scenarios by the values that change more than the force.
    prepared: Mutex<Known>,
    /// The same for near structures of rows; none where each row is refined by itself.
    near: Option<Mutex<Known>>,
    /// The assembled structures of matrices.
    patches: PatchRows,
    /// True for responses without estimated errors.
    is_draft: bool,
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
        let inputs = RowInputs::new(document, places, checks_rows);
        let (frequencies, prepared) = (Vec::new(), Mutex::default());
        let patches = PatchRows::default();
        let (near, is_draft) = (None, false);
        Self { inputs, frequencies, control, prepared, near, patches, is_draft }
    }

    /// The same, whose rows take step, modes and errors from structures near their own.
    pub(crate) fn with_near_structures(self) -> Self {
        Self { near: Some(Mutex::default()), ..self }
    }

    /// The same, whose modal rows of bars have no estimated errors, and take the time of one or two responses.
    pub(crate) fn without_errors(self) -> Self {
        Self { is_draft: true, ..self }
    }

    /// Names of the observables of the scenario as it is.
    ///
    /// # Errors
    /// [`SimulationError`] when it cannot be set up.
    pub(crate) fn names(&self) -> Result<Arc<[String]>, SimulationError> {
        let document = self.inputs.document();
        let fault = |error: InvalidDocument| SimulationError::Scenario(error.to_string());
        if document.has_matrices() {
            document.structure_scenario().map_err(fault)?;
            return PatchRows::names(&self.inputs);
        }
        let scenario = document.scenario().map_err(fault)?;
        Ok(Arc::clone(&PreparedScenario::new(&scenario, document.folder())?.names))
    }

    /// The same, with the magnitude of the receptance at these frequencies \[Hz\] in each row.
    pub(crate) fn with_frf(self, frequencies: Vec<f64>) -> Self {
        let highest = frequencies.iter().copied().fold(0.0, f64::max);
        Self { frequencies, control: self.control.keeping(highest), ..self }
    }

    /// Observables of `count` rows, or their errors, in order; none if `stop` is set before all rows
    /// are done. `row` gives the values of a row, as JSON or bare text; `progress` receives the number
    /// of finished rows.
    pub(crate) fn run<T: AsRef<str>>(
        &self,
        count: usize,
        row: impl Fn(usize) -> Vec<T> + Sync,
        stop: &AtomicBool,
        progress: &(dyn Fn(usize) + Sync),
    ) -> Option<Vec<Result<Row, SimulationError>>> {
        if self.inputs.document().has_matrices() {
            let own = (&self.inputs, &self.frequencies[..]);
            return self.patches.run(own, count, row, stop, progress);
        }
        let size = self.rows_of_task();
        let finished = AtomicUsize::new(0);
        let task = |task: usize| {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            let rows = task * size..((task + 1) * size).min(count);
            let length = rows.len();
            let found = self.run_task(rows, &row, stop);
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            progress(finished.fetch_add(length, Ordering::Relaxed) + length);
            Some(found)
        };
        let found: Option<Vec<Vec<_>>> =
            (0..count.div_ceil(size)).into_par_iter().map(task).collect();
        Some(found?.into_iter().flatten().collect())
    }

    /// Rows that are run together: as many as fill the lanes of a batch, or one by finite differences.
    fn rows_of_task(&self) -> usize {
        match self.inputs.document().scenario().map(|scenario| scenario.method) {
            Ok(MethodSpec::FiniteDifference(_)) => 1,
            _ => Batch::default().room() * ROWS_A_LANE,
        }
    }

    /// Some rows: the modal ones in one batch, the others one by one.
    fn run_task<T: AsRef<str>>(
        &self,
        numbers: Range<usize>,
        row: &impl Fn(usize) -> Vec<T>,
        stop: &AtomicBool,
    ) -> Vec<Result<Row, SimulationError>> {
        let (mut requests, mut places) = (Vec::new(), Vec::new());
        let mut rows: Vec<Option<Result<Row, SimulationError>>> = Vec::with_capacity(numbers.len());
        for number in numbers {
            rows.push(match self.start(&row(number), stop) {
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
        let outcomes = if self.is_draft {
            self.control.draft(&requests, stop)
        } else {
            self.control.run_unless(&requests, stop)
        };
        let mut outcomes = outcomes.into_iter();
        for (place, prepared, sensors) in places {
            let run = ConvergedRun::joined(outcomes.by_ref().take(sensors));
            rows[place] = Some(run.map(|mut run| {
                run.observables.frf = magnitudes(&self.frequencies, || {
                    self.control.receptance(&run, &self.frequencies)
                });
                (Arc::clone(&prepared.names), run.observables)
            }));
        }
        rows.into_iter().flatten().collect()
    }

    /// The request of a row, or its observables if it is not modal.
    fn start<T: AsRef<str>>(
        &self,
        row: &[T],
        stop: &AtomicBool,
    ) -> Result<Started, SimulationError> {
        let folder = self.inputs.folder();
        self.inputs.check(row)?;
        let scenario = || self.inputs.scenario::<T, Scenario>(row);
        let prepared = self.prepared(row, scenario)?;
        if prepared.modal().is_some() {
            let bodies = prepared.assembly.structure.stack().bodies();
            let load = load_case(&self.inputs.excitation(row)?, bodies, folder)?;
            let mut requests = RunRequest::at_sensors(&prepared, &load, None);
            let near = self.near(row, &prepared, &load);
            for request in &mut requests {
                request.near.clone_from(&near);
            }
            return Ok(Started::Modal(requests));
        }
        let assembly = Assembly::new(&scenario()?, folder)?;
        let FineResponse { transient, readings, observables: mut found } =
            integrate(&assembly, &prepared.at_rest, stop, &|_| ())?;
        let rate = assembly.sampling.divided(readings).rate();
        let receptance = || Some(receptance_of(&transient.history, rate, &self.frequencies));
        found.frf = magnitudes(&self.frequencies, receptance);
        Ok(Started::Done((Arc::clone(&prepared.names), found)))
    }

    /// The prepared scenario of a row, which rows that differ in the force alone share.
    fn prepared<T: AsRef<str>>(
        &self,
        row: &[T],
        scenario: impl FnOnce() -> Result<Scenario, SimulationError>,
    ) -> Result<Arc<PreparedScenario>, SimulationError> {
        let key = self.inputs.of_structure(row, |_| false);
        let known = || self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(Some(prepared)) = known().get(&key) {
            return Ok(Arc::clone(prepared));
        }
        let prepared = Arc::new(PreparedScenario::new(&scenario()?, self.inputs.folder())?);
        Ok(kept(&mut known(), MOST_PREPARED, key, Some(prepared.clone())).unwrap_or(prepared))
    }

    /// The near structure of a row, and the load with its amplitude rounded; none for a load that lasts,
    /// whose response depends on the structure more strongly, for friction, and where no structure is near.
    fn near<T: AsRef<str>>(
        &self,
        row: &[T],
        prepared: &Arc<PreparedScenario>,
        load: &LoadCase,
    ) -> Option<(Arc<PreparedScenario>, LoadCase)> {
        let all = self.near.as_ref()?;
        if load.ends_at() == f64::INFINITY || prepared.assembly.structure.friction().is_some() {
            return None;
        }
        let load = load.with_amplitude(rounded(load.amplitude()));
        let values = self.inputs.rounded(row);
        let key = self.inputs.of_structure(&values, |_| false);
        if key == self.inputs.of_structure(row, |_| false) {
            return Some((Arc::clone(prepared), load));
        }
        let known = || all.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known().get(&key).cloned();
        let near = found.unwrap_or_else(|| {
            let scenario = self.inputs.scenario::<String, Scenario>(&values).ok();
            let found = scenario.and_then(|one| {
                PreparedScenario::new(&one, self.inputs.folder()).ok().map(Arc::new)
            });
            kept(&mut known(), MOST_NEAR, key, found)
        })?;
        let [own, other] = [prepared, &near].map(|one| one.at_rest.natural_frequency_hz);
        let is_near = (own? - other?).abs() <= NEAR * own?;
        is_near.then_some((near, load))
    }
}

/// The scenario that is known for a key: `prepared`, unless another task was faster; both are the same.
fn kept(
    known: &mut Known,
    most: usize,
    key: Vec<String>,
    prepared: Option<Arc<PreparedScenario>>,
) -> Option<Arc<PreparedScenario>> {
    if known.len() >= most {
        known.clear();
    }
    known.entry(key).or_insert(prepared).clone()
}
