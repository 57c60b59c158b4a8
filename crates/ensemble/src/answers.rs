//! Answers of a finished study: quantiles, exceedance probabilities, Sobol indices.

use std::collections::BTreeMap;

use asperity_design::{IntervalEstimate, SensitivitySums, SobolIndices, WeightedSample};

use asperity_study::quantity::Quantity;
use serde_json::{Value, json};

use crate::error::EnsembleError;
use crate::folder::StudyFolder;
use crate::plan::StudyPlan;
use crate::spec::StudyDesign;

/// Most numbers of a study that is summarised: 0.8 GB.
const MOST_NUMBERS: u64 = 100_000_000;

/// Most different reasons of failure that are told apart.
const MOST_REASONS: usize = 100;

/// Bootstrap replicates of Sobol indices.
const REPLICATES: usize = 500;

/// Settings of the answers.
#[derive(Debug, Clone, PartialEq)]
pub struct AnswerOptions {
    /// Confidence level of intervals.
    pub level: f64,
    /// Probabilities of the quantiles.
    pub probabilities: Vec<f64>,
    /// Observables, each with a threshold that it may exceed.
    pub thresholds: Vec<(String, f64)>,
}

impl Default for AnswerOptions {
    /// Level 0.95; quantiles at 0.05, 0.25, 0.5, 0.75 and 0.95; no thresholds.
    fn default() -> Self {
        Self {
            level: 0.95,
            probabilities: vec![0.05, 0.25, 0.5, 0.75, 0.95],
            thresholds: Vec::new(),
        }
    }
}

/// Answers of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyAnswers {
    /// Number of runs.
    pub runs: u64,
    /// Runs that failed.
    pub failed: u64,
    /// Reasons of failures with the number of runs of each, of at most 100 reasons.
    pub reasons: BTreeMap<String, u64>,
    /// Answers of each observable.
    pub observables: Vec<ObservableAnswers>,
}

/// Answers of one observable, over the runs that have it.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservableAnswers {
    /// Name.
    pub name: String,
    /// Runs without it, those that failed included.
    pub missing: u64,
    /// Mean; none without a run that has the observable.
    pub mean: Option<f64>,
    /// Standard deviation.
    pub standard_deviation: Option<f64>,
    /// Probabilities with their quantiles.
    pub quantiles: Vec<(f64, IntervalEstimate)>,
    /// Thresholds with the probabilities of values above them.
    pub exceedances: Vec<(f64, IntervalEstimate)>,
    /// Sobol indices in the order of the inputs, for Saltelli's design and an observable that varies.
    pub indices: Option<SobolIndices>,
}

impl StudyAnswers {
    /// The answers as JSON; an end of an interval that is not bounded is null.
    pub fn to_json(&self, inputs: &[String]) -> Value {
        let interval = |one: &IntervalEstimate| json!([one.low, one.high]);
        let estimates = |key: &str, all: &[(f64, IntervalEstimate)]| {
            let of = |(at, one): &(f64, IntervalEstimate)| json!({ key: at, "value": one.value, "interval": interval(one) });
            all.iter().map(of).collect::<Vec<_>>()
        };
        let indices = |found: &SobolIndices| {
            let pairs = found.first.iter().zip(&found.total).zip(inputs);
            let of =
                |((first, total), input): ((&IntervalEstimate, &IntervalEstimate), &String)| {
                    json!({
                        "input": input,
                        "first": first.value, "first_interval": interval(first),
                        "total": total.value, "total_interval": interval(total),
                    })
                };
            json!({
                "base_rows": found.used,
                "base_rows_left_out": found.left_out,
                "inputs": pairs.map(of).collect::<Vec<_>>(),
            })
        };
        let observable = |one: &ObservableAnswers| {
            json!({
                "name": one.name,
                "unit": Quantity::of_name(&one.name).map_or("", |(quantity, _)| quantity.unit()),
                "runs_without": one.missing,
                "mean": one.mean,
                "standard_deviation": one.standard_deviation,
                "quantiles": estimates("probability", &one.quantiles),
                "exceedances": estimates("above", &one.exceedances),
                "sobol_indices": one.indices.as_ref().map(indices),
            })
        };
        json!({
            "schema": "asperity/study-answers/1",
            "runs": self.runs,
            "failed": self.failed,
            "reasons": self.reasons,
            "observables": self.observables.iter().map(observable).collect::<Vec<_>>(),
        })
    }
}

/// The answers of a study whose table is complete.
///
/// Runs without an observable are left out of its statistics and counted; a base row of Saltelli's
/// design is left out of Sobol indices as a whole if one of its runs has no value. Quantiles of
/// Saltelli's design are those of its blocks A and B, whose rows are independent of each other.
///
/// # Errors
/// [`EnsembleError::Missing`] for a study that is not complete, [`EnsembleError::Part`] for an
/// observable that it has not and for more than 1e8 numbers, [`EnsembleError::Design`] for
/// probabilities that are not between 0 and 1, [`EnsembleError::Foreign`] for a folder of another
/// study, [`EnsembleError::Chunk`] for a damaged table.
pub fn answers(
    plan: &StudyPlan,
    folder: &StudyFolder,
    options: &AnswerOptions,
) -> Result<StudyAnswers, EnsembleError> {
    folder.check_plan(plan)?;
    let table = folder.table()?;
    let inputs = plan.names().len();
    let damaged = |fault: String| EnsembleError::Chunk { file: table.clone(), fault };
    let mut reader = csv::Reader::from_path(&table).map_err(|error| damaged(error.to_string()))?;
    let header = reader.headers().map_err(|error| damaged(error.to_string()))?.clone();
    let names: Vec<&str> =
        header.iter().skip(inputs).take(header.len().saturating_sub(inputs + 2)).collect();
    for (name, _) in &options.thresholds {
        if !names.contains(&name.as_str()) {
            let fault = format!("no such observable; accepted: {}", names.join(", "));
            return Err(EnsembleError::Part { place: name.clone(), fault });
        }
    }
    let numbers = plan.rows().saturating_mul(names.len() as u64);
    if numbers > MOST_NUMBERS {
        let fault = format!("{numbers} numbers; at most {MOST_NUMBERS} are summarised");
        return Err(EnsembleError::Part { place: "study.csv".into(), fault });
    }
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    let (mut failed, mut reasons) = (0, BTreeMap::new());
    for row in reader.records() {
        let row = row.map_err(|error| damaged(error.to_string()))?;
        for (column, field) in columns.iter_mut().zip(row.iter().skip(inputs)) {
            column.push(if field.is_empty() {
                f64::NAN
            } else {
                field.parse().unwrap_or(f64::NAN)
            });
        }
        let reason = row.get(inputs + names.len()).unwrap_or_default();
        if !reason.is_empty() {
            failed += 1;
            if reasons.len() < MOST_REASONS || reasons.contains_key(reason) {
                *reasons.entry(reason.to_owned()).or_insert(0) += 1;
            }
        }
    }
    let runs = columns.first().map_or(0, Vec::len) as u64;
    if runs != plan.rows() {
        return Err(damaged(format!("has {runs} rows; expected {}", plan.rows())));
    }
    let observables =
        names.iter().zip(&columns).map(|(name, values)| of_observable(plan, name, values, options));
    Ok(StudyAnswers { runs, failed, reasons, observables: observables.collect::<Result<_, _>>()? })
}

fn of_observable(
    plan: &StudyPlan,
    name: &str,
    values: &[f64],
    options: &AnswerOptions,
) -> Result<ObservableAnswers, EnsembleError> {
    let fail = |source| EnsembleError::Design { place: name.to_owned(), source };
    let block = plan.dimensions() + 2;
    let saltelli = match plan.spec().design {
        StudyDesign::Saltelli { seed, .. } => Some(seed),
        _ => None,
    };
    let independent = |at: &usize| saltelli.is_none() || at % block < 2;
    let kept = values.iter().enumerate().filter(|(at, _)| independent(at)).map(|(_, value)| *value);
    let missing = values.iter().filter(|value| value.is_nan()).count() as u64;
    let mut found = ObservableAnswers {
        name: name.to_owned(),
        missing,
        mean: None,
        standard_deviation: None,
        quantiles: Vec::new(),
        exceedances: Vec::new(),
        indices: None,
    };
    let Ok(sample) = WeightedSample::of_equal(kept) else { return Ok(found) };
    found.mean = Some(sample.mean());
    found.standard_deviation = Some(sample.standard_deviation());
    for &probability in &options.probabilities {
        let quantile = sample.quantile(probability, options.level).map_err(fail)?;
        found.quantiles.push((probability, quantile));
    }
    for (_, threshold) in options.thresholds.iter().filter(|(of, _)| of == name) {
        let exceedance = sample.exceedance(*threshold, options.level).map_err(fail)?;
        found.exceedances.push((*threshold, exceedance));
    }
    if let Some(seed) = saltelli {
        let mut sums = SensitivitySums::new(plan.dimensions(), REPLICATES, seed).map_err(fail)?;
        for (base, values) in (0..).zip(values.chunks_exact(block)) {
            sums.add(base, values);
        }
        // An observable that does not vary has no indices.
        found.indices = sums.indices(options.level).ok();
    }
    Ok(found)
}
