//! From the derivatives of a response to those of its observables.

use asperity_dynamics::{Sensitivity, StepHistory, central_difference};
use asperity_signal::{
    FrequencyResponse, HarmonicOptions, Harmonics, Peak, PeakSensitivity, SharedForceFeatures,
    SignalError, find_harmonics, half_power_crossings,
};

use crate::observables::{ContactView, Peaks, ResponseView, contact_value, frequency_response};
use crate::prepared_scenario::PreparedScenario;
use crate::quantity::{Observable, Quantity};
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
        let response = match natural {
            Some(_) => {
                frequency_response(&force[..count], &displacement[..count], 1.0 / found.step)?
            }
            None => None,
        };
        let harmonics = match (&response, natural) {
            (Some(response), Some(natural)) => {
                find_harmonics(response, natural, &HarmonicOptions::default())
            }
            _ => Harmonics::default(),
        };
        let derivatives = Derivatives {
            stencils,
            found,
            samples: count,
            first: PeakDerivative::new(response.as_ref(), harmonics.fundamental, true),
            second: PeakDerivative::new(response.as_ref(), harmonics.second, false),
        };
        let damping_ratio = derivatives.first.as_ref().and_then(|first| first.damping_ratio);
        let features = SharedForceFeatures { harmonics, damping_ratio };
        let contacts = &found.values.contacts;
        let view = ResponseView {
            at_rest: &prepared.at_rest,
            interfaces: prepared.assembly.structure.contacts(),
            peaks: Peaks { features, decrement: None },
            contacts: contacts
                .iter()
                .map(|&measures| ContactView { measures, lost: None })
                .collect(),
            energy: None,
            step: found.step,
            steps: count,
        };
        let mut observables = Observable::all(contacts.len());
        observables.retain(|observable| observable.quantity.has_derivative());
        Ok(Self {
            values: observables.iter().map(|&one| view.value(one)).collect(),
            jacobian: observables.iter().map(|&one| derivatives.of(one)).collect(),
            warnings: view.warnings(),
            observables,
        })
    }
}

/// The derivatives of a response.
struct Derivatives<'a> {
    stencils: &'a [StaticStencil<'a>],
    found: &'a Sensitivity,
    samples: usize,
    first: Option<PeakDerivative>,
    second: Option<PeakDerivative>,
}

impl Derivatives<'_> {
    /// Derivatives of an observable with respect to every parameter.
    fn of(&self, observable: Observable) -> Vec<Option<f64>> {
        let Observable { quantity, interface } = observable;
        match quantity {
            Quantity::PressureMin
            | Quantity::PressureMax
            | Quantity::StiffnessAverage
            | Quantity::StiffnessAtPressureMin => {
                let of = |course: &StepHistory| {
                    contact_value(course.contacts.get(interface?)?, quantity)
                };
                self.found.derivatives.iter().map(of).collect()
            }
            Quantity::NaturalFrequency
            | Quantity::StaticPressure
            | Quantity::StaticStiffness
            | Quantity::StaticClosure => {
                let of = |(states, step): &StaticStencil<'_>| {
                    let [a, b, c, d] = states.map(|state| state.value(observable));
                    Some(central_difference([a?, b?, c?, d?], *step))
                };
                self.stencils.iter().map(of).collect()
            }
            _ => {
                let of = |course: &StepHistory| {
                    let displacement = &course.displacement[..self.samples];
                    self.of_peaks(quantity, displacement, &course.force[..self.samples])
                };
                self.found.derivatives.iter().map(of).collect()
            }
        }
    }

    /// Derivative of a quantity of the receptance from those of displacement and force.
    fn of_peaks(&self, quantity: Quantity, displacement: &[f64], force: &[f64]) -> Option<f64> {
        let first = self.first.as_ref();
        let moved = |peak: Option<&PeakDerivative>| {
            peak.map(|peak| peak.sensitivity.peak(displacement, force))
        };
        match quantity {
            Quantity::FundamentalFrequency => Some(moved(first)?.frequency_hz),
            Quantity::FundamentalReceptance => Some(moved(first)?.magnitude),
            Quantity::DampingRatio => first?.sensitivity.damping_ratio(displacement, force),
            Quantity::SecondHarmonicFrequency => Some(moved(self.second.as_ref())?.frequency_hz),
            Quantity::SecondHarmonicReceptance => Some(moved(self.second.as_ref())?.magnitude),
            Quantity::HarmonicRatio => {
                let (below, above) = (first?.peak.magnitude, self.second.as_ref()?.peak.magnitude);
                let relative = moved(self.second.as_ref())?.magnitude / above
                    - moved(first)?.magnitude / below;
                Some(relative * above / below)
            }
            _ => None,
        }
    }
}

/// A peak of the receptance and its derivative.
struct PeakDerivative {
    peak: Peak,
    /// Half-power damping ratio, if wanted and there is one.
    damping_ratio: Option<f64>,
    sensitivity: PeakSensitivity,
}

impl PeakDerivative {
    /// Of `peak`, with its half-power points if `damped`.
    fn new(response: Option<&FrequencyResponse>, peak: Option<Peak>, damped: bool) -> Option<Self> {
        let (response, peak) = (response?, peak?);
        let crossings = if damped { half_power_crossings(response, &peak) } else { None };
        let damping_ratio = crossings.map(|crossings| crossings.ratio());
        Some(Self {
            peak,
            damping_ratio,
            sensitivity: PeakSensitivity::new(response, &peak, crossings),
        })
    }
}
