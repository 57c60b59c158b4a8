//! Options of a fit.

use crate::error::{InferenceError, check_positive, check_range};
use crate::loss::Loss;

/// Options of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Loss of the standardised residuals.
    pub loss: Loss,
    /// Number of searches, 1 to 10 000: the first from the parameters' starts, the others from a
    /// Latin hypercube.
    pub starts: usize,
    /// Seed of the Latin hypercube.
    pub seed: u64,
    /// Largest number of steps of each search, rejected ones included.
    pub max_iterations: usize,
    /// Converged when the cost is expected to fall, and fell, by less than this fraction; when
    /// the cosine between the residuals and every column of the Jacobian is below it; or when a
    /// step moves no parameter by more than this fraction of its length of change.
    pub tolerance: f64,
    /// Step of difference derivatives relative to each parameter's length of change: the least of
    /// the prior's standard deviation, a quarter of the range, and 1 (logarithmic) or |value|
    /// plus a thousandth of the range (linear). Positive, at most 0.1.
    pub difference_step: f64,
    /// The residual (in standard deviations) that replaces a missing prediction, with zero
    /// derivative; it favours points with predictions.
    pub missing_residual: f64,
    /// True to search with standard deviations that fall by halves, from the root mean square residual at the start times
    /// those as given, down to them: far from precise data a search with the last alone follows one narrow bent valley
    /// of the cost. The stages before the last are searched start by start; a fit that goes on from an earlier one has
    /// none of them. Where the residuals stay above three standard deviations a search ends when twenty steps lower the cost
    /// by less than a tenth.
    pub gradual: bool,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            loss: Loss::Squared,
            starts: 1,
            seed: 1,
            max_iterations: 200,
            tolerance: 1e-10,
            difference_step: 1e-3,
            missing_residual: 5.0,
            gradual: false,
        }
    }
}

impl FitOptions {
    /// Checks the ranges of the options.
    pub(crate) fn check(&self) -> Result<(), InferenceError> {
        self.loss.check()?;
        check_positive("the tolerance", self.tolerance)?;
        check_positive("the difference step", self.difference_step)?;
        check_positive("the residual of a missing prediction", self.missing_residual)?;
        check_range("the difference step", self.difference_step, 0.0..=0.1, "at most 0.1")?;
        check_range("the number of starts", self.starts as f64, 1..=10_000, "1 to 10000")?;
        let iterations = self.max_iterations as f64;
        check_range("the number of iterations", iterations, 1.0..=f64::INFINITY, "at least 1")
    }
}
