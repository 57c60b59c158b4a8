//! Chi-square of a fit and the scale of its noise.

use crate::fit::Fit;
use crate::random::chi_square_tail;

/// Comparison of the residuals with the given standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoodnessOfFit {
    /// Sum of squared standardised residuals: observations with a prediction, and priors.
    pub chi_square: f64,
    /// Their number less the number of parameters, at least zero.
    pub degrees_of_freedom: usize,
    /// Probability of a larger chi-square if model and standard deviations are right; `None`
    /// without degrees of freedom.
    pub p_value: Option<f64>,
    /// Birge ratio: the factor, at least one, by which the standard deviations are too small,
    ///
    /// ```text
    /// sqrt(max(1, (sum_i w_i r_i^2 + prior chi-square) / degrees of freedom)),
    /// ```
    ///
    /// with the robust weights `w` of the residuals `r`.
    ///
    /// Source: R. T. Birge, Phys. Rev. 40, 207 (1932).
    pub noise_factor: f64,
}

/// Agreement of a fit with its data in a word, by the p-value of chi-square.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Agreement {
    /// The p-value is at least [`Agreement::GOOD`], or there are no degrees of freedom.
    Good,
    /// It is below that, and at least [`Agreement::DOUBTFUL`]: a larger chi-square has odds of less
    /// than one in twenty if model and standard deviations are right.
    Doubtful,
    /// It is smaller still: the model or the standard deviations are wrong.
    None,
}

impl Agreement {
    /// Least p-value of a good agreement.
    pub const GOOD: f64 = 0.05;
    /// Least p-value of a doubtful one.
    pub const DOUBTFUL: f64 = 1e-3;

    /// The agreement of a p-value.
    ///
    /// ```
    /// use asperity_inference::Agreement;
    /// assert_eq!(Agreement::of(Some(0.02)), Agreement::Doubtful);
    /// ```
    pub fn of(p_value: Option<f64>) -> Self {
        match p_value {
            Some(p) if p.is_nan() || p < Self::DOUBTFUL => Self::None,
            Some(p) if p < Self::GOOD => Self::Doubtful,
            _ => Self::Good,
        }
    }
}

impl GoodnessOfFit {
    /// The agreement with the data.
    pub fn agreement(&self) -> Agreement {
        Agreement::of(self.p_value)
    }
}

impl Fit<'_> {
    /// The goodness of the fit.
    pub fn goodness(&self) -> GoodnessOfFit {
        let rows = self.residuals.len() - self.missing.len() + self.problem.priors();
        let degrees_of_freedom = rows.saturating_sub(self.point.len());
        let chi_square = self.chi_square + self.prior_chi_square;
        let p_value = chi_square_tail(chi_square, degrees_of_freedom);
        let answered = self.residuals.iter().zip(&self.weights).zip(&self.predictions);
        let weighted: f64 = answered
            .filter(|(_, prediction)| prediction.is_some())
            .map(|((residual, weight), _)| weight * residual * residual)
            .sum();
        let reduced = (weighted + self.prior_chi_square) / degrees_of_freedom.max(1) as f64;
        let noise_factor = if degrees_of_freedom == 0 { 1.0 } else { reduced.max(1.0).sqrt() };
        GoodnessOfFit { chi_square, degrees_of_freedom, p_value, noise_factor }
    }
}
