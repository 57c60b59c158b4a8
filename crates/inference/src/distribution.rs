//! Quantiles and tails of the normal and the chi-square distribution.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// The value below which a standard normal number lies with this probability, which is held to
/// 0 and 1, where it is infinite.
pub fn normal_quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability.clamp(0.0, 1.0))
}

/// The half-width, in standard deviations, of the central normal interval of a level.
pub(crate) fn normal_half_width(level: f64) -> f64 {
    normal_quantile(0.5 + 0.5 * level)
}

/// The probability that chi-square with these degrees of freedom exceeds `value`; `None` without
/// degrees of freedom.
pub(crate) fn chi_square_tail(value: f64, degrees_of_freedom: usize) -> Option<f64> {
    let distribution = ChiSquared::new(degrees_of_freedom as f64).ok()?;
    Some(distribution.sf(value.max(0.0)))
}
