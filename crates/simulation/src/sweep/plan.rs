//! The scenarios of a sweep, checked before the first run.

use std::path::Path;

use asperity_structure::PreloadedContact;
use rayon::prelude::*;
use serde_json::{Value, json};
use thiserror::Error;

use super::variation::{Variation, VariationError, chosen_values, digits, number_of_runs};
use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::quantity::observable_names;
use asperity_scenario::{Document, ExcitationSpec, InvalidDocument, Scenario, SetError, set_value};

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

/// The variations and the scenario they apply to.
#[derive(Debug)]
pub(super) struct Plan<'a> {
    document: &'a Document,
    variations: &'a [Variation],
    /// Marks variations of the force alone.
    force_only: Vec<bool>,
    runs: usize,
}

impl<'a> Plan<'a> {
    /// Checks the variations.
    ///
    /// Bounds in a scenario are intervals, so of a long list of numbers the least and the greatest
    /// are checked; a fault between them is the error of its run. Every value of a short list, and
    /// every value that is not a number, is checked.
    pub(super) fn new(
        document: &'a Document,
        variations: &'a [Variation],
    ) -> Result<Self, SweepError> {
        let runs = number_of_runs(variations)?;
        let of_force = |variation: &Variation| {
            variation.pointer == "/excitation" || variation.pointer.starts_with("/excitation/")
        };
        let plan = Self {
            document,
            variations,
            force_only: variations.iter().map(of_force).collect(),
            runs,
        };
        let checked: Vec<Vec<usize>> = variations.iter().map(checked_values).collect();
        let corners = checked.iter().try_fold(1_usize, |n, list| n.checked_mul(list.len()));
        let combinations: Vec<Vec<usize>> = match corners {
            Some(corners) if corners <= MOST_CORNERS => {
                (0..corners).map(|n| digits(n, checked.iter().map(Vec::len))).collect()
            }
            _ => (0..checked.len())
                .flat_map(|v| {
                    let count = checked.len();
                    (0..checked[v].len()).map(move |n| {
                        let mut at = vec![0; count];
                        at[v] = n;
                        at
                    })
                })
                .collect(),
        };
        let chosen = |at: &Vec<usize>| -> Vec<usize> {
            at.iter().zip(&checked).map(|(&n, list)| list[n]).collect()
        };
        combinations.par_iter().try_for_each(|at| plan.check(&chosen(at)))?;
        let every = combinations.len().div_ceil(ESTIMATED).max(1);
        let ends = combinations.iter().step_by(every).chain(combinations.last());
        let sizes = ends.filter_map(|at| plan.size(&chosen(at)).ok());
        let largest = |a: (f64, usize), b: (f64, usize)| (a.0.max(b.0), a.1.max(b.1));
        let (work, columns) = sizes.fold((0.0, 0), largest);
        if columns as f64 * runs as f64 > MOST_NUMBERS {
            return Err(SweepError::TooLarge { runs, columns });
        }
        if work * runs as f64 > MOST_WORK {
            return Err(SweepError::TooLong { runs, work });
        }
        Ok(plan)
    }

    /// Steps times unknowns of a run, and the numbers of its row; a run that cannot be set up has its
    /// own error later.
    fn size(&self, chosen: &[usize]) -> Result<(f64, usize), SimulationError> {
        let assembly = Assembly::new(&self.scenario(chosen)?, self.folder())?;
        let Assembly { structure, excitation, sampling, method, .. } = &assembly;
        let outline = method.outline(structure, excitation, sampling)?;
        let names: Vec<&str> = structure.contacts().iter().map(PreloadedContact::name).collect();
        let columns = observable_names(&names).len() + self.variations.len();
        Ok((outline.steps as f64 * outline.unknowns as f64, columns))
    }

    pub(super) fn runs(&self) -> usize {
        self.runs
    }

    pub(super) fn folder(&self) -> &Path {
        self.document.folder()
    }

    /// Number of the value of each variation in a run, the last varying fastest.
    pub(super) fn chosen(&self, run: usize) -> Vec<usize> {
        chosen_values(run, self.variations)
    }

    /// The values in `chosen` that vary more than the force: runs that share them share a prepared
    /// scenario.
    pub(super) fn structure(&self, chosen: &[usize]) -> Vec<usize> {
        let kept = chosen.iter().zip(&self.force_only).filter(|(_, force)| !**force);
        kept.map(|(&value, _)| value).collect()
    }

    /// The document of a run.
    pub(super) fn document(&self, chosen: &[usize]) -> Result<Document, SetError> {
        let mut document = self.document.clone();
        for (variation, &value) in self.variations.iter().zip(chosen) {
            document.set(&variation.pointer, &variation.values[value])?;
        }
        Ok(document)
    }

    /// The scenario of a run, whose values have been checked.
    pub(super) fn scenario(&self, chosen: &[usize]) -> Result<Scenario, SimulationError> {
        let document = self.document(chosen)?;
        serde_json::from_value(document.value().clone())
            .map_err(|error| SimulationError::Scenario(error.to_string()))
    }

    /// The force of a run.
    pub(super) fn excitation(&self, chosen: &[usize]) -> Result<ExcitationSpec, SimulationError> {
        let mut part = match self.document.value().get("excitation") {
            Some(excitation) => json!({ "excitation": excitation }),
            None => json!({}),
        };
        let varied = self.variations.iter().zip(chosen).zip(&self.force_only);
        for ((variation, &value), _) in varied.filter(|(_, force)| **force) {
            set_value(&mut part, &variation.pointer, &variation.values[value])?;
        }
        let excitation = part.get_mut("excitation").map(Value::take).unwrap_or_default();
        serde_json::from_value(excitation)
            .map_err(|error| SimulationError::Scenario(error.to_string()))
    }

    fn check(&self, chosen: &[usize]) -> Result<(), SweepError> {
        let named = || {
            let pairs = self.variations.iter().zip(chosen);
            let texts: Vec<String> =
                pairs.map(|(v, &value)| format!("{}={}", v.pointer, v.values[value])).collect();
            texts.join(", ")
        };
        let document =
            self.document(chosen).map_err(|source| SweepError::Set { values: named(), source })?;
        document.scenario().map_err(|source| SweepError::Invalid { values: named(), source })?;
        Ok(())
    }
}

/// The values of a variation that are checked.
fn checked_values(variation: &Variation) -> Vec<usize> {
    let values = &variation.values;
    let numbers: Option<Vec<f64>> =
        values.iter().map(|text| serde_json::from_str::<f64>(text).ok()).collect();
    let (Some(numbers), true) = (numbers, values.len() > FEW) else {
        return (0..values.len()).collect();
    };
    let by = |a: &usize, b: &usize| numbers[*a].total_cmp(&numbers[*b]);
    let extremes = [(0..numbers.len()).min_by(by), (0..numbers.len()).max_by(by)];
    let mut checked: Vec<usize> = extremes.into_iter().flatten().collect();
    checked.dedup();
    checked
}
