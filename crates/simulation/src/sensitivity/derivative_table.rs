//! From the derivatives of a response to those of its observables.

use asperity_dynamics::{Sensitivity, StepHistory, central_difference};
use asperity_signal::{
    FrequencyResponse, HarmonicOptions, PeakSensitivity, ReceptanceFeatures, SignalError,
};

use crate::assemble::Interfaces as _;
use crate::prepared_scenario::PreparedScenario;
use crate::quantity::{Accessor, Observable};
use crate::response_parts::{PeakValues, ResponseParts, displacement_to_rest, frequency_response};
use crate::static_state::StaticSummary;
use crate::warning::Warning;

/// Observables of a hit and their derivatives with respect to its parameters, row by row.
#[derive(Debug)]
pub struct DerivativeTable {
    /// The observables that have derivatives, in the order of [`Observable::all`].
    pub observables: Vec<Observable>,
    /// Their values; none where the response has no such peak.
    pub values: Vec<Option<f64>>,
    /// Row per observable, column per parameter.
    pub jacobian: Vec<Vec<Option<f64>>>,
    /// Warnings about the response.
    pub warnings: Vec<Warning>,
}

/// States at rest at the places of the stencil of one parameter, and the step between them.
pub type StaticStencil<'a> = ([&'a StaticSummary; 4], f64);

impl DerivativeTable {
    /// The table of a differentiated hit on `prepared`, with the states at rest around it for each
    /// parameter.
    ///
    /// # Errors
    /// [`SignalError`] when the response cannot be analysed.
    pub fn new(
        prepared: &PreparedScenario,
        found: &Sensitivity,
        stencils: &[StaticStencil<'_>],
    ) -> Result<Self, SignalError> {
        // The state at the very end is beyond the samples.
        let count = found.values.displacement.len() - 1;
        let StepHistory { force, displacement, .. } = &found.values;
        let natural = prepared.at_rest.natural_frequency_hz;
        let has_friction = prepared.assembly.structure.has_friction();
        let response = match natural {
            Some(_) => {
                let (force, displacement) = (&force[..count], &displacement[..count]);
                frequency_response(force, displacement, 1.0 / found.step, has_friction)?
            }
            None => None,
        };
        let (mut features, mut peaks) = (ReceptanceFeatures::default(), Vec::new());
        if let (Some(response), Some(natural)) = (&response, natural) {
            features = ReceptanceFeatures::of(response, natural, &HarmonicOptions::default());
            peaks = peak_derivatives(response, &features, &found.derivatives, has_friction);
        }
        let contacts = &found.values.contacts;
        let parts = ResponseParts {
            at_rest: &prepared.at_rest,
            interfaces: prepared.assembly.structure.contacts(),
            peaks: PeakValues::of(&features),
            masked_hz: Vec::new(),
            marginal_hz: Vec::new(),
            hidden_hz: None,
            remaining: None,
            contacts: contacts.clone(),
            contact_lost: Vec::new(),
            energy: None,
            step: found.step,
            steps: count,
        };
        peaks.resize(found.derivatives.len(), PeakValues::default());
        let derivatives = |Observable { quantity, interface }: Observable| -> Vec<Option<f64>> {
            match quantity.accessor() {
                Accessor::AtRest(read) => {
                    let difference = |(states, step): &StaticStencil<'_>| {
                        let [a, b, c, d] = states.map(|state| read(state, interface));
                        Some(central_difference([a?, b?, c?, d?], *step))
                    };
                    stencils.iter().map(difference).collect()
                }
                Accessor::Contact(read) => {
                    let of = |history: &StepHistory| Some(read(history.contacts.get(interface?)?));
                    found.derivatives.iter().map(of).collect()
                }
                Accessor::Peaks(read) => peaks.iter().map(read).collect(),
                Accessor::Parts(_) => vec![None; found.derivatives.len()],
            }
        };
        let mut observables = Observable::all(contacts.len());
        observables.retain(|observable| observable.quantity.has_derivative());
        Ok(Self {
            values: observables.iter().map(|one| one.value(&parts)).collect(),
            jacobian: observables.iter().map(|&one| derivatives(one)).collect(),
            warnings: parts.warnings(),
            observables,
        })
    }
}

/// Derivatives of the receptance peaks of a `response` from those of its displacement and force, for
/// each parameter.
fn peak_derivatives(
    response: &FrequencyResponse,
    features: &ReceptanceFeatures,
    derivatives: &[StepHistory],
    has_friction: bool,
) -> Vec<PeakValues> {
    let [first, second] = [features.harmonics.fundamental, features.harmonics.second];
    let of_first = first.map(|peak| PeakSensitivity::new(response, &peak, features.half_power));
    let of_second = second.map(|peak| PeakSensitivity::new(response, &peak, None));
    let derivative = |history: &StepHistory| {
        // The state at the very end is beyond the samples.
        let count = history.displacement.len() - 1;
        let displacement = displacement_to_rest(&history.displacement[..count], has_friction);
        let (displacement, force) = (&displacement[..], &history.force[..count]);
        let change = |of: &Option<PeakSensitivity>| {
            let change = of.as_ref()?.peak(displacement, force);
            Some((change.frequency_hz, change.magnitude))
        };
        let (fundamental, harmonic) = (change(&of_first), change(&of_second));
        let ratio = || {
            let (below, above) = (first?.magnitude, second?.magnitude);
            let relative = harmonic?.1 / above - fundamental?.1 / below;
            Some(relative * above / below)
        };
        PeakValues {
            fundamental,
            second: harmonic,
            ratio: ratio(),
            damping_ratio: of_first.as_ref().and_then(|of| of.damping_ratio(displacement, force)),
            damping_ratio_decrement: None,
        }
    };
    derivatives.iter().map(derivative).collect()
}
