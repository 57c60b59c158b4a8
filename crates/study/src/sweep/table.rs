//! The results of a sweep.

use super::variation::{Variation, chosen_values};
use crate::error::StudyError;
use crate::warning::Warning;
use asperity_table::CsvWriter;

/// The results of a sweep: for each run the numbers of its summary, or its error.
#[derive(Debug)]
pub struct Sweep {
    /// The variations.
    pub variations: Vec<Variation>,
    /// Names of the observables, as [`observable_names`](crate::quantity::observable_names) orders
    /// them.
    pub columns: Vec<String>,
    /// Runs in order, the last variation varying fastest: values of the observables, NaN where a
    /// response has none.
    pub runs: Vec<Result<Box<[f64]>, StudyError>>,
    /// Warnings, each with the number of its run, in order.
    pub warnings: Vec<(usize, Warning)>,
}

impl Sweep {
    /// Number `column` of `run`, if it has one.
    pub fn number(&self, run: usize, column: &str) -> Option<f64> {
        let column = self.columns.iter().position(|name| name == column)?;
        self.runs.get(run)?.as_ref().ok()?.get(column).copied().filter(|value| !value.is_nan())
    }

    /// The values that a run was given, in the order of the variations.
    pub fn values(&self, run: usize) -> Vec<&str> {
        let chosen = chosen_values(run, &self.variations).into_iter();
        chosen.zip(&self.variations).map(|(at, variation)| variation.values[at].as_str()).collect()
    }

    /// Runs that failed, with their errors.
    pub fn failed(&self) -> impl Iterator<Item = (usize, &StudyError)> {
        self.runs
            .iter()
            .enumerate()
            .filter_map(|(run, outcome)| outcome.as_ref().err().map(|error| (run, error)))
    }

    /// Kinds of warnings in the order of their first run, and the number of runs with each.
    pub fn warning_counts(&self) -> Vec<(&'static str, usize)> {
        let mut counts: Vec<(&'static str, usize, usize)> = Vec::new();
        for (run, warning) in &self.warnings {
            match counts.iter_mut().find(|(kind, ..)| *kind == warning.kind()) {
                // Two interfaces of one run count once.
                Some((.., last)) if last == run => {}
                Some((_, count, last)) => (*count, *last) = (*count + 1, *run),
                None => counts.push((warning.kind(), 1, *run)),
            }
        }
        counts.into_iter().map(|(kind, count, _)| (kind, count)).collect()
    }

    /// `sweep.csv`: a row per run with the varied values, the observables, the error of a run that
    /// failed, and the kinds of warnings about the others.
    pub fn csv(&self) -> String {
        let pointers = self.variations.iter().map(|variation| variation.pointer.as_str());
        let names =
            pointers.chain(self.columns.iter().map(String::as_str)).chain(["error", "warnings"]);
        let mut csv = CsvWriter::with_header(names);
        let mut warnings = self.warnings.iter().peekable();
        for (run, outcome) in self.runs.iter().enumerate() {
            for value in self.values(run) {
                csv.text(value);
            }
            match outcome {
                Ok(numbers) => csv.numbers(numbers.iter().copied()).text(""),
                Err(error) => {
                    csv.numbers(self.columns.iter().map(|_| None)).text(&error.to_string())
                }
            };
            let mut kinds: Vec<&str> = Vec::new();
            while let Some((_, warning)) = warnings.next_if(|(of, _)| *of == run) {
                kinds.push(warning.kind());
            }
            kinds.dedup();
            csv.text(&kinds.join(" ")).end_row();
        }
        csv.into_string()
    }
}
