//! Predictions whose residuals have independent errors, where observations share causes of error.

use crate::observed_quantity::ObservedQuantity;
use crate::scenario_model::ScenarioModel;

/// Numbers that are made independent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    /// Predictions.
    Values,
    /// Their rates of change.
    Rates,
}

impl ScenarioModel {
    /// Moves predictions of receptances with [shared errors](crate::hit::SharedErrors), so that their residuals are
    /// those with independent errors: `y' = d + s L^-1 ((y - d) / s)` with the values `d` and standard deviations `s` of
    /// the observations. Receptances that are not all predicted or observed stay.
    pub(super) fn make_errors_independent(&self, predictions: &mut [Option<f64>], of: Of) {
        for (number, hit) in self.hits.iter().enumerate() {
            for shared in &hit.shared_errors {
                let is_among = |quantity: &ObservedQuantity| {
                    matches!(quantity, ObservedQuantity::Receptance { hit, place, .. }
                        if *hit == number && shared.lines.contains(place))
                };
                let of_quantities = self.quantities.iter().enumerate();
                let places: Vec<usize> = of_quantities
                    .filter(|(_, quantity)| is_among(quantity))
                    .map(|(place, _)| place)
                    .collect();
                if places.len() != shared.errors.standard_deviations().len() {
                    continue;
                }
                let from = |place: usize| match of {
                    Of::Values => self.observations[place].value,
                    Of::Rates => 0.0,
                };
                let deviation = |place: usize| self.observations[place].standard_deviation;
                let standardised = places
                    .iter()
                    .map(|&place| Some((predictions[place]? - from(place)) / deviation(place)));
                let Some(mut residuals) = standardised.collect::<Option<Vec<f64>>>() else {
                    continue;
                };
                shared.errors.make_independent(&mut residuals);
                for (&place, residual) in places.iter().zip(residuals) {
                    predictions[place] = Some(from(place) + deviation(place) * residual);
                }
            }
        }
    }
}
