//! Many runs of one scenario with some of its values varied: the product of the values, run row by row
//! as a study runs its rows.
//!
//! | module | holds |
//! |---|---|
//! | `variation` | pointers and their values |
//! | `input_files` | files that the runs read, with their SHA-256 |
//! | `plan` | the check of a sweep before the first run |
//! | `table` | the results, and as CSV |

mod input_files;
mod plan;
mod table;
mod variation;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity_scenario::Document;

use crate::error::SimulationError;
use crate::row_runner::RowRunner;
use plan::checked_runs;
use variation::chosen_values;

pub use input_files::input_files;
pub use plan::SweepError;
pub use table::Sweep;
pub use variation::{MOST_RUNS, Variation, VariationError, number_of_runs};

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
    let never = AtomicBool::new(false);
    let empty = || Sweep {
        variations: variations.to_vec(),
        columns: Vec::new(),
        runs: Vec::new(),
        warnings: Vec::new(),
    };
    Ok(sweep_unless(document, variations, &never, progress)?.unwrap_or_else(empty))
}

/// As [`sweep_with_progress`]; none once `stop` is set, within some steps of the runs under way. Runs by
/// finite differences and of structures of matrices are done first.
///
/// # Errors
/// Those of [`sweep`].
pub fn sweep_unless(
    document: &Document,
    variations: &[Variation],
    stop: &AtomicBool,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Option<Sweep>, SweepError> {
    run_sweep(document, variations, |runner| runner, stop, progress)
}

/// As [`sweep_unless`], without estimated errors: each run by the modal method is one response, or two where contact
/// is lost. For a picture that the sweep itself follows.
///
/// # Errors
/// Those of [`sweep`].
pub fn draft_sweep(
    document: &Document,
    variations: &[Variation],
    stop: &AtomicBool,
) -> Result<Option<Sweep>, SweepError> {
    run_sweep(document, variations, RowRunner::without_errors, stop, &|_, _| ())
}

fn run_sweep(
    document: &Document,
    variations: &[Variation],
    prepare: impl FnOnce(RowRunner) -> RowRunner,
    stop: &AtomicBool,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Option<Sweep>, SweepError> {
    let values = |run: usize| chosen_values(run, variations);
    let count = tracing::info_span!("check").in_scope(|| checked_runs(document, variations))?;
    let stage = tracing::info_span!("integrate and analyse").entered();
    let places = variations.iter().map(|variation| vec![variation.pointer.clone()]).collect();
    let runner = prepare(RowRunner::new(document.clone(), places, false));
    let rows = runner.run(count, values, stop, &|done| progress(done, count));
    let Some(rows) = rows else { return Ok(None) };
    drop(stage);
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
    Ok(Some(sweep))
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
