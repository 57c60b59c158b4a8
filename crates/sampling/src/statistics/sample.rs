//! Quantiles and exceedance probabilities of a weighted sample.

use super::IntervalEstimate;
use super::interval::{check_threshold, of_probability, quantile_shares};
use crate::error::DesignError;

/// Values of one output with their weights, sorted.
///
/// Values that are not finite, those of runs that failed or have no such output, are left out and
/// counted: every statistic is conditional on the output. With weights `w`, the effective size is
///
/// ```text
/// n = (sum w)^2 / sum w^2,
/// ```
///
/// the number of values for equal weights. Intervals are those of `n` independent values. Rows of a
/// Latin hypercube or a Sobol sequence are more even than independent ones, and their intervals
/// usually wider than necessary.
///
/// ```
/// use asperity_sampling::WeightedSample;
///
/// let sample = WeightedSample::of_equal((1..=999).map(f64::from))?;
/// let median = sample.quantile(0.5, 0.95)?;
/// assert_eq!(median.value, 500.0);
/// assert!(median.holds(480.0) && !median.holds(450.0));
/// # Ok::<(), asperity_sampling::DesignError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct WeightedSample {
    /// Finite values, sorted.
    values: Vec<f64>,
    /// Share of the weight below each value and half of its own.
    middles: Vec<f64>,
    /// Share of the weight up to each value.
    cumulative: Vec<f64>,
    effective_size: f64,
    left_out: usize,
}

impl WeightedSample {
    /// Values of equal weight.
    ///
    /// # Errors
    /// [`DesignError::Value`] without a finite value.
    pub fn of_equal(values: impl IntoIterator<Item = f64>) -> Result<Self, DesignError> {
        Self::new(values.into_iter().map(|value| (value, 1.0)))
    }

    /// Values, each with its weight.
    ///
    /// # Errors
    /// [`DesignError::Value`] for a weight that is negative or not finite, or without a finite value
    /// of positive weight.
    pub fn new(pairs: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, DesignError> {
        let mut kept: Vec<(f64, f64)> = Vec::new();
        let mut left_out = 0;
        for (value, weight) in pairs {
            if !(weight.is_finite() && weight >= 0.0) {
                let expected = "finite and not negative";
                return Err(DesignError::Value { quantity: "a weight", value: weight, expected });
            }
            if !value.is_finite() {
                left_out += 1;
            } else if weight > 0.0 {
                kept.push((value, weight));
            }
        }
        kept.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = kept.iter().map(|(_, weight)| weight).sum();
        let squares: f64 = kept.iter().map(|(_, weight)| weight * weight).sum();
        if kept.is_empty() {
            let quantity = "the number of values of positive weight";
            return Err(DesignError::Value { quantity, value: 0.0, expected: "at least 1" });
        }
        let (mut middles, mut cumulative) = (Vec::new(), Vec::new());
        let mut reached = 0.0;
        for (_, weight) in &kept {
            middles.push((reached + 0.5 * weight) / total);
            reached += weight;
            cumulative.push(reached / total);
        }
        let values = kept.into_iter().map(|(value, _)| value).collect();
        let effective_size = total * total / squares;
        Ok(Self { values, middles, cumulative, effective_size, left_out })
    }

    /// Number of values that are not finite.
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// Number of values that statistics are taken of.
    pub fn count(&self) -> usize {
        self.values.len()
    }

    /// Effective number of values.
    pub fn effective_size(&self) -> f64 {
        self.effective_size
    }

    /// Mean.
    pub fn mean(&self) -> f64 {
        self.weighted_mean(|value| value)
    }

    /// Standard deviation of the distribution; zero for a single value.
    pub fn standard_deviation(&self) -> f64 {
        let mean = self.mean();
        let spread = self.weighted_mean(|value| (value - mean).powi(2));
        let n = self.effective_size;
        if n > 1.0 { (spread * n / (n - 1.0)).sqrt() } else { 0.0 }
    }

    fn weighted_mean(&self, f: impl Fn(f64) -> f64) -> f64 {
        let mut below = 0.0;
        let terms = self.values.iter().zip(&self.cumulative).map(|(&value, &reached)| {
            let weight = reached - std::mem::replace(&mut below, reached);
            f(value) * weight
        });
        terms.sum()
    }

    /// The value that a share `probability` of the weight does not exceed, with its interval at a
    /// confidence `level`.
    ///
    /// Values stand at the middle of their weight, with linear interpolation between them (type 5 of
    /// Hyndman and Fan). The interval holds the quantiles at
    /// `probability -+ z sqrt(probability (1 - probability) / n)`; an end that this moves beyond the
    /// middle of the first or the last value is infinite.
    ///
    /// Sources: R. J. Hyndman, Y. Fan, Am. Stat. 50, 361 (1996); R. S. Woodruff, J. Am. Stat. Assoc.
    /// 47, 635 (1952), doi 10.1080/01621459.1952.10483443.
    ///
    /// # Errors
    /// [`DesignError::Value`] for a probability or a level that is not between 0 and 1.
    pub fn quantile(&self, probability: f64, level: f64) -> Result<IntervalEstimate, DesignError> {
        let [below, above] = quantile_shares(probability, level, self.effective_size)?;
        let (first, last) = (self.middles[0], self.middles[self.middles.len() - 1]);
        Ok(IntervalEstimate {
            value: self.at(probability),
            low: if below < first { f64::NEG_INFINITY } else { self.at(below) },
            high: if above > last { f64::INFINITY } else { self.at(above) },
        })
    }

    /// Value at a share of the weight.
    fn at(&self, share: f64) -> f64 {
        let above = self.middles.partition_point(|&middle| middle < share);
        if above == 0 {
            return self.values[0];
        }
        if above == self.values.len() {
            return self.values[above - 1];
        }
        let (p, q) = (self.middles[above - 1], self.middles[above]);
        let (x, y) = (self.values[above - 1], self.values[above]);
        let fraction = (share - p) / (q - p);
        x * (1.0 - fraction) + y * fraction
    }

    /// The probability of values above `threshold`, with its interval at a confidence `level`
    /// (Wilson's score interval).
    ///
    /// Source: E. B. Wilson, J. Am. Stat. Assoc. 22, 209 (1927), doi
    /// 10.1080/01621459.1927.10502953.
    ///
    /// # Errors
    /// [`DesignError::Value`] for a threshold that is not a number, or a level that is not between 0
    /// and 1.
    pub fn exceedance(&self, threshold: f64, level: f64) -> Result<IntervalEstimate, DesignError> {
        check_threshold(threshold)?;
        let up_to = self.values.partition_point(|&value| value <= threshold);
        let below = if up_to == 0 { 0.0 } else { self.cumulative[up_to - 1] };
        let p = if up_to == self.values.len() { 0.0 } else { 1.0 - below };
        of_probability(p, level, self.effective_size)
    }
}
