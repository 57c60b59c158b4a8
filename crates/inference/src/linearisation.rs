//! The model made linear at the optimum, as exactly as can be had.

use crate::error::IdentifyError;
use crate::fit::Fit;
use crate::model::{ForwardModel, Predictions};
use crate::problem::Problem;
use crate::stencil::{Order, Stencil};

/// Derivatives at a point in the units in which statistics are done.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// Values of the unknowns at the point.
    pub point: Vec<f64>,
    /// Predictions there.
    pub predictions: Predictions,
    /// A row per observation, a column per unknown: `(d prediction / d x) / sd` with the working
    /// coordinate `x` and the observation's standard deviation; zero where a prediction is
    /// missing. Robust weights are not in it.
    pub jacobian: Vec<Vec<f64>>,
    /// Whether the derivatives are the model's own.
    pub exact: bool,
    /// Largest difference between the model's own derivatives and differences, relative to the
    /// largest entry of the column, or to a derivative that moves a prediction by one standard
    /// deviation over all that is unknown beforehand, if that is larger; `None` if the model has
    /// none of its own.
    pub derivative_difference: Option<f64>,
}

/// Makes the model linear at a fit: its own derivatives where it has them, else fourth-order
/// differences with the fit's relative step. Both are computed where both exist, and compared.
///
/// # Errors
///
/// Those of [`crate::fit()`]'s checks, and [`IdentifyError::Size`] for a fit of another model.
pub fn linearise(model: &dyn ForwardModel, fit: &Fit) -> Result<Linearisation, IdentifyError> {
    let problem = Problem::of_fit(model, fit, 1.0)?;
    let x = problem.to_working(&fit.point);
    let unknowns = x.len();
    let stencil = {
        let nothing_held = vec![false; unknowns];
        Stencil::new(&problem, &x, &nothing_held, fit.options.difference_step, Order::Fourth)
    };
    let answers = problem.predict(&stencil.points);
    let mut differences = stencil.derivatives(&fit.predictions, &answers, unknowns);
    for (row, observation) in differences.iter_mut().zip(problem.observations) {
        for entry in row {
            *entry /= observation.standard_deviation;
        }
    }
    let own = own_derivatives(&problem, fit);
    let derivative_difference =
        own.as_ref().map(|own| largest_difference(&problem, own, &differences));
    Ok(Linearisation {
        point: fit.point.clone(),
        predictions: fit.predictions.clone(),
        exact: own.is_some(),
        jacobian: own.unwrap_or(differences),
        derivative_difference,
    })
}

/// The model's own standardised derivatives in working coordinates, if they are complete.
fn own_derivatives(problem: &Problem<'_>, fit: &Fit) -> Option<Vec<Vec<f64>>> {
    let unknowns = problem.unknowns;
    let derivatives = problem.model().differentiate(&fit.point)?.ok()?;
    if derivatives.jacobian.len() != problem.observations.len() {
        return None;
    }
    let rows = derivatives.jacobian.iter().zip(problem.observations).zip(&fit.predictions);
    rows.map(|((row, observation), prediction)| {
        if prediction.is_none() {
            return Some(vec![0.0; unknowns.len()]);
        }
        if row.len() != unknowns.len() {
            return None;
        }
        let entry = |(j, entry): (usize, &Option<f64>)| {
            let slope = unknowns[j].value_slope(fit.point[j]);
            entry.map(|d| d * slope / observation.standard_deviation).filter(|d| d.is_finite())
        };
        row.iter().enumerate().map(entry).collect()
    })
    .collect()
}

fn largest_difference(problem: &Problem<'_>, own: &[Vec<f64>], differences: &[Vec<f64>]) -> f64 {
    let unknowns = own.first().map_or(0, Vec::len);
    let column = |j: usize| {
        let least = 1.0 / problem.unknowns[j].initial_deviation();
        let largest = own.iter().map(|row| row[j].abs()).fold(least, f64::max);
        let apart = own.iter().zip(differences).map(|(a, b)| (a[j] - b[j]).abs());
        apart.fold(0.0, f64::max) / largest
    };
    (0..unknowns).map(column).fold(0.0, f64::max)
}
