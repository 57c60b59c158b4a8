//! A power law fitted to measured stiffnesses.

use crate::error::{LawError, LawQuantity, above, at_least};
use crate::power::Power;

/// A power law `K = C p^m` fitted by least squares of `ln K` on `ln p`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PowerFit {
    /// Coefficient C \[Pa^(1-m)/m\].
    pub coefficient: f64,
    /// Exponent m \[-\]; negative if the stiffness falls with pressure, which no [`Power`] law has.
    pub exponent: f64,
    /// Root mean square of the residuals of `ln K` \[-\].
    pub residual_log_rms: f64,
    /// Standard errors from the residuals; `None` with two points, which leave no residual.
    pub errors: Option<PowerFitErrors>,
}

/// Standard errors of a fit of n points, from a residual variance with n - 2 degrees of freedom.
///
/// The two parameters are correlated, almost fully when the pressures are far from 1 Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PowerFitErrors {
    /// Standard error of `ln C` \[-\].
    pub log_coefficient: f64,
    /// Standard error of the exponent m \[-\].
    pub exponent: f64,
}

impl PowerFit {
    /// The fitted law, its closures counted from `reference_pressure` \[Pa\].
    ///
    /// # Errors
    /// Those of [`Power::new`].
    pub fn law(&self, reference_pressure: f64) -> Result<Power, LawError> {
        Power::new(self.coefficient, self.exponent, reference_pressure)
    }
}

/// Fits a power law to `points` (pressure \[Pa\], stiffness \[Pa/m\]), at least two, of at least two
/// different pressures, all positive.
///
/// All points have equal weight in the logarithms, which assumes equal relative errors of K:
///
/// ```text
/// minimise sum_i (ln K_i - ln C - m ln p_i)^2 over ln C and m.
/// ```
///
/// Valid within the range of the data. Source of the law: Nouira et al., Lubricants 8, 73 (2020),
/// Eq. (7), doi 10.3390/lubricants8070073.
///
/// # Errors
/// [`LawError`] if the points are outside these limits or not finite.
///
/// # Example
/// Table 3 of Nouira et al. (doi 10.3390/lubricants8070073) gives the law of the paper's Eq. (7):
/// ```
/// # use asperity_law::{LawError, fit_power};
/// let fit = fit_power(&[(0.14e6, 1.15e12), (0.35e6, 1.75e12), (0.57e6, 1.63e12), (1e6, 2.46e12)])?;
/// assert!((fit.coefficient - 1.81e10).abs() < 0.005e10);
/// assert!((fit.exponent - 0.35).abs() < 0.005);
/// # Ok::<(), LawError>(())
/// ```
pub fn fit_power(points: &[(f64, f64)]) -> Result<PowerFit, LawError> {
    at_least(LawQuantity::Points, points.len() as f64, 2.0)?;
    let mut logs = Vec::with_capacity(points.len());
    for &(p, k) in points {
        above(LawQuantity::Pressure, p, 0.0)?;
        above(LawQuantity::Stiffness, k, 0.0)?;
        logs.push((p.ln(), k.ln()));
    }
    let n = logs.len() as f64;
    let mean_x = logs.iter().map(|l| l.0).sum::<f64>() / n;
    let mean_y = logs.iter().map(|l| l.1).sum::<f64>() / n;
    let sum = |term: &dyn Fn(f64, f64) -> f64| -> f64 {
        logs.iter().map(|l| term(l.0 - mean_x, l.1 - mean_y)).sum()
    };
    let spread = sum(&|x, _| x * x);
    // The rounding of the mean is not a spread.
    let rounding = (8.0 * f64::EPSILON * mean_x.abs()).powi(2) * n;
    above(LawQuantity::PressureSpread, spread.sqrt(), rounding.sqrt())?;

    let exponent = sum(&|x, y| x * y) / spread;
    let squares = sum(&|x, y| (y - exponent * x).powi(2));
    let errors = (logs.len() > 2).then(|| {
        let variance = squares / (n - 2.0);
        PowerFitErrors {
            log_coefficient: (variance * (1.0 / n + mean_x * mean_x / spread)).sqrt(),
            exponent: (variance / spread).sqrt(),
        }
    });
    Ok(PowerFit {
        coefficient: (mean_y - exponent * mean_x).exp(),
        exponent,
        residual_log_rms: (squares / n).sqrt(),
        errors,
    })
}
