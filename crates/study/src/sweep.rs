//! Many runs of one scenario with some of its values varied.
//!
//! | module | holds |
//! |---|---|
//! | `variation` | what is varied |
//! | `plan` | the scenarios of a sweep, checked before the first run |
//! | `table` | what came of it, and as CSV |

mod plan;
mod table;
mod variation;

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::{Batch, Hit};
use rayon::prelude::*;

use crate::error::StudyError;
use crate::run::simulate;
use crate::struck::{Case, Observer};
use crate::summary::Summary;
use asperity_scenario::Document;
use plan::Plan;

pub use plan::SweepError;
pub use table::Sweep;
pub use variation::{MOST_RUNS, Variation, VariationError, number_of_runs};

/// Hits of one task, over the lanes of a batch: long enough to fill them again when some hits
/// need a second attempt.
const HITS_A_LANE: usize = 4;

/// Cases kept for runs to come.
const MOST_CASES: usize = 64;

/// The cartesian product of `variations` over `document`, the last varying fastest. The variations
/// are checked before the first run starts; the runs go over all threads, those with the modal
/// method many at a time in the lanes of vectors, and their results come back in order, whatever
/// the number of threads and lanes. `done` hears how many runs are finished.
///
/// # Errors
/// [`SweepError`] when a combination is invalid. A run that fails does not end
/// the sweep: its own outcome says why.
pub fn sweep(
    document: &Document,
    variations: &[Variation],
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<Sweep, SweepError> {
    let plan = Plan::new(document, variations)?;
    let batch = Batch::default();
    let work = Work { plan: &plan, batch, cases: Mutex::default(), observer: Observer::default() };
    let size = batch.room() * HITS_A_LANE;
    let finished = AtomicUsize::new(0);
    let summaries: Vec<Result<Row, StudyError>> = (0..plan.runs().div_ceil(size))
        .into_par_iter()
        .flat_map_iter(|task| {
            let runs = task * size..((task + 1) * size).min(plan.runs());
            let count = runs.len();
            let rows = work.rows(runs);
            done(finished.fetch_add(count, Ordering::Relaxed) + count, plan.runs());
            rows
        })
        .collect();
    let named = summaries.iter().find_map(|row| row.as_ref().ok());
    let columns = named.map_or_else(|| Arc::from([]), |row| Arc::clone(&row.names));
    let runs = summaries.into_iter().map(|row| {
        let row = row?;
        // Values may rename an interface, or add a body: such runs have no place in the table.
        if Arc::ptr_eq(&row.names, &columns) || row.names == columns {
            Ok(row.values)
        } else {
            Err(StudyError::OtherColumns)
        }
    });
    let runs = runs.collect();
    Ok(Sweep { variations: variations.to_vec(), columns: columns.to_vec(), runs })
}

/// Carries out `work` on a pool of `threads` threads, or on all cores if none are
/// named. `None` if that many cannot be started.
pub fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Option<T> {
    let Some(threads) = threads else { return Some(work()) };
    if !(1..=1024).contains(&threads) {
        return None;
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()?;
    Some(pool.install(work))
}

/// The numbers of one run, and their names, which cases share.
struct Row {
    names: Arc<[String]>,
    values: Box<[f64]>,
}

/// What the tasks of a sweep share.
struct Work<'a> {
    plan: &'a Plan<'a>,
    batch: Batch,
    cases: Mutex<HashMap<Vec<usize>, Arc<Case>>>,
    observer: Observer,
}

impl Work<'_> {
    /// The rows of some runs: the modal ones in one batch, the others one by one.
    fn rows(&self, runs: std::ops::Range<usize>) -> Vec<Result<Row, StudyError>> {
        let mut rows: Vec<Option<Result<Row, StudyError>>> = Vec::new();
        let mut hits: Vec<Hit> = Vec::new();
        let mut of: Vec<(usize, Arc<Case>)> = Vec::new();
        for run in runs {
            let place = rows.len();
            match self.start(run) {
                Ok(Started::Hit(case, hit)) => {
                    hits.push(*hit);
                    of.push((place, case));
                    rows.push(None);
                }
                Ok(Started::Done(row)) => rows.push(Some(Ok(row))),
                Err(error) => rows.push(Some(Err(error))),
            }
        }
        let natural = |index: usize| of[index].1.at_rest.natural_frequency_hz;
        let thinning = |index: usize, step: f64| self.observer.thinning(natural(index), 0.0, step);
        let instructions = format!("{:?}", self.batch.instructions).to_lowercase();
        let records = self.batch.run(&hits, &thinning);
        for ((record, hit), (place, case)) in records.into_iter().zip(&hits).zip(&of) {
            let row = record.map_err(StudyError::from).and_then(|record| {
                let summary = self.observer.summary(case, hit, &record, &instructions)?;
                Ok(Row::of(&summary, case))
            });
            rows[*place] = Some(row);
        }
        rows.into_iter().map(|row| row.unwrap_or(Err(StudyError::OtherColumns))).collect()
    }

    /// The hit of a run, or its row if it is not modal.
    fn start(&self, run: usize) -> Result<Started, StudyError> {
        let chosen = self.plan.chosen(run);
        let case = self.case(&chosen)?;
        if let Some(modal) = case.modal() {
            let drive = self.plan.excitation(&chosen)?;
            let hit = case.hit(&modal, &drive, self.plan.folder())?;
            return Ok(Started::Hit(case, Box::new(hit)));
        }
        let document = self.plan.document(&chosen)?;
        let scenario = self.plan.scenario(&chosen)?;
        let summary = simulate(&document, &scenario, &|_| ())?.summary;
        Ok(Started::Done(Row::of(&summary, &case)))
    }

    fn case(&self, chosen: &[usize]) -> Result<Arc<Case>, StudyError> {
        let key = self.plan.rig(chosen);
        let known = || self.cases.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(case) = known().get(&key) {
            return Ok(Arc::clone(case));
        }
        let case = Arc::new(Case::new(&self.plan.scenario(chosen)?, self.plan.folder())?);
        let mut cases = known();
        if cases.len() >= MOST_CASES {
            cases.clear();
        }
        // Another task may have been faster; both cases are the same.
        Ok(Arc::clone(cases.entry(key).or_insert(case)))
    }
}

/// A run that has been set up.
enum Started {
    Hit(Arc<Case>, Box<Hit>),
    Done(Row),
}

impl Row {
    fn of(summary: &Summary, case: &Case) -> Self {
        let values = summary.values().into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
        Self { names: case.names(summary), values }
    }
}
