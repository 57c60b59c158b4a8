//! Forward models: parameters, observations, predictions.

use std::fmt;

use crate::parameter::Parameter;

/// One measured number.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// Description, for messages.
    pub label: String,
    /// Group that a cross-validation leaves out as a whole, for example the number of the hit.
    pub block: usize,
    /// The measured value, in the unit of the model's prediction.
    pub value: f64,
    /// Its standard deviation, positive, in the same unit.
    pub standard_deviation: f64,
}

impl Observation {
    /// Observations `y0`, `y1`, ... with a common standard deviation, each a block of its own.
    pub fn list(values: &[f64], standard_deviation: f64) -> Vec<Self> {
        let one = |(block, &value): (usize, &f64)| Self {
            label: format!("y{block}"),
            block,
            value,
            standard_deviation,
        };
        values.iter().enumerate().map(one).collect()
    }
}

/// The error of a model that has no predictions at a point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PredictionError {
    /// The reason, as the end of a sentence.
    pub reason: String,
}

/// One prediction per observation; `None` where the model has none (a missing peak).
pub type Predictions = Vec<Option<f64>>;

/// Predictions with their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives {
    /// The predictions at the point.
    pub values: Predictions,
    /// Derivatives with respect to the parameters' values (not their working coordinates): a row
    /// per observation, a column per parameter. `None` where there is no derivative.
    pub jacobian: Vec<Vec<Option<f64>>>,
}

/// A model that predicts measurements from values of its parameters.
pub trait ForwardModel: Sync {
    /// The parameters, in the order of a point's entries.
    fn parameters(&self) -> &[Parameter];

    /// The measurements, in the order of the predictions.
    fn observations(&self) -> &[Observation];

    /// Predictions at many points (a value per parameter), one result per point in their order.
    ///
    /// Callers pass as many points at a time as they can, so that a model may evaluate them in
    /// parallel. The results must not depend on the grouping of the points.
    ///
    /// # Errors
    ///
    /// [`PredictionError`] for a point at which the model cannot be evaluated.
    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>>;

    /// Exact derivatives at a point; `None`, the default, for a model without them.
    fn differentiate(&self, point: &[f64]) -> Option<Result<Derivatives, PredictionError>> {
        let _ = point;
        None
    }
}

/// A model given by a function of the parameters' values, without exact derivatives.
#[derive(Debug, Clone)]
pub struct FunctionModel<F> {
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// The measurements.
    pub observations: Vec<Observation>,
    /// One prediction per observation at a point.
    pub function: F,
}

impl<F: Fn(&[f64]) -> Vec<f64> + Sync> ForwardModel for FunctionModel<F> {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        points
            .iter()
            .map(|point| Ok((self.function)(point).into_iter().map(Some).collect()))
            .collect()
    }
}

/// A model with standard deviations multiplied by a common factor.
pub struct ScaledNoise<'a> {
    model: &'a dyn ForwardModel,
    observations: Vec<Observation>,
}

impl<'a> ScaledNoise<'a> {
    /// The model whose standard deviations are `factor` times the deviations of `model`.
    pub fn new(model: &'a dyn ForwardModel, factor: f64) -> Self {
        let observations = model.observations().iter().map(|observation| Observation {
            standard_deviation: factor * observation.standard_deviation,
            ..observation.clone()
        });
        Self { model, observations: observations.collect() }
    }
}

impl fmt::Debug for ScaledNoise<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ScaledNoise")
            .field("observations", &self.observations)
            .finish_non_exhaustive()
    }
}

impl ForwardModel for ScaledNoise<'_> {
    fn parameters(&self) -> &[Parameter] {
        self.model.parameters()
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        self.model.predict(points)
    }

    fn differentiate(&self, point: &[f64]) -> Option<Result<Derivatives, PredictionError>> {
        self.model.differentiate(point)
    }
}
