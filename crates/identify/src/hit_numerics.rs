//! Step, modes and estimated errors of the simulated hits at the best fit.

use asperity_inference::{ForwardModel as _, Observation};
use asperity_simulation::error::SimulationError;
use asperity_simulation::quantity::Quantity;
use asperity_simulation::warning::Warning;
use serde::Serialize;

use crate::hit::{ConvergedHit, HitResolution};
use crate::observed_quantity::ObservedQuantity;
use crate::scenario_model::ScenarioModel;

/// Numerics of one simulated hit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HitNumerics {
    /// Name of the first data that ask for the hit.
    pub data: String,
    /// Peak force \[N\].
    pub peak_n: f64,
    /// Step \[s\].
    pub step_s: f64,
    /// Modes of each body, the rigid one included.
    pub modes_per_body: Vec<usize>,
    /// Largest estimated error of the observables over their scales; the error of the fundamental
    /// frequency counts tenfold.
    pub estimated_error: Option<f64>,
    /// Time \[s\] from which on the response depends on rounding.
    pub sensitive_from_s: Option<f64>,
    /// Warnings about the response.
    pub warnings: Vec<Warning>,
}

impl HitNumerics {
    /// The numerics of all hits of a model, `converged` at one point; hits that fail there are
    /// left out.
    fn of(model: &ScenarioModel, converged: &[Result<ConvergedHit, SimulationError>]) -> Vec<Self> {
        let hits = model.hits.iter().zip(converged);
        let numerics = hits.filter_map(|(hit, converged)| {
            let ConvergedHit { peak, resolution, observables } = converged.as_ref().ok()?;
            let HitResolution { step, counts, .. } = resolution.as_ref()?;
            let number = |quantity| observables.get(quantity, None);
            Some(Self {
                data: hit.data.clone(),
                peak_n: *peak,
                step_s: *step,
                modes_per_body: counts.clone(),
                estimated_error: number(Quantity::EstimatedError).filter(|error| error.is_finite()),
                sensitive_from_s: number(Quantity::SensitiveFrom),
                warnings: observables.warnings.clone(),
            })
        });
        numerics.collect()
    }

    /// A notice for each kind of warning, about the first hit that has it.
    pub(super) fn notices(all: &[Self]) -> Vec<String> {
        let mut kinds: Vec<(&Warning, &Self, usize)> = Vec::new();
        for hit in all {
            for warning in &hit.warnings {
                match kinds.iter_mut().find(|(known, ..)| known.kind() == warning.kind()) {
                    Some((.., count)) => *count += 1,
                    None => kinds.push((warning, hit, 1)),
                }
            }
        }
        let notice = |(warning, hit, count): (&Warning, &Self, usize)| {
            format!(
                "{count} of {} simulated hits at the best fit have the warning {}; the first, \
                 {:.3} N of \"{}\": {warning}",
                all.len(),
                warning.kind(),
                hit.peak_n,
                hit.data
            )
        };
        kinds.into_iter().map(notice).collect()
    }
}

/// Estimated errors of the integration in the predictions of one feature.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeatureErrors {
    /// The feature.
    pub feature: String,
    /// Number of observations whose prediction has an estimate.
    pub observations: usize,
    /// Root mean square of error over standard deviation of the observation.
    pub deviations: f64,
}

/// Numerics of the hits of a model at a point, and the errors in their observed features.
pub(super) fn numerics_at(
    model: &ScenarioModel,
    point: &[f64],
) -> Result<(Vec<HitNumerics>, Vec<FeatureErrors>), SimulationError> {
    let converged = model.converged(point)?;
    let errors = FeatureErrors::all(model, &converged, model.observations());
    Ok((HitNumerics::of(model, &converged), errors))
}

impl FeatureErrors {
    /// The errors of each observed feature of the hits, `converged` at one point.
    fn all(
        model: &ScenarioModel,
        converged: &[Result<ConvergedHit, SimulationError>],
        observations: &[Observation],
    ) -> Vec<Self> {
        let mut found: Vec<Self> = Vec::new();
        for (quantity, observation) in model.quantities.iter().zip(observations) {
            let ObservedQuantity::Feature { hit, column } = *quantity else { continue };
            let Some(Ok(run)) = converged.get(hit) else { continue };
            let error = run.observables.estimate().map(|estimate| estimate.errors[column]);
            let Some(error) = error.filter(|error| error.is_finite()) else { continue };
            let square = (error / observation.standard_deviation).powi(2);
            let feature = &model.columns.names[column];
            match found.iter_mut().find(|one| one.feature == *feature) {
                Some(one) => {
                    one.observations += 1;
                    one.deviations += square;
                }
                None => found.push(Self {
                    feature: feature.clone(),
                    observations: 1,
                    deviations: square,
                }),
            }
        }
        for one in &mut found {
            one.deviations = (one.deviations / one.observations as f64).sqrt();
        }
        found
    }
}
