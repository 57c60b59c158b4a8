//! Which combinations of the unknowns the data determine.

use faer::Mat;

use crate::error::{IdentifyError, check_size};
use crate::fit::Fit;
use crate::linearisation::Linearisation;
use crate::model::ForwardModel;
use crate::problem::Problem;
use crate::unknown::Unknown;

/// A combination is undetermined when the data leave at least this part of the standard
/// deviation it had before.
pub const UNDETERMINED_SHARE: f64 = 1.0 / 3.0;

/// A combination of unknowns that the data say little about.
#[derive(Debug, Clone, PartialEq)]
pub struct Undetermined {
    /// Name and weight of every unknown in it, largest first. Weights are per standard
    /// deviation before the measurement and have unit length.
    pub weights: Vec<(String, f64)>,
    /// Its standard deviation after the measurement over the one before, up to 1.
    pub remaining: f64,
}

/// What the data determine near the optimum.
#[derive(Debug, Clone, PartialEq)]
pub struct Identifiability {
    /// Singular values of the scaled Jacobian, largest first, one per unknown: how many times
    /// more precise the data are than what was known before, along each combination.
    pub singular_values: Vec<f64>,
    /// The combinations themselves, in the order of the singular values: unit weights per
    /// unknown.
    pub directions: Vec<Vec<f64>>,
    /// Largest over smallest singular value; infinite if the smallest is zero.
    pub condition: f64,
    /// Combinations that the data leave undetermined, the least determined first.
    pub undetermined: Vec<Undetermined>,
}

/// Singular values of the Jacobian with each column scaled by what was known of the unknown
/// before: the prior's standard deviation, or `range / sqrt(12)` of the bounds, in working
/// coordinates. Rows carry the fit's robust weights.
///
/// Along a right singular vector with value `s` the standard deviation shrinks from 1 to
/// `1 / sqrt(1 + s^2)`; [`UNDETERMINED_SHARE`] says when that is not enough.
///
/// # Errors
///
/// [`IdentifyError::Size`] if fit or linearisation belong to another model;
/// [`IdentifyError::Singular`] if the Jacobian holds numbers that are not finite.
pub fn identifiability(
    model: &dyn ForwardModel,
    fit: &Fit,
    linearisation: &Linearisation,
) -> Result<Identifiability, IdentifyError> {
    let problem = Problem::of_fit(model, fit, 1.0)?;
    let unknowns = problem.unknowns;
    let rows = weighted_rows(&problem, fit, linearisation)?;
    let before: Vec<f64> = unknowns.iter().map(Unknown::initial_deviation).collect();
    // Zero rows make the matrix at least square, so that every combination appears.
    let scaled = Mat::from_fn(rows.len().max(unknowns.len()), unknowns.len(), |i, j| {
        rows.get(i).map_or(0.0, |row| row[j] * before[j])
    });
    let singular = IdentifyError::Singular { matrix: "Jacobian" };
    if rows.iter().flatten().any(|entry| !entry.is_finite()) {
        return Err(singular);
    }
    let decomposition = scaled.thin_svd().map_err(|_| singular)?;
    let (values, vectors) = (decomposition.S().column_vector(), decomposition.V());
    let count = unknowns.len();
    let singular_values: Vec<f64> = (0..count).map(|k| values[k]).collect();
    let direction = |k: usize| -> Vec<f64> {
        let largest =
            (0..count).map(|j| vectors[(j, k)]).max_by(|a, b| a.abs().total_cmp(&b.abs()));
        let sign = largest.unwrap_or(1.0).signum();
        (0..count).map(|j| sign * vectors[(j, k)]).collect()
    };
    let directions: Vec<Vec<f64>> = (0..count).map(direction).collect();
    let undetermined = (0..count).rev().filter_map(|k| {
        let remaining = 1.0 / singular_values[k].hypot(1.0);
        let mut weights: Vec<(String, f64)> =
            unknowns.iter().zip(&directions[k]).map(|(u, &w)| (u.name().to_owned(), w)).collect();
        weights.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        (remaining >= UNDETERMINED_SHARE).then_some(Undetermined { weights, remaining })
    });
    Ok(Identifiability {
        condition: singular_values[0] / singular_values[count - 1],
        undetermined: undetermined.collect(),
        singular_values,
        directions,
    })
}

/// Standardised Jacobian rows times the roots of the fit's robust weights.
pub(crate) fn weighted_rows(
    problem: &Problem<'_>,
    fit: &Fit,
    linearisation: &Linearisation,
) -> Result<Vec<Vec<f64>>, IdentifyError> {
    let (found, expected) = (linearisation.jacobian.len(), problem.observations.len());
    check_size("rows of the Jacobian", found, expected)?;
    for row in &linearisation.jacobian {
        check_size("columns of the Jacobian", row.len(), problem.unknowns.len())?;
    }
    let rows = linearisation.jacobian.iter().zip(&fit.residuals);
    Ok(rows
        .map(|(row, &residual)| {
            let root = problem.loss.weight(residual).sqrt();
            row.iter().map(|entry| entry * root).collect()
        })
        .collect())
}
