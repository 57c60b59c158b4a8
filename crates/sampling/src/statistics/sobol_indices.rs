//! Sobol indices of first order and total, from Saltelli's design.
//!
//! ```text
//! S_i = V(E(y | x_i)) / V(y),    T_i = E(V(y | x_~i)) / V(y)
//! ```
//!
//! with all inputs but the i-th `x_~i`. Jansen's estimators over the base rows are
//!
//! ```text
//! S_i = 1 - sum (f(B) - f(A_i))^2 / (2 N V),    T_i = sum (f(A) - f(A_i))^2 / (2 N V)
//! ```
//!
//! where `A_i` is A with input i of B, and `V` the variance of the values at A and B together.
//!
//! Sources: M. J. W. Jansen, Comput. Phys. Commun. 117, 35 (1999), doi
//! 10.1016/S0010-4655(98)00154-4; A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010), Table 2.

use std::f64::consts::E;

use super::{IntervalEstimate, WeightedSample, check_probability};
use crate::error::{DesignError, check_count};
use crate::hash::{hash, open_unit};

/// Most bootstrap replicates.
const MOST_REPLICATES: u64 = 100_000;

/// Fewest base rows of indices.
const FEWEST_ROWS: u64 = 2;

/// Deviation over the mean of an output that varies by rounding alone.
const ROUNDING: f64 = 1e-13;

/// The word that keeps the random numbers of the bootstrap apart from others.
const BOOTSTRAP: u64 = 5;

/// Sums over the base rows of Saltelli's design, from which Sobol indices follow.
///
/// Memory does not grow with the rows. Each bootstrap replicate gives every base row a weight of its
/// own, from a Poisson distribution of mean 1, which follows from seed, replicate and number of the
/// row. A base row is used if all its values are finite. Otherwise it is left out as a whole and
/// counted: the indices are then those of the inputs for which the model has values.
///
/// Source of the bootstrap: J. A. Hanley, B. `MacGibbon`, Comput. Methods Programs Biomed. 83, 57
/// (2006), doi 10.1016/j.cmpb.2006.04.006.
///
/// ```
/// use asperity_sampling::{Design, SensitivitySums};
///
/// let design = Design::saltelli(2, 1024, 1)?;
/// let mut sums = SensitivitySums::new(2, 200, 1)?;
/// for base in 0..1024 {
///     let model = |block| { let x = design.point(4 * base + block); x[0] + 2.0 * x[1] };
///     sums.add(base, &[0, 1, 2, 3].map(model));
/// }
/// let indices = sums.indices(0.95)?;
/// assert!((indices.first[0].value - 0.2).abs() < 0.01);
/// assert!(indices.total[1].holds(0.8));
/// # Ok::<(), asperity_sampling::DesignError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SensitivitySums {
    dimensions: usize,
    seed: u64,
    /// The estimate's own sums, then those of each replicate.
    sums: Vec<Sums>,
    /// A value near the mean, subtracted from all.
    shift: Option<f64>,
    left_out: u64,
}

/// Weighted sums over base rows.
#[derive(Debug, Clone, PartialEq)]
struct Sums {
    rows: f64,
    /// Of the values at A and B, and of their squares.
    values: f64,
    squares: f64,
    /// Of the squared differences to B and to A, by input.
    to_b: Vec<f64>,
    to_a: Vec<f64>,
}

/// Sobol indices of one output.
#[derive(Debug, Clone, PartialEq)]
pub struct SobolIndices {
    /// First-order index of each input.
    pub first: Vec<IntervalEstimate>,
    /// Total index of each input.
    pub total: Vec<IntervalEstimate>,
    /// Mean of the output.
    pub mean: f64,
    /// Variance of the output.
    pub variance: f64,
    /// Base rows used.
    pub used: u64,
    /// Base rows left out, since the model has not all their values.
    pub left_out: u64,
}

impl SensitivitySums {
    /// No rows yet, for a model of so many inputs and so many bootstrap `replicates`.
    ///
    /// # Errors
    /// [`DesignError::Count`] without inputs, for fewer than 20 replicates or more than 100 000.
    pub fn new(inputs: usize, replicates: usize, seed: u64) -> Result<Self, DesignError> {
        check_count("the number of inputs", inputs as u64, 1, crate::MOST_DIMENSIONS as u64 / 2)?;
        check_count("the number of replicates", replicates as u64, 20, MOST_REPLICATES)?;
        let none = || vec![0.0; inputs];
        let empty = Sums { rows: 0.0, values: 0.0, squares: 0.0, to_b: none(), to_a: none() };
        let sums = vec![empty; replicates + 1];
        Ok(Self { dimensions: inputs, seed, sums, shift: None, left_out: 0 })
    }

    /// Adds the base row of number `base`: the values at A, at B, and at A with each input of B, in
    /// the order of [`SaltelliBlock`](crate::SaltelliBlock).
    ///
    /// # Panics
    /// If the number of values is not that of the inputs and 2 more.
    pub fn add(&mut self, base: u64, values: &[f64]) {
        assert_eq!(values.len(), self.dimensions + 2, "values of a base row");
        if !values.iter().all(|value| value.is_finite()) {
            self.left_out += 1;
            return;
        }
        let shift = *self.shift.get_or_insert(values[0]);
        let (a, b) = (values[0] - shift, values[1] - shift);
        let exchanged = || values[2..].iter().map(|value| value - shift);
        let to_b: Vec<f64> = exchanged().map(|value| (b - value).powi(2)).collect();
        let to_a: Vec<f64> = exchanged().map(|value| (a - value).powi(2)).collect();
        for (replicate, sums) in self.sums.iter_mut().enumerate() {
            let weight = match replicate as u64 {
                0 => 1.0,
                number => poisson(open_unit(hash(self.seed, &[BOOTSTRAP, number, base]))),
            };
            if weight == 0.0 {
                continue;
            }
            sums.rows += weight;
            sums.values += weight * (a + b);
            sums.squares += weight * (a * a + b * b);
            for (sum, term) in sums.to_b.iter_mut().zip(&to_b) {
                *sum += weight * term;
            }
            for (sum, term) in sums.to_a.iter_mut().zip(&to_a) {
                *sum += weight * term;
            }
        }
    }

    /// The indices, with bootstrap intervals at a confidence `level` from the percentiles of the
    /// replicates.
    ///
    /// # Errors
    /// [`DesignError::Count`] for fewer than two base rows with values, [`DesignError::Value`] for a
    /// constant output, to within rounding, which has no indices, and for a level that is not between 0 and 1.
    pub fn indices(&self, level: f64) -> Result<SobolIndices, DesignError> {
        check_probability("the level of an interval", level)?;
        let used = self.sums[0].rows as u64;
        check_count("the number of base rows with values", used, FEWEST_ROWS, u64::MAX)?;
        let variance = self.sums[0].variance();
        // Rounding alone leaves this much.
        let mean = self.shift.unwrap_or(0.0) + self.sums[0].mean();
        if variance <= (ROUNDING * mean).powi(2) || variance == 0.0 {
            let quantity = "the variance of the output";
            return Err(DesignError::Value { quantity, value: variance, expected: "positive" });
        }
        let of = |index: &dyn Fn(&Sums) -> f64| {
            let replicates = self.sums[1..].iter().map(index);
            let sample = WeightedSample::of_equal(replicates)?;
            let end = |probability| sample.quantile(probability, 0.5).map(|found| found.value);
            let [low, high] = [0.5 - 0.5 * level, 0.5 + 0.5 * level].map(end);
            Ok(IntervalEstimate { value: index(&self.sums[0]), low: low?, high: high? })
        };
        let inputs = || 0..self.dimensions;
        let first = inputs().map(|i| of(&|sums| 1.0 - sums.share(sums.to_b[i])));
        let total = inputs().map(|i| of(&|sums| sums.share(sums.to_a[i])));
        Ok(SobolIndices {
            first: first.collect::<Result<_, DesignError>>()?,
            total: total.collect::<Result<_, DesignError>>()?,
            mean: self.shift.unwrap_or(0.0) + self.sums[0].mean(),
            variance,
            used,
            left_out: self.left_out,
        })
    }
}

impl Sums {
    fn mean(&self) -> f64 {
        self.values / (2.0 * self.rows)
    }

    fn variance(&self) -> f64 {
        self.squares / (2.0 * self.rows) - self.mean().powi(2)
    }

    /// Half the mean of squared differences over the variance.
    fn share(&self, differences: f64) -> f64 {
        differences / (2.0 * self.rows * self.variance())
    }
}

/// The quantile of the Poisson distribution of mean 1.
fn poisson(unit: f64) -> f64 {
    let (mut count, mut probability) = (0.0, 1.0 / E);
    let mut reached = probability;
    // Beyond 20 there is less than one in 1e19.
    while unit > reached && count < 20.0 {
        count += 1.0;
        probability /= count;
        reached += probability;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bootstrap_weights_have_the_moments_of_a_poisson_distribution() {
        const CELLS: usize = 1 << 20;
        let weights = (0..CELLS).map(|k| poisson((k as f64 + 0.5) / CELLS as f64));
        let moments =
            weights.fold([0.0; 3], |sum, w| [sum[0] + w, sum[1] + w * w, sum[2] + w.powi(3)]);
        // E(w) = 1, E(w^2) = 2, E(w^3) = 5.
        for (moment, expected) in moments.iter().zip([1.0, 2.0, 5.0]) {
            assert!((moment / CELLS as f64 - expected).abs() < 1e-3 * expected, "{moment}");
        }
    }

    /// An output that differs from its mean by rounding has no indices, however far it is from zero.
    #[test]
    fn rounding_has_no_indices() {
        let indices = |scale: f64| {
            let design = crate::Design::saltelli(2, 64, 1).unwrap();
            let mut sums = SensitivitySums::new(2, 20, 1).unwrap();
            for base in 0..64 {
                let model = |block| 8.5e11 * (1.0 + scale * design.point(4 * base + block)[0]);
                sums.add(base, &[0, 1, 2, 3].map(model));
            }
            sums.indices(0.95)
        };
        assert!(indices(2e-16).is_err());
        assert!((indices(1e-6).unwrap().first[0].value - 1.0).abs() < 0.05);
    }
}
