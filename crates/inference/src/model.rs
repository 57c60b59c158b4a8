//! What the statistics see of a model: unknowns, observations, predictions.

use crate::unknown::Unknown;

/// One measured number.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// What it is, for messages.
    pub label: String,
    /// What is left out together in a cross-validation, for example the number of the hit.
    pub block: usize,
    /// The measured value, in the unit of the model's prediction.
    pub value: f64,
    /// Its standard deviation, positive, in the same unit.
    pub standard_deviation: f64,
}

/// Why a point has no predictions at all.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// The reason, as the end of a sentence.
    pub reason: String,
}

/// One prediction per observation; `None` where the model has no such answer (a missing peak).
pub type Predictions = Vec<Option<f64>>;

/// Predictions with their derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivatives {
    /// The predictions at the point.
    pub values: Predictions,
    /// A row per observation, a column per unknown: derivatives by the unknowns' values (not by
    /// their working coordinates). `None` where there is no derivative.
    pub jacobian: Vec<Vec<Option<f64>>>,
}

/// A model that predicts measurements from values of its unknowns.
pub trait ForwardModel: Sync {
    /// The unknowns, in the order of a point's entries.
    fn unknowns(&self) -> &[Unknown];

    /// The measurements, in the order of the predictions.
    fn observations(&self) -> &[Observation];

    /// Predictions at many points (a value per unknown), one answer per point in their order.
    ///
    /// Callers send as many points at a time as they can, so that a model may work on them in
    /// parallel. The answers must not depend on how points are grouped.
    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, Refusal>>;

    /// Exact derivatives at a point, if the model has them. By default it has none.
    fn differentiate(&self, point: &[f64]) -> Option<Result<Derivatives, Refusal>> {
        let _ = point;
        None
    }
}
