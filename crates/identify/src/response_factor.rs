//! Factors of the response that faults of sensors, units and polarity bring, told by the receptances alone.

use asperity_inference::{ForwardModel, Predictions};

use crate::observed_quantity::ObservedQuantity;
use crate::scenario_model::ScenarioModel;

/// Factors of the response that faults of sensors, units and polarity bring.
const FACTORS: [(f64, &str); 6] = [
    (-1.0, "the response, or the force, has the other polarity"),
    (1e3, "the response is too large by a factor of 1000"),
    (1e-3, "the response is too small by a factor of 1000"),
    (9.81, "the response is too large by a factor of 9.81: m/s^2 taken for g"),
    (1.0 / 9.81, "the response is too small by a factor of 9.81: g taken for m/s^2"),
    (1e-6, "the response is too small by a factor of 1e6"),
];

/// Ratio of the distances of measured and predicted receptances by which a factor has to be nearer.
const NEARER: f64 = 0.5;

/// A factor of the response with which the start of the parameters is much nearer to the data.
pub(super) struct ResponseFactor {
    factor: f64,
    pub(super) cause: &'static str,
    /// The receptances among the observations.
    receptances: Vec<usize>,
}

impl ResponseFactor {
    /// The factor of the nearest receptances; none if those as measured are about as near, or there are none.
    pub(super) fn of(forward: &ScenarioModel) -> Option<Self> {
        // The receptances themselves, not those with independent errors.
        let mut plain = forward.with_scaled("", 1.0);
        plain.hits.iter_mut().for_each(|hit| hit.shared_errors.clear());
        let predicted = predicted(&plain, &forward.start())?;
        let is_receptance = |quantity: &ObservedQuantity| quantity.is_receptance(&forward.columns);
        let receptances: Vec<usize> =
            (0..predicted.len()).filter(|&i| is_receptance(&forward.quantities[i])).collect();
        let distance = |factor: f64| {
            let pairs = receptances
                .iter()
                .filter_map(|&i| Some((forward.observations[i].value / factor, predicted[i]?)));
            // Between 0 for equal and 2 for opposite ones, whatever their sizes.
            let parts = pairs.map(|(a, b)| ((a - b).powi(2), a * a + b * b));
            let (apart, size) = parts.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
            if size > 0.0 { apart / size } else { f64::INFINITY }
        };
        let (factor, cause) =
            *FACTORS.iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)))?;
        let is_nearer = distance(factor) <= NEARER * distance(1.0);
        (is_nearer && !receptances.is_empty()).then_some(Self { factor, cause, receptances })
    }

    /// The model with the observations divided by the factor.
    pub(super) fn without(&self, forward: &ScenarioModel) -> ScenarioModel {
        let mut trial = forward.with_scaled("", 1.0);
        for &i in &self.receptances {
            trial.observations[i].value /= self.factor;
            trial.observations[i].standard_deviation /= self.factor.abs();
        }
        trial
    }
}

/// Predictions at a point; none where the model has none.
pub(super) fn predicted(forward: &ScenarioModel, point: &[f64]) -> Option<Predictions> {
    forward.predict(&[point.to_vec()]).pop()?.ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::built_model::BuiltModel;
    use crate::identification_problem::IdentificationProblem;

    #[test]
    fn factors_are_told_at_the_start_of_a_search_and_taken_away() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../fixtures/problems/receptances_of_a_free_law.json"
        );
        let problem = IdentificationProblem::read(file).unwrap().fast();
        let problem = problem.with_pressures().unwrap();
        let BuiltModel { forward, .. } = problem.model().unwrap();
        // A start that is only far from its data has no factor.
        assert!(ResponseFactor::of(&forward).is_none());
        let found = predicted(&forward, &forward.start()).unwrap();
        let mut exact = forward.with_scaled("", 1.0);
        for (observation, value) in exact.observations.iter_mut().zip(found) {
            observation.value = value.unwrap();
        }
        assert!(ResponseFactor::of(&exact).is_none());
        for (factor, _) in FACTORS {
            let mut changed = exact.with_scaled("", 1.0);
            for observation in &mut changed.observations {
                observation.value *= factor;
                observation.standard_deviation *= factor.abs();
            }
            let found = ResponseFactor::of(&changed).unwrap();
            assert_eq!(found.factor, factor);
            let mended = found.without(&changed);
            for (mended, original) in mended.observations.iter().zip(&exact.observations) {
                assert!((mended.value / original.value - 1.0).abs() < 1e-12);
                let ratio = mended.standard_deviation / original.standard_deviation;
                assert!((ratio - 1.0).abs() < 1e-12);
            }
        }
    }
}
