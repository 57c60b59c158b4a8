//! Why a problem is none, or has no answer.

use std::path::PathBuf;

use asperity_inference::IdentifyError;
use thiserror::Error;

use asperity_experiment::AnalysisError;
use asperity_scenario::{DocumentError, InputError, InvalidDocument, SetError};
use asperity_study::error::StudyError;
use asperity_study::parameter::ParameterError;

/// Why an identification cannot be set up or carried out.
#[derive(Debug, Error)]
pub enum ProblemError {
    /// The problem's text, or that of its scenario, cannot be read.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The problem, or its scenario, is not valid.
    #[error(transparent)]
    Invalid(#[from] InvalidDocument),
    /// A pointer leads to no parameter of the scenario.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Two unknowns are one number of the scenario, or data set what is unknown.
    #[error("{pointer} is unknown, and {by}")]
    Contradiction {
        /// The pointer.
        pointer: String,
        /// What else gives it.
        by: String,
    },
    /// A law that is not there, or has no stiffnesses at points.
    #[error(
        "there are no stiffnesses at knots or points in a law \"{law}\"; expected the name of a modified_power or table law in \"laws\""
    )]
    NotMonotone {
        /// The name.
        law: String,
    },
    /// A law that is not there.
    #[error("there is no law \"{law}\"; in \"laws\" there are: {known}")]
    NoLaw {
        /// The name.
        law: String,
        /// The names that there are.
        known: String,
    },
    /// A prior that is no distribution.
    #[error("the prior of \"{unknown}\": {reason}")]
    Prior {
        /// The unknown.
        unknown: String,
        /// What is expected.
        reason: &'static str,
    },
    /// A gain for data that are not there.
    #[error("a gain holds for the data \"{name}\"; there are: {known}")]
    NoData {
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A feature that no summary has.
    #[error("{place}: there is no feature \"{feature}\"; expected one of: {known}")]
    Feature {
        /// The data.
        place: String,
        /// The feature.
        feature: String,
        /// The features that there are.
        known: String,
    },
    /// A feature without standard deviation.
    #[error(
        "{place}: {feature} has no standard deviation; give it with the value, or a floor for {feature}"
    )]
    NoDeviation {
        /// The data.
        place: String,
        /// The feature.
        feature: String,
    },
    /// Two data say different things about one number.
    #[error(
        "{place}: {feature} of one hit is given as {first} and as {second}, which are {apart:.1} standard deviations apart"
    )]
    Contradictory {
        /// The data.
        place: String,
        /// The feature.
        feature: String,
        /// A value.
        first: f64,
        /// Another.
        second: f64,
        /// Their distance in standard deviations.
        apart: f64,
    },
    /// A number of the data that is out of range.
    #[error("{place}: {quantity} is {value}; expected {expected}")]
    Value {
        /// The data.
        place: String,
        /// What it is.
        quantity: &'static str,
        /// The number.
        value: f64,
        /// What is accepted.
        expected: &'static str,
    },
    /// A peak force for a scenario whose force has none.
    #[error(
        "{place}: the scenario's excitation has no peak_n to set; expected a gamma_pulse, half_sine, haversine or samples"
    )]
    NoPeak {
        /// The data.
        place: String,
    },
    /// A file of data that cannot be read.
    #[error("{}: {source}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// Why.
        source: InputError,
    },
    /// A file of data that does not hold what it should.
    #[error("{}: {problem}; expected {expected}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        problem: String,
        /// What is accepted.
        expected: &'static str,
    },
    /// Records that cannot be read as hits.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A design for data without features of hits.
    #[error(
        "{}: /design: there are no features of hits whose uncertainty a planned hit would have; expected data of the kind hits or analysis",
        path.display()
    )]
    Design {
        /// The problem.
        path: PathBuf,
    },
    /// A value cannot be set.
    #[error("{place}: {source}")]
    Set {
        /// The data or the candidate.
        place: String,
        /// Why.
        source: SetError,
    },
    /// The scenario cannot be run.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The statistics refuse the problem, or find no answer.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}

impl ProblemError {
    /// Whether the request is at fault, not the run: everything but a scenario that cannot be run
    /// at any point.
    pub fn is_wrong_request(&self) -> bool {
        !matches!(self, Self::Identify(IdentifyError::AllRefused { .. }))
    }
}
