//! Errors of distributions, designs and statistics.

use thiserror::Error;

/// Errors of distributions, designs and statistics.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum DesignError {
    /// A parameter of a distribution outside its range.
    #[error("{quantity} of a {distribution} distribution is {value}; it must be {expected}")]
    Distribution {
        /// The distribution.
        distribution: &'static str,
        /// Its parameter, in words.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The accepted values, in words.
        expected: &'static str,
    },
    /// A matrix that is no correlation matrix of the inputs.
    #[error("the correlation matrix {0}")]
    Correlation(String),
    /// Draws without rows, with rows of several lengths, or with weights that are no weights.
    #[error("the draws {0}")]
    Draws(String),
    /// A number of rows, inputs, or levels outside its range.
    #[error("{quantity} is {value}; accepted: {least} to {most}")]
    Count {
        /// The number, in words.
        quantity: &'static str,
        /// The value given.
        value: u64,
        /// Least value.
        least: u64,
        /// Greatest value.
        most: u64,
    },
    /// A value outside its range.
    #[error("{quantity} is {value}; it must be {expected}")]
    Value {
        /// The quantity, in words.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The accepted values, in words.
        expected: &'static str,
    },
}

/// Checks that a number is in `least..=most`.
pub(crate) fn check_count(
    quantity: &'static str,
    value: u64,
    least: u64,
    most: u64,
) -> Result<(), DesignError> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(DesignError::Count { quantity, value, least, most })
    }
}
