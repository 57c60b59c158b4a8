//! What can be wrong with a request for an identification.

use thiserror::Error as Derive;

/// Why an identification was refused or failed.
#[derive(Debug, Clone, PartialEq, Derive)]
#[non_exhaustive]
pub enum IdentifyError {
    /// There is nothing to identify.
    #[error("the model has no unknowns")]
    NoUnknowns,
    /// There is nothing to identify from.
    #[error("the model has no observations")]
    NoObservations,
    /// Two unknowns share a name.
    #[error("two unknowns are named '{name}'")]
    DuplicateName {
        /// The name given twice.
        name: String,
    },
    /// Bounds that are not finite and increasing, or not positive on a logarithmic scale.
    #[error("the bounds of '{name}' are {lower} to {upper}, they must be {expected}")]
    Bounds {
        /// The unknown.
        name: String,
        /// Lower bound given.
        lower: f64,
        /// Upper bound given.
        upper: f64,
        /// What is accepted, in words.
        expected: &'static str,
    },
    /// A start outside the bounds.
    #[error("the start of '{name}' is {start}, outside its bounds {lower} to {upper}")]
    Start {
        /// The unknown.
        name: String,
        /// The start given.
        start: f64,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// A prior that is no normal distribution.
    #[error("the {quantity} of the prior of '{name}' is {value}, it must be {expected}")]
    Prior {
        /// The unknown.
        name: String,
        /// Which number of the prior.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// What is accepted, in words.
        expected: &'static str,
    },
    /// An observation that is no number with a positive uncertainty.
    #[error("the {quantity} of observation '{label}' is {value}, it must be {expected}")]
    Observation {
        /// The observation's label.
        label: String,
        /// Which number of it.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// What is accepted, in words.
        expected: &'static str,
    },
    /// Fewer observations and priors than unknowns.
    #[error("{observations} observations and {priors} priors cannot determine {unknowns} unknowns")]
    TooFew {
        /// Number of observations.
        observations: usize,
        /// Number of priors.
        priors: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// An option is outside what makes sense.
    #[error("{quantity} is {value}, it must be {expected}")]
    Option {
        /// Which option, in words.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// What is accepted, in words.
        expected: &'static str,
    },
    /// The model refused every point it was asked for.
    #[error("the model refused all {points} points, the first because {reason}")]
    AllRefused {
        /// How many points were tried.
        points: usize,
        /// The reason given for the first.
        reason: String,
    },
    /// A table has another size than what it belongs to.
    #[error("{found} {quantity}, {expected} expected")]
    Size {
        /// What was counted.
        quantity: &'static str,
        /// How many were given.
        found: usize,
        /// How many belong there.
        expected: usize,
    },
    /// The model answered at too few points to fit a response surface.
    #[error(
        "the model answered at {answered} training points, the response surface needs {needed}"
    )]
    TooFewTraining {
        /// Points with an answer.
        answered: usize,
        /// The fewest that determine the surface.
        needed: usize,
    },
    /// An observation has no prediction at many points, so that no surface describes it.
    #[error(
        "observation '{label}' has no prediction at {missing} of {points} training points, \
         at most a tenth may miss"
    )]
    OftenMissing {
        /// The observation's label.
        label: String,
        /// Training points without a prediction of it.
        missing: usize,
        /// Training points.
        points: usize,
    },
    /// A matrix that must be invertible is not.
    #[error("the {matrix} is singular or holds numbers that are not finite")]
    Singular {
        /// Which matrix.
        matrix: &'static str,
    },
}

/// Refuses an option (named in words) that is not positive and finite.
pub(crate) fn check_positive(quantity: &'static str, value: f64) -> Result<(), IdentifyError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(IdentifyError::Option { quantity, value, expected: "positive and finite" })
    }
}

/// Refuses a probability level that is not strictly between 0 and 1.
pub(crate) fn check_level(level: f64) -> Result<(), IdentifyError> {
    if level > 0.0 && level < 1.0 {
        Ok(())
    } else {
        let quantity = "the level";
        Err(IdentifyError::Option { quantity, value: level, expected: "between 0 and 1" })
    }
}

/// Refuses a table (named in words) of another size than what it belongs to.
pub(crate) fn check_size(
    quantity: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), IdentifyError> {
    if found == expected { Ok(()) } else { Err(IdentifyError::Size { quantity, found, expected }) }
}
