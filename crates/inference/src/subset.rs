//! A model seen through some of its observations.

use crate::model::{Derivatives, ForwardModel, Observation, Predictions, Refusal};
use crate::unknown::Unknown;

/// The model with only the observations kept, in their order.
pub(crate) struct Subset<'a> {
    model: &'a dyn ForwardModel,
    kept: Vec<usize>,
    observations: Vec<Observation>,
}

impl<'a> Subset<'a> {
    pub(crate) fn new(model: &'a dyn ForwardModel, keep: impl Fn(&Observation) -> bool) -> Self {
        let all = model.observations();
        let kept: Vec<usize> = (0..all.len()).filter(|&i| keep(&all[i])).collect();
        let observations = kept.iter().map(|&i| all[i].clone()).collect();
        Self { model, kept, observations }
    }

    fn choose<T: Clone>(&self, all: &[T]) -> Vec<T> {
        // Too short an answer stays too short, and is refused by whoever asked.
        self.kept.iter().filter_map(|&i| all.get(i).cloned()).collect()
    }
}

impl ForwardModel for Subset<'_> {
    fn unknowns(&self) -> &[Unknown] {
        self.model.unknowns()
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, Refusal>> {
        let answers = self.model.predict(points).into_iter();
        answers.map(|answer| answer.map(|all| self.choose(&all))).collect()
    }

    fn differentiate(&self, point: &[f64]) -> Option<Result<Derivatives, Refusal>> {
        Some(self.model.differentiate(point)?.map(|all| Derivatives {
            values: self.choose(&all.values),
            jacobian: self.choose(&all.jacobian),
        }))
    }
}
