//! The check of a sweep before the first run.

use asperity_scenario::{Document, InvalidDocument, SetError, StructureScenario};
use rayon::prelude::*;
use thiserror::Error;

use super::variation::{Variation, VariationError, digits, number_of_runs};
use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::quantity::{Observable, Quantity};

/// Most combinations of extreme values that are checked; beyond, each value on its own.
const MOST_CORNERS: usize = 4096;

/// Combinations whose size is estimated, and the most work of a sweep, steps times unknowns of all
/// runs: about a day of one core.
const ESTIMATED: usize = 8;
const MOST_WORK: f64 = 1e14;

/// Most numbers of the results: 0.8 GB, and some three times as much as text.
const MOST_NUMBERS: f64 = 1e8;

/// Values of a variation up to which each is checked, not the extremes alone.
const FEW: usize = 256;

/// An error of a sweep before its first run.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SweepError {
    /// A variation cannot be used.
    #[error(transparent)]
    Variation(#[from] VariationError),
    /// A value cannot be set.
    #[error("{values}: {source}")]
    Set {
        /// The values tried.
        values: String,
        /// The error.
        source: SetError,
    },
    /// A combination of values is not a valid scenario.
    #[error("{values}: {source}")]
    Invalid {
        /// The values tried.
        values: String,
        /// The faults.
        source: InvalidDocument,
    },
    /// The results would take too much memory.
    #[error(
        "the sweep would take {runs} runs with {columns} numbers each; at most {:.0e} numbers are accepted",
        MOST_NUMBERS
    )]
    TooLarge {
        /// Number of runs.
        runs: usize,
        /// Numbers of a run.
        columns: usize,
    },
    /// The runs together would take too long.
    #[error(
        "the sweep would take {runs} runs of up to {work:.1e} steps times unknowns, {:.1e} in all; \
         at most {:.0e} are accepted",
        *runs as f64 * work, MOST_WORK
    )]
    TooLong {
        /// Number of runs.
        runs: usize,
        /// Steps times unknowns of the largest run that was estimated.
        work: f64,
    },
}

/// Checks the variations of a scenario, and returns the number of runs.
///
/// Bounds in a scenario are intervals, so of a long list of numbers the least and the greatest
/// are checked; a fault between them is the error of its run. Every value of a short list, and
/// every value that is not a number, is checked.
///
/// # Errors
/// [`SweepError`] when a combination is invalid, or the sweep too large.
pub(super) fn checked_runs(
    document: &Document,
    variations: &[Variation],
) -> Result<usize, SweepError> {
    let runs = number_of_runs(variations)?;
    let checked: Vec<Vec<&str>> = variations.iter().map(checked_values).collect();
    let corners = checked.iter().try_fold(1_usize, |n, list| n.checked_mul(list.len()));
    let combinations: Vec<Vec<&str>> = match corners {
        Some(corners) if corners <= MOST_CORNERS => {
            let chosen = |n| digits(n, checked.iter().map(Vec::len)).into_iter().zip(&checked);
            (0..corners).map(|n| chosen(n).map(|(at, list)| list[at]).collect()).collect()
        }
        _ => {
            let first: Vec<&str> = checked.iter().map(|list| list[0]).collect();
            let each = |v: usize| checked[v].iter().map(move |&value| (v, value));
            let with = |(v, value)| {
                let mut values = first.clone();
                values[v] = value;
                values
            };
            (0..checked.len()).flat_map(each).map(with).collect()
        }
    };
    let set = |values: &[&str]| {
        let mut changed = document.clone();
        let mut pairs = variations.iter().zip(values);
        pairs.try_for_each(|(variation, value)| changed.set(&variation.pointer, value))?;
        Ok::<Document, SetError>(changed)
    };
    combinations.par_iter().try_for_each(|values| {
        let named = || {
            let pairs = variations.iter().zip(values);
            let texts: Vec<String> =
                pairs.map(|(variation, value)| format!("{}={value}", variation.pointer)).collect();
            texts.join(", ")
        };
        let changed = set(values).map_err(|source| SweepError::Set { values: named(), source })?;
        let checked = changed.any_scenario();
        checked.map(|_| ()).map_err(|source| SweepError::Invalid { values: named(), source })
    })?;
    let every = combinations.len().div_ceil(ESTIMATED).max(1);
    let ends = combinations.iter().step_by(every).chain(combinations.last());
    let sizes = ends.filter_map(|values| size(&set(values).ok()?).ok());
    let largest = |a: (f64, usize), b: (f64, usize)| (a.0.max(b.0), a.1.max(b.1));
    let (work, observables) = sizes.fold((0.0, 0), largest);
    let columns = if observables == 0 { 0 } else { observables + variations.len() };
    if columns as f64 * runs as f64 > MOST_NUMBERS {
        return Err(SweepError::TooLarge { runs, columns });
    }
    if work * runs as f64 > MOST_WORK {
        return Err(SweepError::TooLong { runs, work });
    }
    Ok(runs)
}

/// Steps times unknowns of a run, and its number of observables; a run that cannot be set up has its
/// own error later.
fn size(document: &Document) -> Result<(f64, usize), SimulationError> {
    if document.has_matrices() {
        // Steps are chosen from modes, which take a reduction: samples are the least.
        let scenario: StructureScenario = serde_json::from_value(document.value().clone())
            .map_err(|error| SimulationError::Scenario(error.to_string()))?;
        let further = scenario.sensors.len() - 1;
        let interfaces = Observable::all(scenario.interfaces.len()).len();
        let observables = interfaces + further * Quantity::features().count();
        return Ok((scenario.duration_s * scenario.output_rate_hz, observables));
    }
    let scenario = serde_json::from_value(document.value().clone())
        .map_err(|error| SimulationError::Scenario(error.to_string()))?;
    let assembly = Assembly::new(&scenario, document.folder())?;
    let Assembly { structure, load, sampling, method, .. } = &assembly;
    let outline = method.outline(structure, load, sampling)?;
    let further = assembly.sensors.len() - 1;
    let observables =
        Observable::all(structure.contacts().len()).len() + further * Quantity::features().count();
    Ok((outline.steps as f64 * outline.unknowns as f64, observables))
}

/// The values of a variation that are checked.
fn checked_values(variation: &Variation) -> Vec<&str> {
    let values = &variation.values;
    let numbers: Option<Vec<f64>> =
        values.iter().map(|text| serde_json::from_str::<f64>(text).ok()).collect();
    let (Some(numbers), true) = (numbers, values.len() > FEW) else {
        return values.iter().map(String::as_str).collect();
    };
    let by = |a: &usize, b: &usize| numbers[*a].total_cmp(&numbers[*b]);
    let extremes = [(0..numbers.len()).min_by(by), (0..numbers.len()).max_by(by)];
    let mut checked: Vec<usize> = extremes.into_iter().flatten().collect();
    checked.dedup();
    checked.into_iter().map(|at| values[at].as_str()).collect()
}
