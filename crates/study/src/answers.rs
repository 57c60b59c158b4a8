//! Answers of a finished study: quantiles, exceedance probabilities, Sobol indices.

use std::collections::BTreeMap;

use asperity_sampling::{
    ColumnSummary, DesignError, Histogram, IntervalEstimate, SensitivitySums, SobolIndices,
    SummaryRequest, ValueColumn,
};
use asperity_simulation::quantity::{frf_frequency, unit_of};
use asperity_table::DataTable;
use serde_json::{Value, json};

use crate::error::StudyError;
use crate::folder::{Role, StudyFolder};
use crate::plan::StudyPlan;
use crate::spec::StudyDesign;
use crate::study_table::StudyTable;

/// Most different reasons of failure that are told apart.
const MOST_REASONS: usize = 100;

/// Deviation over the mean from which an output of a simulation varies by more than its numerical errors.
const RESOLVED: f64 = 1e-9;
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
    /// Answers of each observable but the receptances.
    pub observables: Vec<ObservableAnswers>,
    /// The receptance over frequency, of a study that has asked for it.
    pub frf: Option<FrfBand>,
    /// The [warning](StudyPlan::warning) about the inputs.
    pub warning: Option<String>,
}

/// Bands of the magnitude of the receptance over frequency, each frequency by itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FrfBand {
    /// Frequencies \[Hz\].
    pub frequency_hz: Vec<f64>,
    /// Number of runs with a value at each.
    pub runs: Vec<u64>,
    /// Magnitudes \[m/N\] at the probabilities 0.025, 0.25, 0.5, 0.75 and 0.975; NaN without a run.
    pub quantiles: Vec<[f64; 5]>,
}

impl FrfBand {
    /// Probabilities of the quantiles: ends of the bands of 95 % and 50 %, and the median.
    pub const PROBABILITIES: [f64; 5] = [0.025, 0.25, 0.5, 0.75, 0.975];

    fn add(&mut self, frequency: f64, found: &ObservableAnswers, runs: u64) {
        self.frequency_hz.push(frequency);
        self.runs.push(runs - found.missing);
        let mut quantiles = [f64::NAN; 5];
        for (quantile, (_, found)) in quantiles.iter_mut().zip(&found.quantiles) {
            *quantile = found.value;
        }
        self.quantiles.push(quantiles);
    }

    fn to_json(&self) -> Value {
        json!({
            "frequency_hz": self.frequency_hz,
            "runs": self.runs,
            "probabilities": Self::PROBABILITIES,
            "receptance_m_per_n": self.quantiles,
        })
    }

    /// The bands, a row for each frequency.
    pub fn table(&self) -> DataTable {
        let column = |at: usize| self.quantiles.iter().map(move |quantiles| quantiles[at]);
        DataTable::new()
            .numbers("frequency_hz", self.frequency_hz.iter().copied())
            .counts("runs", self.runs.iter().map(|&runs| count(runs)))
            .numbers("median_m_per_n", column(2))
            .numbers("lower_m_per_n", column(0))
            .numbers("upper_m_per_n", column(4))
            .numbers("lower_50_m_per_n", column(1))
            .numbers("upper_50_m_per_n", column(3))
    }
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
    /// Histogram between the quantiles at 0.005 and 0.995; none if they are equal.
    pub histogram: Option<Histogram>,
    /// Values over the whole range, each with the probability of values at or above it.
    pub exceedance_curve: Vec<(f64, IntervalEstimate)>,
}

impl ObservableAnswers {
    /// Unit; empty for a number without one.
    pub fn unit(&self) -> &'static str {
        unit_of(&self.name)
    }
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
                "unit": one.unit(),
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
            "warning": self.warning,
            "observables": self.observables.iter().map(observable).collect::<Vec<_>>(),
            "frf": self.frf.as_ref().map(FrfBand::to_json),
        })
    }

    /// The histograms: name, unit, edges, and number of runs, a row for each bin. The first and the last
    /// row of an observable are the runs beyond its bins, without the outer edge.
    pub fn histograms(&self) -> DataTable {
        let (mut names, mut units, mut runs) = (Vec::new(), Vec::new(), Vec::new());
        let (mut lower, mut upper) = (Vec::new(), Vec::new());
        for one in &self.observables {
            let Some(histogram) = &one.histogram else { continue };
            let edges = histogram.edges();
            let bins = histogram.counts.len();
            lower.extend([&[f64::NAN], &edges[..bins], &[histogram.high]].concat());
            upper.extend([&[histogram.low], &edges[1..], &[f64::NAN]].concat());
            runs.extend([&[histogram.below], &*histogram.counts, &[histogram.above]].concat());
            names.resize(runs.len(), one.name.clone());
            units.resize(runs.len(), one.unit().to_owned());
        }
        DataTable::new()
            .with("name", names)
            .with("unit", units)
            .with("lower", lower)
            .with("upper", upper)
            .counts("runs", runs.into_iter().map(count))
    }

    /// The exceedance curves: name, unit, value, probability of values at or above it, and ends of its
    /// interval.
    pub fn exceedance(&self) -> DataTable {
        let points = || {
            let of = |one| move |point| (one, point);
            self.observables.iter().flat_map(move |one| one.exceedance_curve.iter().map(of(one)))
        };
        DataTable::new()
            .texts("name", points().map(|(one, _)| one.name.as_str()))
            .texts("unit", points().map(|(one, _)| one.unit()))
            .numbers("value", points().map(|(_, (value, _))| *value))
            .numbers("probability", points().map(|(_, (_, share))| share.value))
            .numbers("low", points().map(|(_, (_, share))| share.low))
            .numbers("high", points().map(|(_, (_, share))| share.high))
    }
}

/// A number of runs, which are fewer than the address space has bytes.
fn count(runs: u64) -> usize {
    usize::try_from(runs).unwrap_or(usize::MAX)
}

/// The answers of a study whose table is complete.
///
/// The table is read column by column from the disk, in memory that does not grow with the number of
/// runs. Runs without an observable are left out of its statistics and counted; a base row of
/// Saltelli's design is left out of Sobol indices as a whole if one of its runs has no value. Quantiles
/// of Saltelli's design are the rows of its blocks A and B, whose rows are independent of each
/// other.
///
/// # Errors
/// [`StudyError::Missing`] for a study that is not complete, [`StudyError::Part`] for an
/// observable that it has not, [`StudyError::Design`] for probabilities that are not between 0 and
/// 1, [`StudyError::Foreign`] for a folder of another study, [`StudyError::Table`] for a damaged
/// table.
pub fn answers(
    plan: &StudyPlan,
    folder: &StudyFolder,
    options: &AnswerOptions,
) -> Result<StudyAnswers, StudyError> {
    folder.check_plan(plan)?;
    let table = folder.table()?;
    let names = folder.observables();
    for (name, _) in &options.thresholds {
        if !names.contains(name) {
            let fault = format!("no such observable; accepted: {}", names.join(", "));
            return Err(StudyError::Part { place: name.clone(), fault });
        }
    }
    if table.rows() != plan.rows() {
        let fault = format!("has {} rows; expected {}", table.rows(), plan.rows());
        return Err(table.fault(fault));
    }
    let (mut failed, mut reasons) = (0, BTreeMap::new());
    table.texts(table.place(Role::Error.key())?, &mut |reason| {
        failed += 1;
        if let Some(count) = reasons.get_mut(reason) {
            *count += 1;
        } else if reasons.len() < MOST_REASONS {
            reasons.insert(reason.to_owned(), 1);
        }
    })?;
    let of_bands = AnswerOptions {
        probabilities: FrfBand::PROBABILITIES.into(),
        thresholds: Vec::new(),
        ..options.clone()
    };
    let (mut observables, mut frf) = (Vec::new(), None);
    for name in &names {
        let frequency = frf_frequency(name);
        if let Some(frequency) = frequency {
            let found = of_observable(plan, &table, name, &of_bands)?;
            frf.get_or_insert_with(FrfBand::default).add(frequency, &found, table.rows());
        }
        if frequency.is_none() || options.thresholds.iter().any(|(of, _)| of == name) {
            let indices = sobol_indices(plan, &table, name, options.level)?;
            observables
                .push(ObservableAnswers { indices, ..of_observable(plan, &table, name, options)? });
        }
    }
    let warning = plan.warning().map(str::to_owned);
    Ok(StudyAnswers { runs: table.rows(), failed, reasons, observables, frf, warning })
}

/// Numbers of one observable, of the runs that are independent of each other.
struct ObservableColumn<'a> {
    table: &'a StudyTable,
    place: usize,
    name: &'a str,
    /// Runs of a base row of Saltelli's design, of which the first two count.
    block: Option<usize>,
}

/// An error of a column: of its statistics, or of reading.
enum ColumnError {
    Statistics(DesignError),
    Reading(StudyError),
}

impl From<DesignError> for ColumnError {
    fn from(error: DesignError) -> Self {
        Self::Statistics(error)
    }
}

impl ValueColumn for ObservableColumn<'_> {
    type Error = ColumnError;

    fn scan(&self, visit: &mut dyn FnMut(&[f64])) -> Result<(), ColumnError> {
        let Some(block) = self.block else {
            return self.table.numbers(self.place, visit).map_err(ColumnError::Reading);
        };
        let (mut row, mut kept) = (0, Vec::new());
        self.table
            .numbers(self.place, &mut |values| {
                kept.clear();
                for value in values {
                    if row % block < 2 {
                        kept.push(*value);
                    }
                    row += 1;
                }
                visit(&kept);
            })
            .map_err(ColumnError::Reading)
    }
}

fn of_observable(
    plan: &StudyPlan,
    table: &StudyTable,
    name: &str,
    options: &AnswerOptions,
) -> Result<ObservableAnswers, StudyError> {
    let place = table.place(name)?;
    let thresholds: Vec<f64> = options
        .thresholds
        .iter()
        .filter_map(|(of, threshold)| (of == name).then_some(*threshold))
        .collect();
    let asked = SummaryRequest {
        level: options.level,
        probabilities: options.probabilities.clone(),
        thresholds,
    };
    let block = saltelli_seed(plan).map(|_| plan.dimensions() + 2);
    let column = ObservableColumn { table, place, name, block };
    let summary = ColumnSummary::of(&column, &asked).map_err(|error| match error {
        ColumnError::Statistics(source) => {
            StudyError::Design { place: column.name.to_owned(), source }
        }
        ColumnError::Reading(error) => error,
    })?;
    let mut found = ObservableAnswers {
        name: name.to_owned(),
        missing: 0,
        mean: None,
        standard_deviation: None,
        quantiles: Vec::new(),
        exceedances: Vec::new(),
        indices: None,
        histogram: None,
        exceedance_curve: Vec::new(),
    };
    table.numbers(place, &mut |values| {
        found.missing += values.iter().filter(|value| value.is_nan()).count() as u64;
    })?;
    let Some(summary) = summary else { return Ok(found) };
    found.mean = Some(summary.mean);
    found.standard_deviation = Some(summary.standard_deviation);
    found.quantiles = asked.probabilities.into_iter().zip(summary.quantiles).collect();
    found.exceedances = asked.thresholds.into_iter().zip(summary.exceedances).collect();
    found.histogram = summary.histogram;
    found.exceedance_curve = summary.exceedance_curve;
    Ok(found)
}

/// The seed of Saltelli's design; none for another design.
fn saltelli_seed(plan: &StudyPlan) -> Option<u64> {
    match plan.spec().design {
        StudyDesign::Saltelli { seed, .. } => Some(seed),
        _ => None,
    }
}

/// Sobol indices of an observable; none for another design, or an observable that does not vary.
fn sobol_indices(
    plan: &StudyPlan,
    table: &StudyTable,
    name: &str,
    level: f64,
) -> Result<Option<SobolIndices>, StudyError> {
    let Some(seed) = saltelli_seed(plan) else { return Ok(None) };
    let design_fault = |source| StudyError::Design { place: name.to_owned(), source };
    let mut sums =
        SensitivitySums::new(plan.dimensions(), REPLICATES, seed).map_err(design_fault)?;
    let block = plan.dimensions() + 2;
    let (mut base, mut row) = (0, Vec::with_capacity(block));
    table.numbers(table.place(name)?, &mut |values| {
        for value in values {
            row.push(*value);
            if row.len() == block {
                sums.add(base, &row);
                base += 1;
                row.clear();
            }
        }
    })?;
    let found = sums.indices(level).ok();
    Ok(found.filter(|found| found.variance > (RESOLVED * found.mean).powi(2)))
}
