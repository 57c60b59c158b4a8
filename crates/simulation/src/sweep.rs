//! Many runs of one scenario with some of its values varied.
//!
//! | module | holds |
//! |---|---|
//! | `variation` | pointers and their values |
//! | `input_files` | files that the runs read, with their SHA-256 |
//! | `plan` | the scenarios of a sweep, checked before the first run |
//! | `table` | the results, and as CSV |

mod input_files;
mod plan;
mod table;
mod variation;

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::Batch;
use asperity_scenario::Document;
use rayon::prelude::*;

use crate::assemble::{Assembly, excitation};
use crate::error::SimulationError;
use crate::error_control::{ErrorControl, Request};
use crate::finite_differences::integrate;
use crate::observables::Observables;
use crate::prepared_scenario::PreparedScenario;
use plan::Plan;

pub use input_files::input_files;
pub use plan::SweepError;
pub use table::Sweep;
pub use variation::{MOST_RUNS, Variation, VariationError, number_of_runs};

/// Hits of one task, over the lanes of a batch: enough to fill the lanes again when some hits need
/// a second attempt.
const HITS_A_LANE: usize = 4;

/// Prepared scenarios kept for later runs.
const MOST_PREPARED: usize = 64;

/// Runs the cartesian product of `variations` over `document`, the last varying fastest.
///
/// The variations are checked before the first run starts. Runs go over all threads, those with the
/// modal method many at a time in the lanes of vectors; results are in order and do not depend on
/// the number of threads and lanes. Warnings are logged once a kind.
///
/// # Errors
/// [`SweepError`] when a combination is invalid. A run that fails does not end the sweep: its
/// outcome is the error.
///
/// ```
/// # use asperity_scenario::Document;
/// # use asperity_simulation::sweep::{Variation, sweep};
/// let document = Document::read("examples/block.json")?;
/// let forces = Variation::parse("/excitation/peak_n=2:14:3")?;
/// let results = sweep(&document, &[forces])?;
/// let f1 = [0, 2].map(|run| results.number(run, "fundamental.frequency_hz").unwrap());
/// assert!(f1[1] < f1[0], "the contact softens with the force");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sweep(document: &Document, variations: &[Variation]) -> Result<Sweep, SweepError> {
    sweep_with_progress(document, variations, &|_, _| ())
}

/// As [`sweep`]; `progress` receives the numbers of finished and of all runs.
///
/// # Errors
/// Those of [`sweep`].
pub fn sweep_with_progress(
    document: &Document,
    variations: &[Variation],
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Sweep, SweepError> {
    let plan = tracing::info_span!("check").in_scope(|| Plan::new(document, variations))?;
    let _stage = tracing::info_span!("integrate and analyse").entered();
    let batch = Batch::default();
    let work = Work { plan: &plan, prepared: Mutex::default(), control: ErrorControl::new(batch) };
    let size = batch.room() * HITS_A_LANE;
    let finished = AtomicUsize::new(0);
    let rows: Vec<Result<Row, SimulationError>> = (0..plan.runs().div_ceil(size))
        .into_par_iter()
        .flat_map_iter(|task| {
            let runs = task * size..((task + 1) * size).min(plan.runs());
            let count = runs.len();
            let rows = work.rows(runs);
            progress(finished.fetch_add(count, Ordering::Relaxed) + count, plan.runs());
            rows
        })
        .collect();
    let named = rows.iter().find_map(|row| row.as_ref().ok());
    let columns = named.map_or_else(|| Arc::from([]), |(names, _)| Arc::clone(names));
    let mut warnings = Vec::new();
    let runs = rows.into_iter().enumerate().map(|(run, row)| {
        let (names, found) = row?;
        // Values may rename an interface, or add a body: the table has no columns for such runs.
        if Arc::ptr_eq(&names, &columns) || names == columns {
            warnings.extend(found.warnings.into_iter().map(|warning| (run, warning)));
            Ok(found.values)
        } else {
            Err(SimulationError::OtherColumns)
        }
    });
    let runs = runs.collect();
    let sweep =
        Sweep { variations: variations.to_vec(), columns: columns.to_vec(), runs, warnings };
    for (kind, count) in sweep.warning_counts() {
        if let Some((run, warning)) = sweep.warnings.iter().find(|(_, one)| one.kind() == kind) {
            tracing::warn!(runs = count, "{warning} (run {})", run + 1);
        }
    }
    Ok(sweep)
}

/// Carries out `work` on a pool of `threads` threads, or on all cores without a number; none if
/// that many cannot be started.
pub fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Option<T> {
    let Some(threads) = threads else { return Some(work()) };
    if !(1..=1024).contains(&threads) {
        return None;
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()?;
    Some(pool.install(work))
}

/// The observables of one run, and their names, which runs share.
type Row = (Arc<[String]>, Observables);

/// State shared by the tasks of a sweep.
struct Work<'a> {
    plan: &'a Plan<'a>,
    prepared: Mutex<HashMap<Vec<usize>, Arc<PreparedScenario>>>,
    control: ErrorControl,
}

/// A run that has been set up: a modal hit, or a row that is done.
enum Started {
    Hit(Box<Request>),
    Done(Row),
}

impl Work<'_> {
    /// The rows of some runs: the modal ones in one batch, the others one by one.
    fn rows(&self, runs: std::ops::Range<usize>) -> Vec<Result<Row, SimulationError>> {
        let mut rows: Vec<Option<Result<Row, SimulationError>>> = Vec::new();
        let mut requests: Vec<Request> = Vec::new();
        let mut places: Vec<usize> = Vec::new();
        for run in runs {
            let place = rows.len();
            rows.push(match self.start(run) {
                Ok(Started::Hit(request)) => {
                    requests.push(*request);
                    places.push(place);
                    None
                }
                Ok(Started::Done(row)) => Some(Ok(row)),
                Err(error) => Some(Err(error)),
            });
        }
        let outcomes = self.control.run(&requests);
        for ((outcome, request), place) in outcomes.into_iter().zip(&requests).zip(places) {
            let names = || Arc::clone(&request.prepared.names);
            rows[place] = Some(outcome.map(|done| (names(), done.observables)));
        }
        rows.into_iter().flatten().collect()
    }

    /// The hit of a run, or its observables if it is not modal.
    fn start(&self, run: usize) -> Result<Started, SimulationError> {
        let chosen = self.plan.chosen(run);
        let prepared = self.prepared(&chosen)?;
        if prepared.modal().is_some() {
            let excitation = excitation(&self.plan.excitation(&chosen)?, self.plan.folder())?;
            return Ok(Started::Hit(Box::new(Request { prepared, excitation, duration: None })));
        }
        let assembly = Assembly::new(&self.plan.scenario(&chosen)?, self.plan.folder())?;
        let (_, found) = integrate(&assembly, &prepared.at_rest, &|_| ())?;
        Ok(Started::Done((Arc::clone(&prepared.names), found)))
    }

    fn prepared(&self, chosen: &[usize]) -> Result<Arc<PreparedScenario>, SimulationError> {
        let key = self.plan.structure(chosen);
        let known = || self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(prepared) = known().get(&key) {
            return Ok(Arc::clone(prepared));
        }
        let scenario = self.plan.scenario(chosen)?;
        let prepared = Arc::new(PreparedScenario::new(&scenario, self.plan.folder())?);
        let mut all = known();
        if all.len() >= MOST_PREPARED {
            all.clear();
        }
        // Another task may have been faster; both results are the same.
        Ok(Arc::clone(all.entry(key).or_insert(prepared)))
    }
}
