//! Rows of inputs: of a design and distributions, or from a file.

use std::ops::Range;
use std::path::Path;

use asperity_sampling::{
    Correlation, Design, DesignError, Distribution, InputSpace, WeightedDraws,
};
use serde_json::{Value, json};

use super::table::{TableColumn, TableRows};
use crate::error::StudyError;
use crate::spec::{
    CorrelationKind, CorrelationSpec, DistributionSpec, InputSpec, StudyDesign, StudySpec,
};

/// Rows of inputs.
#[derive(Debug, Clone)]
pub(super) enum InputRows {
    /// Points of a design, brought to the inputs by their distributions.
    Designed {
        inputs: InputSpace,
        design: Design,
        /// Values of the options of each input that is a choice.
        options: Vec<Option<Vec<Value>>>,
    },
    /// Rows of a file.
    Table(TableRows),
}

impl InputRows {
    /// Rows of the study file `spec` in `folder`, whose inputs have `draws` besides.
    pub(super) fn new(
        folder: &Path,
        spec: &StudySpec,
        draws: Option<WeightedDraws>,
    ) -> Result<Self, StudyError> {
        let dimensions = spec.inputs.len() + usize::from(draws.is_some());
        let design = match &spec.design {
            StudyDesign::Table { file, rows } => {
                let columns = table_columns(spec)?;
                return Ok(Self::Table(TableRows::read(folder.join(file), columns, *rows)?));
            }
            StudyDesign::Grid { levels } if levels.len() != dimensions => {
                return Err(StudyError::Part {
                    place: "/design/levels".into(),
                    fault: format!("{} numbers; expected {dimensions}, one an input", levels.len()),
                });
            }
            StudyDesign::Grid { levels } => Design::grid(levels.clone()),
            StudyDesign::Random { rows, seed } => Design::random(dimensions, *rows, *seed),
            StudyDesign::LatinHypercube { rows, seed } => {
                Design::latin_hypercube(dimensions, *rows, *seed)
            }
            StudyDesign::Sobol { rows, seed } => Design::sobol(dimensions, *rows, *seed),
            StudyDesign::Saltelli { base_rows, seed } => {
                Design::saltelli(dimensions, *base_rows, *seed)
            }
        };
        let mut distributions = Vec::new();
        for (number, input) in spec.inputs.iter().enumerate() {
            let Some(given) = &input.distribution else {
                let accepted = "accepted: a distribution, or a design of kind table";
                let fault = format!("there is none; {accepted}");
                return Err(StudyError::Part { place: distribution_place(number), fault });
            };
            distributions.push(distribution(given).map_err(at(&distribution_place(number)))?);
        }
        let correlation = spec
            .correlation
            .as_ref()
            .map(correlation)
            .transpose()
            .map_err(at("/correlation/matrix"))?;
        let inputs = InputSpace::new(distributions, correlation, draws).map_err(at("/inputs"))?;
        let design = design.map_err(at("/design"))?;
        if matches!(spec.design, StudyDesign::Saltelli { .. }) && inputs.is_correlated() {
            return Err(StudyError::Part {
                place: "/design".into(),
                fault:
                    "Sobol indices are defined for independent inputs; accepted: another design, \
                        or no correlation"
                        .into(),
            });
        }
        Ok(Self::Designed { inputs, design, options: spec.inputs.iter().map(options).collect() })
    }

    /// Number of rows.
    pub(super) fn count(&self) -> u64 {
        match self {
            Self::Designed { design, .. } => design.rows(),
            Self::Table(table) => table.rows(),
        }
    }

    /// SHA-256 of the file of rows.
    pub(super) fn sha256(&self) -> Option<&str> {
        match self {
            Self::Designed { .. } => None,
            Self::Table(table) => Some(table.sha256()),
        }
    }

    /// The inputs of some rows.
    pub(super) fn values(&self, rows: Range<u64>) -> Result<Vec<Vec<Value>>, StudyError> {
        match self {
            Self::Designed { inputs, design, options } => {
                let options = || options.iter().map(Option::as_ref).chain(std::iter::repeat(None));
                let value = |(value, options): (f64, Option<&Vec<Value>>)| match options {
                    Some(options) => options[(value as usize).min(options.len() - 1)].clone(),
                    None => json!(value),
                };
                let of_row = |row| {
                    let values = inputs.values(&design.point(row));
                    values.into_iter().zip(options()).map(value).collect()
                };
                Ok(rows.map(of_row).collect())
            }
            Self::Table(table) => table.values(rows),
        }
    }
}

/// Values of an input that is a choice.
pub(super) fn options(input: &InputSpec) -> Option<Vec<Value>> {
    match &input.distribution {
        Some(DistributionSpec::Choice { values, .. }) => Some(values.clone()),
        _ => None,
    }
}

fn distribution_place(number: usize) -> String {
    format!("/inputs/{number}/distribution")
}

fn at(place: &str) -> impl FnOnce(DesignError) -> StudyError + use<> {
    let place = place.to_owned();
    |source| StudyError::Design { place, source }
}

/// The columns of a table, after a check that the study asks for nothing that a table has not.
fn table_columns(spec: &StudySpec) -> Result<Vec<TableColumn>, StudyError> {
    let part = |place: &str, fault: &str| {
        Err(StudyError::Part { place: place.to_owned(), fault: fault.to_owned() })
    };
    if spec.inputs.is_empty() {
        return part("/inputs", "there are none; accepted: an input for each column that is used");
    }
    if spec.correlation.is_some() {
        return part("/correlation", "the rows of a table are given; accepted: no correlation");
    }
    if spec.draws.is_some() {
        return part("/draws", "the rows of a table are given; accepted: no draws");
    }
    for (number, input) in spec.inputs.iter().enumerate() {
        if input.distribution.is_some() && options(input).is_none() {
            let place = distribution_place(number);
            return part(&place, "the rows of a table are given; accepted: none, or a choice");
        }
    }
    let column = |input: &InputSpec| {
        let names = input.name.iter().chain([&input.pointer]).cloned().collect();
        TableColumn { names, options: options(input) }
    };
    Ok(spec.inputs.iter().map(column).collect())
}

fn correlation(given: &CorrelationSpec) -> Result<Correlation, DesignError> {
    match given.kind {
        CorrelationKind::Rank => Correlation::of_ranks(&given.matrix),
        CorrelationKind::NormalScores => Correlation::of_scores(&given.matrix),
    }
}

fn distribution(given: &DistributionSpec) -> Result<Distribution, DesignError> {
    match given {
        DistributionSpec::Uniform { lower, upper } => Distribution::uniform(*lower, *upper),
        DistributionSpec::LogUniform { lower, upper } => Distribution::log_uniform(*lower, *upper),
        DistributionSpec::Normal { mean, standard_deviation } => {
            Distribution::normal(*mean, *standard_deviation)
        }
        DistributionSpec::Lognormal { median, log_standard_deviation } => {
            Distribution::lognormal(*median, *log_standard_deviation)
        }
        DistributionSpec::Triangular { lower, mode, upper } => {
            Distribution::triangular(*lower, *mode, *upper)
        }
        DistributionSpec::Choice { values, weights: None } => {
            Distribution::choice(&vec![1.0; values.len()])
        }
        DistributionSpec::Choice { values, weights: Some(weights) } => {
            if values.len() != weights.len() {
                return Err(DesignError::Count {
                    quantity: "the number of weights",
                    value: weights.len() as u64,
                    least: values.len() as u64,
                    most: values.len() as u64,
                });
            }
            Distribution::choice(weights)
        }
    }
}
