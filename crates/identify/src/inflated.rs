//! A model with larger standard deviations.

use asperity_inference::{Derivatives, ForwardModel, Observation, Predictions, Refusal, Unknown};

/// A model whose observations are `factor` times as uncertain.
pub(super) struct Inflated<'a> {
    model: &'a dyn ForwardModel,
    observations: Vec<Observation>,
}

impl<'a> Inflated<'a> {
    pub(super) fn new(model: &'a dyn ForwardModel, factor: f64) -> Self {
        let observations = model.observations().iter().map(|observation| Observation {
            standard_deviation: factor * observation.standard_deviation,
            ..observation.clone()
        });
        Self { model, observations: observations.collect() }
    }
}

impl ForwardModel for Inflated<'_> {
    fn unknowns(&self) -> &[Unknown] {
        self.model.unknowns()
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, Refusal>> {
        self.model.predict(points)
    }

    fn differentiate(&self, point: &[f64]) -> Option<Result<Derivatives, Refusal>> {
        self.model.differentiate(point)
    }
}
