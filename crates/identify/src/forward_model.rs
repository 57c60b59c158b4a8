//! The scenario as a forward model: predictions in batches.

use std::time::Instant;

use asperity_inference::{
    Derivatives, ForwardModel, Observation, Parameter, PredictionError, Predictions,
};
use asperity_simulation::error::SimulationError;
use rayon::prelude::*;

use crate::hit::HitResolution;
use crate::observed_quantity::{ObservedQuantity, PointOutcomes};
use crate::scenario_model::ScenarioModel;
use crate::shared_errors::Of;

/// Most points of one batch.
const MAX_POINTS: usize = 16;

impl ForwardModel for ScenarioModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters.list
    }

    fn observations(&self) -> &[Observation] {
        &self.observations
    }

    fn predict(&self, points: &[Vec<f64>]) -> Vec<Result<Predictions, PredictionError>> {
        let predict = |(point, outcomes): (&Vec<f64>, Result<PointOutcomes, SimulationError>)| {
            let outcomes = outcomes.map_err(prediction_error)?;
            let gains = self.gains(point);
            let value =
                |quantity: &ObservedQuantity| quantity.value(&outcomes, &gains, &self.columns);
            let mut values: Predictions = self.quantities.iter().map(value).collect();
            self.make_errors_independent(&mut values, Of::Values);
            Ok(values)
        };
        // Enough points per call to fill a batch, few enough to use all cores.
        let points_per_batch =
            self.points_per_batch().min(points.len().div_ceil(rayon::current_num_threads()));
        let begun = Instant::now();
        let found: Vec<_> = points
            .par_chunks(points_per_batch.max(1))
            .flat_map_iter(|points| {
                if self.work.is_stopped() {
                    return points.iter().map(|_| Err(stopped())).collect::<Vec<_>>();
                }
                let outcomes = self.outcomes(points);
                self.work.count(points.len());
                points.iter().zip(outcomes).map(predict).collect::<Vec<_>>()
            })
            .collect();
        self.work.time(points.len(), begun.elapsed().as_secs_f64());
        found
    }

    fn differentiate(&self, point: &[f64]) -> Option<Result<Derivatives, PredictionError>> {
        // One run with derivatives costs more than differences with respect to many latents; many contacts have no exact
        // derivatives.
        if self.parameters.free.is_some() || self.is_structure() {
            return None;
        }
        if self.work.is_stopped() {
            return Some(Err(stopped()));
        }
        Some(self.derivatives(point).map_err(prediction_error))
    }
}

fn stopped() -> PredictionError {
    PredictionError { reason: "stopped".to_owned() }
}

impl ScenarioModel {
    /// Number of points whose hits fill a batch best.
    fn points_per_batch(&self) -> usize {
        if self.is_structure() {
            return 1;
        }
        // Hits of one step and as many modes are integrated together, at steps of their own each by itself.
        let mut groups: Vec<(&HitResolution, usize)> = Vec::new();
        let mut others = 0;
        for hit in &self.hits {
            let Some(own) = &hit.resolution else {
                others += 1;
                continue;
            };
            if own.tolerance.is_some() {
                continue;
            }
            match groups.iter_mut().find(|(known, _)| *known == own) {
                Some((_, count)) => *count += 1,
                None => groups.push((own, 1)),
            }
        }
        let room = self.batch.room();
        let cost = |points: usize| {
            let blocks = |count: usize| ((points * count).div_ceil(room) * room) as f64;
            let own = groups.iter().map(|(held, count)| {
                blocks(*count) * held.counts.iter().sum::<usize>() as f64 / held.step
            });
            let shortest = groups.iter().map(|(held, _)| 1.0 / held.step).fold(1.0, f64::max);
            (own.sum::<f64>() + blocks(others) * shortest) / points as f64
        };
        (1..=MAX_POINTS).min_by(|&a, &b| cost(a).total_cmp(&cost(b))).unwrap_or(1)
    }
}

#[allow(clippy::needless_pass_by_value, reason = "the shape that map_err takes")]
fn prediction_error(error: SimulationError) -> PredictionError {
    PredictionError { reason: error.to_string() }
}
