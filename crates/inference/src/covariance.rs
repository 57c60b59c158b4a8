//! Uncertainty from the curvature at the optimum.

use crate::dense::{InverseNormal, inverse_normal};
use crate::distribution::{chi_square_tail, normal_half_width};
use crate::error::{IdentifyError, check_level};
use crate::fit::Fit;
use crate::identifiability::weighted_rows;
use crate::linearisation::Linearisation;
use crate::model::ForwardModel;
use crate::problem::Problem;
use crate::unknown::Unknown;

/// How far the observations' standard deviations are trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseScale {
    /// As given.
    Given,
    /// As given, or larger if the residuals are: variances are multiplied by the reduced
    /// chi-square where that exceeds 1 (the Birge ratio, R. T. Birge, Phys. Rev. 40, 207, 1932).
    AtLeastGiven,
}

/// Whether the residuals are as large as the standard deviations say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoodnessOfFit {
    /// Sum of squared standardised residuals: observations with a prediction, and priors.
    pub chi_square: f64,
    /// Their number less the unknowns, not below zero.
    pub degrees_of_freedom: usize,
    /// Probability of a larger chi-square if model and standard deviations are right; `None`
    /// without degrees of freedom.
    pub p_value: Option<f64>,
}

/// The normal approximation at the optimum, in working coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    /// Working coordinates of the optimum.
    pub centre: Vec<f64>,
    /// Covariance matrix.
    pub matrix: Vec<Vec<f64>>,
    /// Square roots of its diagonal.
    pub standard_deviations: Vec<f64>,
    /// Correlation of the unknowns.
    pub correlation: Vec<Vec<f64>>,
    /// What the observations' standard deviations were multiplied by; 1 when taken as given.
    pub noise_factor: f64,
    /// Chi-square of the fit, with the standard deviations as given.
    pub goodness: GoodnessOfFit,
    /// `root root^T = matrix`.
    pub(crate) root: Vec<Vec<f64>>,
    unknowns: Vec<Unknown>,
}

impl Covariance {
    /// The central interval of an unknown at a level such as 0.95, in values, within its bounds.
    ///
    /// # Errors
    ///
    /// [`IdentifyError::Size`] for an unknown that does not exist, [`IdentifyError::Option`] for
    /// a level outside (0, 1).
    pub fn interval(&self, unknown: usize, level: f64) -> Result<[f64; 2], IdentifyError> {
        check_level(level)?;
        let Some(which) = self.unknowns.get(unknown) else {
            let (quantity, expected) = ("as index of an unknown", self.unknowns.len());
            return Err(IdentifyError::Size { quantity, found: unknown, expected });
        };
        let reach = normal_half_width(level) * self.standard_deviations[unknown];
        let centre = self.centre[unknown];
        Ok([which.from_working(centre - reach), which.from_working(centre + reach)])
    }

    /// Standard deviations of the values, to first order.
    pub fn value_standard_deviations(&self) -> Vec<f64> {
        let deviation = |(j, unknown): (usize, &Unknown)| {
            let value = unknown.from_working(self.centre[j]);
            unknown.value_slope(value) * self.standard_deviations[j]
        };
        self.unknowns.iter().enumerate().map(deviation).collect()
    }
}

/// The covariance at a fit, in working coordinates,
///
/// ```text
/// C = (J^T W J / noise_factor^2 + P)^-1,
/// ```
///
/// with the standardised Jacobian `J`, the robust weights `W`, and `P` diagonal: `1 / sd^2` of
/// an unknown's prior, or the weak `12 / range^2` of its bounds where it has none, so that an
/// undetermined direction stays finite.
///
/// With robust loss the reduced chi-square of [`NoiseScale::AtLeastGiven`] weighs each squared
/// residual with its robust weight.
///
/// # Errors
///
/// [`IdentifyError::Size`] if fit or linearisation belong to another model;
/// [`IdentifyError::Singular`] if the Jacobian holds numbers that are not finite.
pub fn covariance(
    model: &dyn ForwardModel,
    fit: &Fit,
    linearisation: &Linearisation,
    noise: NoiseScale,
) -> Result<Covariance, IdentifyError> {
    let problem = Problem::of_fit(model, fit, 1.0)?;
    let goodness = goodness(&problem, fit);
    let noise_factor = match noise {
        NoiseScale::Given => 1.0,
        NoiseScale::AtLeastGiven => noise_factor(fit, &goodness),
    };
    let mut rows = weighted_rows(&problem, fit, linearisation)?;
    rows.iter_mut().flatten().for_each(|entry| *entry /= noise_factor);
    let unknowns = problem.unknowns.to_vec();
    for (j, unknown) in unknowns.iter().enumerate() {
        let mut row = vec![0.0; unknowns.len()];
        row[j] = 1.0 / unknown.initial_deviation();
        rows.push(row);
    }
    let InverseNormal { matrix, root } = inverse_normal(&rows, unknowns.len(), "normal matrix")?;
    let standard_deviations: Vec<f64> = (0..unknowns.len()).map(|j| matrix[j][j].sqrt()).collect();
    let correlation = correlation(&matrix);
    let centre = problem.to_working(&fit.point);
    Ok(Covariance {
        centre,
        matrix,
        standard_deviations,
        correlation,
        noise_factor,
        goodness,
        root,
        unknowns,
    })
}

pub(crate) fn correlation(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let entry = |i: usize, j: usize| matrix[i][j] / (matrix[i][i] * matrix[j][j]).sqrt();
    let size = matrix.len();
    (0..size).map(|i| (0..size).map(|j| entry(i, j)).collect()).collect()
}

/// Whether the residuals of a fit are as large as its model's standard deviations say, and the
/// factor by which these are too small, at least one (R. T. Birge, Phys. Rev. 40, 207 (1932)).
///
/// # Errors
///
/// [`IdentifyError::Size`] for a fit of another model.
pub fn goodness_of_fit(
    model: &dyn ForwardModel,
    fit: &Fit,
) -> Result<(GoodnessOfFit, f64), IdentifyError> {
    let problem = Problem::of_fit(model, fit, 1.0)?;
    let found = goodness(&problem, fit);
    Ok((found, noise_factor(fit, &found)))
}

/// Chi-square of a fit with its degrees of freedom.
pub(crate) fn goodness(problem: &Problem<'_>, fit: &Fit) -> GoodnessOfFit {
    let rows = fit.residuals.len() - fit.missing.len() + problem.priors();
    let degrees_of_freedom = rows.saturating_sub(problem.unknowns.len());
    let chi_square = fit.chi_square + fit.prior_chi_square;
    let p_value = chi_square_tail(chi_square, degrees_of_freedom);
    GoodnessOfFit { chi_square, degrees_of_freedom, p_value }
}

fn noise_factor(fit: &Fit, goodness: &GoodnessOfFit) -> f64 {
    let answered = fit.residuals.iter().zip(&fit.weights).zip(&fit.predictions);
    let weighted: f64 = answered
        .filter(|(_, p)| p.is_some())
        .map(|((residual, w), _)| w * residual * residual)
        .sum();
    let reduced = (weighted + fit.prior_chi_square) / goodness.degrees_of_freedom.max(1) as f64;
    if goodness.degrees_of_freedom == 0 { 1.0 } else { reduced.max(1.0).sqrt() }
}
