//! Errors of an identification.

use std::path::PathBuf;

use asperity_inference::InferenceError;
use thiserror::Error;

use crate::incomplete::IncompleteIdentification;
use asperity_experiment::AnalysisError;
use asperity_scenario::{DocumentError, InputError, InvalidDocument, SetError};
use asperity_simulation::error::SimulationError;
use asperity_simulation::parameter::ParameterError;

/// Errors of an identification.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum IdentificationError {
    /// The text of the problem or of its scenario cannot be read.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The problem, or its scenario, is not valid.
    #[error(transparent)]
    Invalid(#[from] InvalidDocument),
    /// A pointer to no parameter of the scenario.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Two parameters for one number of the scenario, or data that set a parameter.
    #[error("{pointer} is an unknown, and {by}")]
    Contradiction {
        /// The pointer.
        pointer: String,
        /// The contradiction.
        by: String,
    },
    /// A law that does not exist or has no stiffnesses at points.
    #[error(
        "law \"{0}\" has no stiffnesses at knots or points; expected the name of a modified_power or table law in \"laws\""
    )]
    NotMonotone(String),
    /// A tolerance of a number that is not given.
    #[error(
        "/given: {pointer} is no number of the scenario that is taken as given; there are: {known}"
    )]
    NotGiven {
        /// The pointer.
        pointer: String,
        /// Pointers to the given numbers.
        known: String,
    },
    /// A free law that cannot be set up.
    #[error("free_law \"{law}\": {reason}")]
    FreeLaw {
        /// The law.
        law: String,
        /// The fault, and what is accepted.
        reason: String,
    },
    /// A law that does not exist.
    #[error("there is no law \"{law}\"; in \"laws\" there are: {known}")]
    NoLaw {
        /// The name.
        law: String,
        /// The existing names.
        known: String,
    },
    /// The law to report has no name.
    #[error(
        "the law of the first interface is written in place, and an identification reports a law by its name: put it into \"laws\" of the scenario under a name, refer to it there (\"law\": \"name\") and in the pointers of the problem (/laws/name/...); names in \"laws\" now: {0}"
    )]
    UnnamedLaw(String),
    /// A prior that is not a distribution.
    #[error("the prior of \"{parameter}\": {reason}")]
    Prior {
        /// The parameter.
        parameter: String,
        /// The fault.
        reason: &'static str,
    },
    /// A gain of data that do not exist.
    #[error("a gain holds for the data \"{name}\"; there are: {known}")]
    NoData {
        /// The name.
        name: String,
        /// The existing names.
        known: String,
    },
    /// A feature that does not exist.
    #[error("{place}: there is no feature \"{feature}\"; expected one of: {known}")]
    Feature {
        /// The data.
        place: String,
        /// The feature.
        feature: String,
        /// The accepted features.
        known: String,
    },
    /// A receptance without a peak in its band.
    #[error(
        "{place}: no peak stands out of the receptance between {low_hz} and {high_hz} Hz; give a `band_hz` around the fundamental"
    )]
    NoPeakInBand {
        /// The data.
        place: String,
        /// Lower end of the band \[Hz\].
        low_hz: f64,
        /// Upper end of the band \[Hz\].
        high_hz: f64,
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
    /// Two contradictory values of one number.
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
    /// A number of the data out of range.
    #[error("{place}: {quantity} is {value}; expected {expected}")]
    Value {
        /// The data.
        place: String,
        /// The quantity.
        quantity: &'static str,
        /// The number.
        value: f64,
        /// The accepted input.
        expected: &'static str,
    },
    /// A peak force for a scenario whose force has none.
    #[error(
        "{0}: the scenario's excitation has no peak_n to set; expected a gamma_pulse, half_sine, haversine or samples"
    )]
    NoPeak(String),
    /// A file of data that cannot be read.
    #[error("{}: {source}", path.display())]
    Input {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: InputError,
    },
    /// A file of data with wrong content.
    #[error("{}: {problem}; expected {expected}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The fault and its place.
        problem: String,
        /// The accepted input.
        expected: &'static str,
    },
    /// Records that cannot be read as hits.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A design without features of measured hits.
    #[error(
        "{}: /design: the data have no features of hits from which to take the uncertainty of planned hits; expected data of the kind hits or analysis",
        .0.display()
    )]
    Design(PathBuf),
    /// A value cannot be set.
    #[error("{place}: {source}")]
    Set {
        /// The data or the candidate.
        place: String,
        /// The cause.
        source: SetError,
    },
    /// A request to stop before the posterior was finished.
    #[error("stopped in the {}", .0.stage.name())]
    Stopped(Box<IncompleteIdentification>),
    /// A request to stop before the first fit.
    #[error("stopped before the law could be run")]
    StoppedAtOnce,
    /// The scenario cannot be run.
    #[error(transparent)]
    Study(#[from] SimulationError),
    /// An error of the inference.
    #[error(transparent)]
    Inference(#[from] InferenceError),
}

impl IdentificationError {
    /// The place in the problem of a fault of its content; `None` for other errors.
    pub fn place(&self) -> Option<&str> {
        Some(match self {
            Self::Parameter(_)
            | Self::Contradiction { .. }
            | Self::NotMonotone(_)
            | Self::FreeLaw { .. }
            | Self::Prior { .. }
            | Self::NoData { .. }
            | Self::Inference(
                InferenceError::Start { .. }
                | InferenceError::Bounds { .. }
                | InferenceError::Prior { .. }
                | InferenceError::DuplicateName(_),
            ) => "/unknowns",
            Self::NotGiven { .. } => "/given",
            Self::NoLaw { .. } | Self::UnnamedLaw(_) => "/law",
            Self::Feature { place, .. }
            | Self::NoPeakInBand { place, .. }
            | Self::NoDeviation { place, .. }
            | Self::Contradictory { place, .. }
            | Self::Value { place, .. }
            | Self::Set { place, .. }
            | Self::NoPeak(place) => place,
            _ => return None,
        })
    }

    /// True for errors of the request; false for a scenario that cannot be run at any start.
    pub fn is_wrong_request(&self) -> bool {
        !matches!(
            self,
            Self::Inference(InferenceError::NoPredictions { .. })
                | Self::Stopped(_)
                | Self::StoppedAtOnce
        )
    }
}
