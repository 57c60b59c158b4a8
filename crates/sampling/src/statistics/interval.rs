//! Confidence intervals of quantiles and of probabilities.

use super::{IntervalEstimate, check_probability};
use crate::distribution::normal_quantile;
use crate::error::DesignError;

/// Shares whose quantiles are the ends of the interval of a quantile at `probability`, of a sample of
/// effective size `n` (Woodruff).
///
/// # Errors
/// [`DesignError::Value`] for a probability or a level that is not between 0 and 1.
pub(super) fn quantile_shares(
    probability: f64,
    level: f64,
    n: f64,
) -> Result<[f64; 2], DesignError> {
    check_probability("the probability of a quantile", probability)?;
    check_probability("the level of an interval", level)?;
    let z = normal_quantile(0.5 + 0.5 * level);
    let half = z * (probability * (1.0 - probability) / n).sqrt();
    Ok([probability - half, probability + half])
}

/// The probability `p`, found in a sample of effective size `n`, with Wilson's score interval.
///
/// # Errors
/// [`DesignError::Value`] for a level that is not between 0 and 1.
pub(super) fn of_probability(p: f64, level: f64, n: f64) -> Result<IntervalEstimate, DesignError> {
    check_probability("the level of an interval", level)?;
    let z = normal_quantile(0.5 + 0.5 * level);
    let scale = 1.0 + z * z / n;
    let centre = (p + 0.5 * z * z / n) / scale;
    let half = z / scale * (p * (1.0 - p) / n + 0.25 * z * z / (n * n)).sqrt();
    // Rounding must not move the interval off an estimate of 0 or 1.
    let (low, high) = ((centre - half).clamp(0.0, p), (centre + half).clamp(p, 1.0));
    Ok(IntervalEstimate { value: p, low, high })
}

/// Checks that a threshold is a number.
pub(super) fn check_threshold(threshold: f64) -> Result<(), DesignError> {
    if threshold.is_nan() {
        let quantity = "the threshold";
        return Err(DesignError::Value { quantity, value: threshold, expected: "a number" });
    }
    Ok(())
}
