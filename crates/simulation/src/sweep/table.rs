//! The results of a sweep.

use super::variation::{Variation, chosen_values};
use crate::error::SimulationError;
use crate::warning::Warning;
use asperity_table::{CsvWriter, DataTable};

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
    pub runs: Vec<Result<Box<[f64]>, SimulationError>>,
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
        chosen_values(run, &self.variations)
    }

    /// Runs that failed, with their errors.
    pub fn failed(&self) -> impl Iterator<Item = (usize, &SimulationError)> {
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

    /// Kinds of the warnings of each run, separated by blanks.
    fn warning_kinds(&self) -> impl Iterator<Item = String> + '_ {
        let mut warnings = self.warnings.iter().peekable();
        (0..self.runs.len()).map(move |run| {
            let mut kinds: Vec<&str> = Vec::new();
            while let Some((_, warning)) = warnings.next_if(|(of, _)| *of == run) {
                kinds.push(warning.kind());
            }
            kinds.dedup();
            kinds.join(" ")
        })
    }

    /// The columns of `sweep.csv`: the values of the variations as texts, the numbers, `error` and
    /// `warnings`.
    pub fn table(&self) -> DataTable {
        let mut table = DataTable::new();
        let chosen: Vec<Vec<&str>> = (0..self.runs.len()).map(|run| self.values(run)).collect();
        for (at, variation) in self.variations.iter().enumerate() {
            let texts = chosen.iter().map(|chosen| chosen[at].to_owned());
            table = table.with(&variation.pointer, texts.collect::<Vec<String>>());
        }
        for (at, name) in self.columns.iter().enumerate() {
            let number = |run: &Result<Box<[f64]>, _>| run.as_ref().map_or(f64::NAN, |row| row[at]);
            table = table.with(name, self.runs.iter().map(number).collect::<Vec<f64>>());
        }
        let error = |run: &Result<_, SimulationError>| {
            run.as_ref().err().map(ToString::to_string).unwrap_or_default()
        };
        table
            .with("error", self.runs.iter().map(error).collect::<Vec<String>>())
            .with("warnings", self.warning_kinds().collect::<Vec<String>>())
    }

    /// `sweep.csv`: a row per run.
    pub fn csv(&self) -> String {
        let pointers = self.variations.iter().map(|variation| variation.pointer.as_str());
        let names =
            pointers.chain(self.columns.iter().map(String::as_str)).chain(["error", "warnings"]);
        let mut csv = CsvWriter::with_header(names);
        let warnings = self.warning_kinds();
        for ((run, outcome), kinds) in self.runs.iter().enumerate().zip(warnings) {
            for value in self.values(run) {
                csv.text(value);
            }
            match outcome {
                Ok(numbers) => csv.numbers(numbers.iter().copied()).text(""),
                Err(error) => {
                    csv.numbers(self.columns.iter().map(|_| None)).text(&error.to_string())
                }
            };
            csv.text(&kinds).end_row();
        }
        csv.into_string()
    }
}
