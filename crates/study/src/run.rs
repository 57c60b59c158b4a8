//! Runs a study chunk by chunk.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use asperity_simulation::error::SimulationError;
use asperity_simulation::observables::Observables;
use asperity_simulation::row_simulator::RowSimulator;
use asperity_simulation::warning::Warning;
use asperity_table::CsvWriter;
use serde_json::Value;

use crate::error::StudyError;
use crate::folder::{Role, StudyFolder};
use crate::plan::StudyPlan;

/// Most shards of a study.
pub const MOST_SHARDS: u64 = 100_000;

/// Results of one run: its numbers and the kinds of its warnings, or the reason of its failure.
pub type RowResult = Result<(Vec<f64>, Vec<&'static str>), String>;

/// A model with named outputs, which is run for rows of inputs.
///
/// The result of a row must depend on its inputs alone.
pub trait RowModel {
    /// Names of the outputs.
    fn columns(&self) -> &[String];

    /// Results of some rows, in their order; none if `stop` is set meanwhile.
    fn run(&self, rows: &[Vec<Value>], stop: &AtomicBool) -> Option<Vec<RowResult>>;
}

impl RowModel for RowSimulator {
    fn columns(&self) -> &[String] {
        Self::columns(self)
    }

    fn run(&self, rows: &[Vec<Value>], stop: &AtomicBool) -> Option<Vec<RowResult>> {
        let found = self.run_unless(rows, stop)?.into_iter();
        let result = |one: Result<Observables, SimulationError>| {
            let observables = one.map_err(|error| error.to_string())?;
            let mut kinds: Vec<&'static str> =
                observables.warnings.iter().map(Warning::kind).collect();
            kinds.dedup();
            let mut values = observables.values.into_vec();
            values.extend(observables.frf);
            Ok((values, kinds))
        };
        Some(found.map(result).collect())
    }
}

/// Part of a study that one machine computes: the chunks `k` with `k mod count = number - 1`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: u64,
    count: u64,
}

impl Shard {
    /// The whole study.
    pub const WHOLE: Self = Self { number: 1, count: 1 };

    /// Shard `number`, from 1, of `count`.
    ///
    /// # Errors
    /// [`StudyError::Shard`] unless `1 <= number <= count <= MOST_SHARDS`.
    pub fn new(number: u64, count: u64) -> Result<Self, StudyError> {
        if (1..=count).contains(&number) && count <= MOST_SHARDS {
            return Ok(Self { number, count });
        }
        Err(StudyError::Shard { number, count, most: MOST_SHARDS })
    }

    /// Number of shards.
    pub fn count(self) -> u64 {
        self.count
    }

    fn holds(self, chunk: u64) -> bool {
        chunk % self.count == self.number - 1
    }
}

impl StudyFolder {
    /// Numbers of the shards, of `count`, that have a chunk missing.
    ///
    /// # Errors
    /// [`StudyError::Shard`] for no shard or more than [`MOST_SHARDS`].
    pub fn unfinished_shards(&self, count: u64) -> Result<Vec<u64>, StudyError> {
        Shard::new(1, count)?;
        let mut found = vec![false; count as usize];
        if !self.is_complete() {
            for chunk in (0..self.chunks()).filter(|&chunk| !self.has(chunk)) {
                found[(chunk % count) as usize] = true;
            }
        }
        Ok((1..).zip(found).filter_map(|(number, missing)| missing.then_some(number)).collect())
    }
}

/// Settings of a run.
#[derive(Debug, Clone, Copy)]
pub struct RunOptions<'a> {
    /// The folder of the results.
    pub folder: &'a Path,
    /// True if a study that has begun is continued.
    pub resume: bool,
    /// The chunks to compute.
    pub shard: Shard,
}

/// Outcome of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StudyOutcome {
    /// All chunks are joined in this table.
    Complete(PathBuf),
    /// The chunks of the shard are on disk; the chunks of other shards are not joined yet.
    ShardDone,
    /// The run was stopped; the chunks that were complete are on disk.
    Stopped,
}

/// Runs the plan with `model`, chunk by chunk; the whole study is joined at the end.
///
/// Memory does not grow with the number of rows. The bytes of the results do not depend on the number
/// of threads, on interruptions, or on shards. Between chunks `progress` receives the numbers of
/// finished and of all rows of the shard. If `stop` is set the run ends, without the chunk that was begun.
///
/// # Errors
/// [`StudyError`] for a folder of another study, a study that has begun unless it is continued, and
/// files that cannot be written.
pub fn run(
    plan: &StudyPlan,
    model: &dyn RowModel,
    options: &RunOptions<'_>,
    stop: &AtomicBool,
    progress: &dyn Fn(u64, u64),
) -> Result<StudyOutcome, StudyError> {
    let columns = columns(plan, model);
    let sizes = [plan.rows(), plan.spec().chunk_rows];
    // Shards begin one study together.
    let resume = options.resume || options.shard != Shard::WHOLE;
    let folder = StudyFolder::claim(options.folder, &plan.identity()?, sizes, &columns, resume)?;
    if folder.is_complete() {
        return Ok(StudyOutcome::Complete(folder.merge()?));
    }
    let own = || (0..folder.chunks()).filter(|&chunk| options.shard.holds(chunk));
    let length = |chunk: u64| {
        let rows = folder.rows_of(chunk);
        rows.end - rows.start
    };
    let all: u64 = own().map(length).sum();
    let mut done = 0;
    for chunk in own() {
        if !folder.has(chunk) {
            if stop.load(Ordering::Relaxed) {
                return Ok(StudyOutcome::Stopped);
            }
            let rows = plan.values(folder.rows_of(chunk))?;
            let Some(results) = model.run(&plan.model_rows(&rows), stop) else {
                return Ok(StudyOutcome::Stopped);
            };
            let text = text_of(&rows, results, model.columns().len());
            folder.write_chunk(chunk, &text)?;
        }
        done += length(chunk);
        progress(done, all);
    }
    if options.shard == Shard::WHOLE {
        return Ok(StudyOutcome::Complete(folder.merge()?));
    }
    Ok(StudyOutcome::ShardDone)
}

/// Columns of the results with their parts in the study.
fn columns(plan: &StudyPlan, model: &dyn RowModel) -> Vec<(String, Role)> {
    let input = |(name, is_text): (&String, bool)| {
        (name.clone(), if is_text { Role::TextInput } else { Role::Input })
    };
    let mut columns: Vec<_> = plan.names().iter().zip(plan.texts()).map(input).collect();
    columns.extend(model.columns().iter().map(|name| (name.clone(), Role::Observable)));
    columns.push(("error".to_owned(), Role::Error));
    columns.push(("warnings".to_owned(), Role::Warnings));
    columns
}

/// Rows as CSV, as `sweep` writes them.
fn text_of(rows: &[Vec<Value>], results: Vec<RowResult>, columns: usize) -> String {
    let mut csv = CsvWriter::default();
    for (values, result) in rows.iter().zip(results) {
        for value in values {
            match value {
                Value::Number(number) => csv.number(number.as_f64()),
                Value::String(text) => csv.text(text),
                other => csv.text(&other.to_string()),
            };
        }
        match result {
            Ok((numbers, kinds)) => csv.numbers(numbers).text("").text(&kinds.join(" ")),
            Err(reason) => csv.numbers((0..columns).map(|_| None)).text(&reason).text(""),
        };
        csv.end_row();
    }
    csv.into_string()
}
