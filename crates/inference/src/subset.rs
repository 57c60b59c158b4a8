//! A model restricted to some of its observations.

use crate::model::{ForwardModel, Observation, PredictionError, Predictions};
use crate::parameter::Parameter;

/// The model with some of its observations, in their order; without derivatives.
pub(crate) struct ObservationSubset<'a> {
    model: &'a dyn ForwardModel,
    kept: Vec<usize>,
    observations: Vec<Observation>,
}

impl<'a> ObservationSubset<'a> {
    pub(crate) fn new(model: &'a dyn ForwardModel, keep: impl Fn(&Observation) -> bool) -> Self {
        let all = model.observations();
        let kept: Vec<usize> = (0..all.len()).filter(|&i| keep(&all[i])).collect();
        let observations = kept.iter().map(|&i| all[i].clone()).collect();
        Self { model, kept, observations }
    }
}

impl ForwardModel for ObservationSubset<'_> {
    fn parameters(&self) -> &[Parameter] {
        self.model.parameters()
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        // A result of a wrong size keeps it, for the caller's check.
        let choose = |all: Predictions| {
            self.kept.iter().filter_map(|&i| all.get(i).copied()).collect::<Predictions>()
        };
        self.model.predict(points).into_iter().map(|answer| answer.map(choose)).collect()
    }
}
