//! What came of a sweep.

use super::variation::Variation;
use crate::error::StudyError;
use asperity_table::CsvWriter;

/// The results of a sweep: for each run the numbers of its summary, or its error.
#[derive(Debug)]
pub struct Sweep {
    /// What was varied.
    pub variations: Vec<Variation>,
    /// Names of the numbers, those of [`Summary::names`](crate::summary::Summary::names).
    pub columns: Vec<String>,
    /// Runs in order, the last variation varying fastest; NaN where a summary has no number.
    pub runs: Vec<Result<Box<[f64]>, StudyError>>,
}

impl Sweep {
    /// Number `column` of `run`, if it has one.
    pub fn number(&self, run: usize, column: &str) -> Option<f64> {
        let column = self.columns.iter().position(|name| name == column)?;
        self.runs.get(run)?.as_ref().ok()?.get(column).copied().filter(|value| !value.is_nan())
    }

    /// The values that a run was given, in the order of the variations.
    pub fn values(&self, run: usize) -> Vec<&str> {
        let mut rest = run;
        let mut values: Vec<&str> = Vec::with_capacity(self.variations.len());
        for variation in self.variations.iter().rev() {
            values.push(&variation.values[rest % variation.values.len()]);
            rest /= variation.values.len();
        }
        values.reverse();
        values
    }

    /// Runs that failed, and why.
    pub fn failed(&self) -> impl Iterator<Item = (usize, &StudyError)> {
        self.runs
            .iter()
            .enumerate()
            .filter_map(|(run, outcome)| outcome.as_ref().err().map(|error| (run, error)))
    }

    /// `sweep.csv`: a row per run, the varied values, the summary's numbers, and the error of a
    /// run that failed.
    pub fn csv(&self) -> String {
        let pointers = self.variations.iter().map(|variation| variation.pointer.as_str());
        let names = pointers.chain(self.columns.iter().map(String::as_str)).chain(["error"]);
        let mut csv = CsvWriter::with_header(names);
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
            csv.end_row();
        }
        csv.into_string()
    }
}
