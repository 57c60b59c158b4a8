//! Many runs of one scenario with some of its values varied.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use crate::diagnostic::Invalid;
use crate::document::{Document, SetError};
use crate::error::StudyError;
use crate::record::{push_number, quoted};
use crate::run::simulate;
use crate::scenario::Scenario;
use crate::summary::Summary;

/// Most runs of one sweep.
pub const MOST_RUNS: usize = 10_000_000;

/// One place of the scenario and the values it takes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variation {
    /// JSON Pointer into the scenario.
    pub pointer: String,
    /// The values, as `--set` takes them.
    pub values: Vec<String>,
}

/// A `--vary POINTER=VALUES` that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum VariationError {
    /// There is no equals sign.
    #[error("\"{text}\" has no \"=\"; accepted: POINTER=start:stop:count or POINTER=v1,v2,...")]
    NoEquals {
        /// The argument.
        text: String,
    },
    /// There are no values.
    #[error("{pointer}: no values; accepted: start:stop:count or v1,v2,...")]
    Empty {
        /// The pointer.
        pointer: String,
    },
    /// A range that is not two numbers and a count.
    #[error(
        "{pointer}: \"{text}\" is no range; accepted: start:stop:count with finite numbers and a count from 1 to 10000000"
    )]
    Range {
        /// The pointer.
        pointer: String,
        /// The values as given.
        text: String,
    },
    /// More runs than a sweep takes.
    #[error("the sweep would take {runs} runs; at most 10000000 are accepted")]
    TooMany {
        /// The number of runs.
        runs: u128,
    },
}

impl Variation {
    /// Reads `POINTER=start:stop:count` (linear, ends included) or `POINTER=v1,v2,...`.
    ///
    /// # Errors
    /// [`VariationError`] when it is neither.
    pub fn parse(text: &str) -> Result<Self, VariationError> {
        let (pointer, values) = text
            .split_once('=')
            .ok_or_else(|| VariationError::NoEquals { text: text.to_owned() })?;
        let pointer = pointer.to_owned();
        if values.trim().is_empty() {
            return Err(VariationError::Empty { pointer });
        }
        let values = if values.contains(':') && !values.contains(['{', '[', '"', ',']) {
            range(values).ok_or(VariationError::Range {
                pointer: pointer.clone(),
                text: values.to_owned(),
            })?
        } else {
            values.split(',').map(|value| value.trim().to_owned()).collect()
        };
        Ok(Self { pointer, values })
    }
}

/// The numbers of `start:stop:count`, ends included and met exactly.
fn range(text: &str) -> Option<Vec<String>> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let [start, stop, count] = parts.as_slice() else { return None };
    let (start, stop): (f64, f64) = (start.parse().ok()?, stop.parse().ok()?);
    let count: usize = count.parse().ok()?;
    if !start.is_finite() || !stop.is_finite() || !(1..=MOST_RUNS).contains(&count) {
        return None;
    }
    let last = (count - 1).max(1) as f64;
    let value = |i: usize| {
        if i + 1 == count && count > 1 { stop } else { start + (stop - start) * i as f64 / last }
    };
    Some((0..count).map(|i| value(i).to_string()).collect())
}

/// One run of a sweep: the values it was given, and what came of it.
#[derive(Debug)]
pub struct SweepRun {
    /// The value of each variation, in the order of the variations.
    pub values: Vec<String>,
    /// The summary, or why there is none.
    pub outcome: Result<Summary, StudyError>,
}

/// Why a sweep cannot start.
#[derive(Debug, Error)]
pub enum SweepError {
    /// A variation cannot be used.
    #[error(transparent)]
    Variation(#[from] VariationError),
    /// A value cannot be set.
    #[error("run {run}: {source}")]
    Set {
        /// Number of the run, from 1.
        run: usize,
        /// Why.
        source: SetError,
    },
    /// A combination of values is no valid scenario.
    #[error("run {run} ({values}): {source}")]
    Invalid {
        /// Number of the run, from 1.
        run: usize,
        /// The values of that run.
        values: String,
        /// What is wrong.
        source: Invalid,
    },
}

/// The cartesian product of `variations` over `document`, the last varying
/// fastest. Every scenario is checked before the first run starts; the runs go
/// over all threads, and their results come back in order. `done` hears how
/// many runs are finished.
///
/// # Errors
/// [`SweepError`] when a combination is invalid. A run that fails does not end
/// the sweep: its own outcome says why.
pub fn sweep(
    document: &Document,
    variations: &[Variation],
    done: &(dyn Fn(usize, usize) + Sync),
) -> Result<Vec<SweepRun>, SweepError> {
    let runs = number_of_runs(variations)?;
    let prepared: Vec<(Vec<String>, Document, Scenario)> = (0..runs)
        .into_par_iter()
        .map(|run| prepare(document, variations, run))
        .collect::<Result<_, _>>()?;
    let finished = AtomicUsize::new(0);
    Ok(prepared
        .into_par_iter()
        .map(|(values, document, scenario)| {
            let outcome = simulate(&document, &scenario, &|_| ()).map(|run| run.summary);
            done(finished.fetch_add(1, Ordering::Relaxed) + 1, runs);
            SweepRun { values, outcome }
        })
        .collect())
}

/// The number of runs of a sweep over `variations`.
///
/// # Errors
/// [`VariationError::TooMany`] beyond [`MOST_RUNS`].
pub fn number_of_runs(variations: &[Variation]) -> Result<usize, VariationError> {
    let product = variations
        .iter()
        .try_fold(1u128, |runs, variation| runs.checked_mul(variation.values.len() as u128))
        .unwrap_or(u128::MAX);
    match usize::try_from(product) {
        Ok(runs) if runs <= MOST_RUNS => Ok(runs),
        _ => Err(VariationError::TooMany { runs: product }),
    }
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

fn prepare(
    document: &Document,
    variations: &[Variation],
    run: usize,
) -> Result<(Vec<String>, Document, Scenario), SweepError> {
    let mut values = Vec::with_capacity(variations.len());
    let mut rest = run;
    for variation in variations.iter().rev() {
        values.push(variation.values[rest % variation.values.len()].clone());
        rest /= variation.values.len();
    }
    values.reverse();
    let mut document = document.clone();
    for (variation, value) in variations.iter().zip(&values) {
        document
            .set(&variation.pointer, value)
            .map_err(|source| SweepError::Set { run: run + 1, source })?;
    }
    let scenario = document.scenario().map_err(|source| {
        let named = variations.iter().zip(&values);
        let values: Vec<String> =
            named.map(|(v, value)| format!("{}={value}", v.pointer)).collect();
        SweepError::Invalid { run: run + 1, values: values.join(", "), source }
    })?;
    Ok((values, document, scenario))
}

/// `sweep.csv`: a row per run, the varied values, the summary's numbers, and
/// the error of a run that failed.
pub fn sweep_csv(variations: &[Variation], runs: &[SweepRun]) -> String {
    let names: Vec<String> = runs
        .iter()
        .find_map(|run| run.outcome.as_ref().ok())
        .map(|summary| summary.scalars().into_iter().map(|(name, _)| name).collect())
        .unwrap_or_default();
    let mut text = String::new();
    let pointers = variations.iter().map(|variation| variation.pointer.as_str());
    let header: Vec<String> =
        pointers.chain(names.iter().map(String::as_str)).chain(["error"]).map(quoted).collect();
    text.push_str(&header.join(","));
    text.push('\n');
    for run in runs {
        for value in &run.values {
            text.push_str(&quoted(value));
            text.push(',');
        }
        match &run.outcome {
            Ok(summary) => {
                for (_, value) in summary.scalars() {
                    push_number(&mut text, value.unwrap_or(f64::NAN));
                    text.push(',');
                }
            }
            Err(error) => {
                text.push_str(&",".repeat(names.len()));
                text.push_str(&quoted(&error.to_string()));
            }
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_meet_their_ends_and_lists_are_taken_as_they_are() {
        let linear = Variation::parse("/excitation/peak_n=9:32:24").unwrap();
        assert_eq!(linear.values.len(), 24);
        assert_eq!((linear.values[0].as_str(), linear.values[23].as_str()), ("9", "32"));
        assert_eq!(Variation::parse("/a=0.1:0.3:3").unwrap().values[2], "0.3");
        assert_eq!(Variation::parse("/a=5:9:1").unwrap().values, ["5"]);
        let laws = Variation::parse("/interfaces/0/law=modified, pl").unwrap();
        assert_eq!(laws.values, ["modified", "pl"]);
    }

    #[test]
    fn what_is_no_variation_is_refused() {
        for text in ["/a", "/a=", "/a=1:2", "/a=1:2:0", "/a=x:2:3", "/a=1:inf:3", "/a=1:2:3:4"] {
            assert!(Variation::parse(text).is_err(), "{text}");
        }
        let many = Variation::parse("/a=0:1:9999").unwrap();
        let variations = vec![many.clone(), many.clone(), many];
        assert!(number_of_runs(&variations).is_err());
    }
}
