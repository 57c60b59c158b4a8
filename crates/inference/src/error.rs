//! Errors of fits and what follows them.

use std::ops::RangeInclusive;

use thiserror::Error as Derive;

/// Errors of fits and what follows them.
#[derive(Debug, Clone, PartialEq, Derive)]
#[non_exhaustive]
pub enum InferenceError {
    /// A model without parameters.
    #[error("the model has no parameters")]
    NoParameters,
    /// A model without observations.
    #[error("the model has no observations")]
    NoObservations,
    /// Two parameters share a name.
    #[error("two parameters are named '{0}'; names must differ")]
    DuplicateName(String),
    /// Bounds that are not finite and increasing, or not positive on a logarithmic scale.
    #[error("the bounds of '{name}' are {lower} to {upper}, they must be {expected}")]
    Bounds {
        /// The parameter.
        name: String,
        /// Lower bound given.
        lower: f64,
        /// Upper bound given.
        upper: f64,
        /// The accepted range, in words.
        expected: &'static str,
    },
    /// A start outside the bounds.
    #[error(
        "the start of '{name}' is {start}, outside its bounds {lower} to {upper}; expected a start inside, or wider bounds"
    )]
    Start {
        /// The parameter.
        name: String,
        /// The start given.
        start: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// A prior that is not a normal distribution.
    #[error("the {quantity} of the prior of '{name}' is {value}; it must be {expected}")]
    Prior {
        /// The parameter.
        name: String,
        /// The number of the prior.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The accepted range, in words.
        expected: &'static str,
    },
    /// An observation that is not finite or has no positive standard deviation.
    #[error("the {quantity} of observation '{label}' is {value}; it must be {expected}")]
    Observation {
        /// The observation's label.
        label: String,
        /// The number of the observation.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The accepted range, in words.
        expected: &'static str,
    },
    /// Fewer observations and priors than parameters.
    #[error(
        "{observations} observations and {priors} priors cannot determine {parameters} parameters"
    )]
    TooFew {
        /// Number of observations.
        observations: usize,
        /// Number of priors.
        priors: usize,
        /// Number of parameters.
        parameters: usize,
    },
    /// An option outside its range.
    #[error("{quantity} is {value}; it must be {expected}")]
    Option {
        /// The option, in words.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The accepted range, in words.
        expected: &'static str,
    },
    /// A model without predictions at any point.
    #[error("the model has no predictions at any of {points} points; at the first one: {reason}")]
    NoPredictions {
        /// Number of points.
        points: usize,
        /// The reason at the first.
        reason: String,
    },
    /// A wrong number of entries.
    #[error("{found} {quantity}; {expected} expected")]
    Size {
        /// The entries.
        quantity: &'static str,
        /// Their number.
        found: usize,
        /// The correct number.
        expected: usize,
    },
    /// Too few training points with predictions for a response surface.
    #[error(
        "the model has predictions at {answered} training points; the response surface needs {needed}"
    )]
    TooFewTraining {
        /// Points with predictions.
        answered: usize,
        /// The least number that determines the surface.
        needed: usize,
    },
    /// An observation without a prediction at many points, which no surface describes.
    #[error(
        "observation '{label}' has no prediction at {missing} of {points} training points; \
         at most half of them may lack one"
    )]
    MissingPredictions {
        /// The observation's label.
        label: String,
        /// Training points without a prediction of it.
        missing: usize,
        /// Training points.
        points: usize,
    },
    /// A singular matrix.
    #[error("the {0} is singular or holds numbers that are not finite")]
    Singular(&'static str),
}

impl InferenceError {
    /// True if the model has too few predictions about the best fit for a posterior.
    pub fn is_of_sampler(&self) -> bool {
        matches!(
            self,
            Self::NoPredictions { .. }
                | Self::MissingPredictions { .. }
                | Self::TooFewTraining { .. }
                | Self::Singular(_)
        )
    }
}

/// Checks that an option (named in words) is positive and finite.
pub(crate) fn check_positive(quantity: &'static str, value: f64) -> Result<(), InferenceError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(InferenceError::Option { quantity, value, expected: "positive and finite" })
    }
}

/// Checks that an option (named in words) is within a range, which `expected` states.
pub(crate) fn check_range<T: Into<f64>>(
    quantity: &'static str,
    value: f64,
    range: RangeInclusive<T>,
    expected: &'static str,
) -> Result<(), InferenceError> {
    let (least, most) = range.into_inner();
    if (least.into()..=most.into()).contains(&value) {
        Ok(())
    } else {
        Err(InferenceError::Option { quantity, value, expected })
    }
}

/// Checks that a probability level is strictly between 0 and 1.
pub(crate) fn check_level(level: f64) -> Result<(), InferenceError> {
    if level > 0.0 && level < 1.0 {
        Ok(())
    } else {
        let quantity = "the level";
        Err(InferenceError::Option { quantity, value: level, expected: "between 0 and 1" })
    }
}

/// Checks a number of entries (named in words).
pub(crate) fn check_size(
    quantity: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), InferenceError> {
    if found == expected { Ok(()) } else { Err(InferenceError::Size { quantity, found, expected }) }
}
