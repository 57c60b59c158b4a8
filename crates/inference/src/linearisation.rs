//! The linearised model at the optimum.

use rayon::prelude::*;

use crate::error::InferenceError;
use crate::fit::Fit;
use crate::fit_problem::FitProblem;
use crate::goodness::GoodnessOfFit;
use crate::model::Predictions;
use crate::parameter::Parameter;
use crate::stencil::{Order, Stencil, StencilStep};

/// Standardised derivatives at the optimum.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// Values of the parameters at the optimum.
    pub point: Vec<f64>,
    /// Predictions there.
    pub predictions: Predictions,
    /// `(d prediction / d x) / sd` with the working coordinate `x` and the standard deviation of
    /// the observation: a row per observation, a column per parameter; zero where a prediction is
    /// missing. Without robust weights.
    pub jacobian: Vec<Vec<f64>>,
    /// True if the derivatives are the model's own.
    pub exact: bool,
    /// Largest difference between the model's own derivatives and finite differences, relative to
    /// the largest entry of the column, or to the derivative that changes a prediction by one
    /// standard deviation over the prior standard deviation of the parameter, if that is larger;
    /// `None` if the model has no derivatives.
    pub derivative_difference: Option<f64>,
    pub(crate) parameters: Vec<Parameter>,
    /// Working coordinates of the optimum.
    pub(crate) optimum: Vec<f64>,
    /// Robust weights of the residuals.
    pub(crate) weights: Vec<f64>,
    pub(crate) goodness: GoodnessOfFit,
}

impl Fit<'_> {
    /// Linearises the model at the optimum: with its own derivatives if it has them, else with
    /// fourth-order differences of the fit's relative step. The model's own are compared with
    /// second-order differences of the values that they come with.
    ///
    /// # Errors
    ///
    /// [`InferenceError::Singular`] if a derivative is not finite.
    pub fn linearise(&self) -> Result<Linearisation, InferenceError> {
        let problem = &self.problem;
        let optimum = self.optimum();
        let parameters = optimum.len();
        let free = vec![false; parameters];
        let stencil = |order, norms: &[f64]| {
            let steps =
                StencilStep { relative: self.options.difference_step, norms, lengthened: false };
            Stencil::new(problem, &optimum, &free, steps, order)
        };
        let standardised =
            |stencil: &Stencil, base: &Predictions, answers: &[Result<Predictions, String>]| {
                let mut differences = stencil.derivatives(base, answers, parameters);
                for (row, observation) in differences.iter_mut().zip(problem.observations) {
                    for entry in row {
                        *entry /= observation.standard_deviation;
                    }
                }
                differences
            };
        let (jacobian, derivative_difference) =
            if let Some((values, own)) = own_derivatives(problem, self) {
                // The values that come with derivatives are free of what these leave out, for example
                // the error of a table.
                let norms = column_norms(&own, parameters);
                let stencil = stencil(Order::Second, &norms);
                let value = |x: &Vec<f64>| problem.values_with_derivatives(x);
                let answers: Vec<_> = stencil.points.par_iter().map(value).collect();
                let differences = standardised(&stencil, &values, &answers);
                let off = largest_difference(problem, &own, &differences);
                (own, Some(off))
            } else {
                let stencil = stencil(Order::Fourth, &[]);
                let answers = problem.predict(&stencil.points);
                (standardised(&stencil, &self.predictions, &answers), None)
            };
        if jacobian.iter().flatten().any(|entry| !entry.is_finite()) {
            return Err(InferenceError::Singular("Jacobian"));
        }
        Ok(Linearisation {
            point: self.point.clone(),
            predictions: self.predictions.clone(),
            jacobian,
            exact: derivative_difference.is_some(),
            derivative_difference,
            parameters: problem.parameters.to_vec(),
            optimum,
            weights: self.weights.clone(),
            goodness: self.goodness(),
        })
    }
}

impl Linearisation {
    /// Rows of the Jacobian, with the robust weights of the residuals.
    pub fn weighted(&self) -> impl Iterator<Item = (&[f64], f64)> {
        self.jacobian.iter().map(Vec::as_slice).zip(self.weights.iter().copied())
    }

    /// Rows of the Jacobian times the roots of the robust weights.
    pub(crate) fn weighted_rows(&self) -> Vec<Vec<f64>> {
        let rows = self.jacobian.iter().zip(&self.weights);
        rows.map(|(row, weight)| row.iter().map(|entry| entry * weight.sqrt()).collect()).collect()
    }
}

/// The predictions that the model gives with its own derivatives, and these, standardised and in
/// working coordinates, if they are complete.
fn own_derivatives(
    problem: &FitProblem<'_>,
    fit: &Fit<'_>,
) -> Option<(Predictions, Vec<Vec<f64>>)> {
    let parameters = problem.parameters;
    let derivatives = problem.model().differentiate(&fit.point)?.ok()?;
    if derivatives.jacobian.len() != problem.observations.len() {
        return None;
    }
    let rows = derivatives.jacobian.iter().zip(problem.observations).zip(&fit.predictions);
    let rows = rows.map(|((row, observation), prediction)| {
        if prediction.is_none() {
            return Some(vec![0.0; parameters.len()]);
        }
        if row.len() != parameters.len() {
            return None;
        }
        let entry = |(j, entry): (usize, &Option<f64>)| {
            let slope = parameters[j].d_value_d_working(fit.point[j]);
            entry.map(|d| d * slope / observation.standard_deviation).filter(|d| d.is_finite())
        };
        row.iter().enumerate().map(entry).collect()
    });
    let rows = rows.collect::<Option<_>>()?;
    Some((derivatives.values, rows))
}

/// Norms of the columns of a Jacobian.
fn column_norms(rows: &[Vec<f64>], parameters: usize) -> Vec<f64> {
    let norm = |j: usize| rows.iter().map(|row| row[j] * row[j]).sum::<f64>().sqrt();
    (0..parameters).map(norm).collect()
}

fn largest_difference(problem: &FitProblem<'_>, own: &[Vec<f64>], differences: &[Vec<f64>]) -> f64 {
    let parameters = own.first().map_or(0, Vec::len);
    let column = |j: usize| {
        let least = 1.0 / problem.parameters[j].initial_deviation();
        let largest = own.iter().map(|row| row[j].abs()).fold(least, f64::max);
        let apart = own.iter().zip(differences).map(|(a, b)| (a[j] - b[j]).abs());
        apart.fold(0.0, f64::max) / largest
    };
    (0..parameters).map(column).fold(0.0, f64::max)
}
