//! Observables of a response, extracted by one definition from a full run, a decimated record, or
//! the steps of a differentiated hit.

use asperity_dynamics::{ContactExtremes, ContactMeasures, EnergyLedger, Transient};
use asperity_signal::{
    FrequencyResponse, HarmonicOptions, SharedForceFeatures, SignalError, find_harmonics,
    half_power, logarithmic_decrement_after,
};
use asperity_structure::PreloadedContact;

use crate::accuracy::ErrorEstimate;
use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::quantity::{Observable, Quantity};
use crate::static_state::StaticSummary;
use crate::warning::{MOST_RESIDUAL, Warning};

/// Force over its peak up to which the decay of a response counts as free.
const FREE: f64 = 1e-3;

/// Values of all observables of one response, and the warnings about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Observables {
    /// In the order of [`Observable::all`]; NaN for a quantity that the response does not have.
    pub values: Box<[f64]>,
    /// Magnitudes of the receptance \[m/N\] at the frequencies that were asked for; NaN for a response without
    /// a force.
    pub frf: Box<[f64]>,
    /// Warnings about the response.
    pub warnings: Vec<Warning>,
    estimate: Option<Box<ErrorEstimate>>,
    interfaces: usize,
}

impl Observables {
    /// The observables of a response at the output rate.
    pub(crate) fn of_transient(
        assembly: &Assembly,
        at_rest: &StaticSummary,
        transient: &Transient,
    ) -> Result<Self, SimulationError> {
        let (history, rate) = (&transient.history, assembly.sampling.rate());
        let mut peaks = Peaks::default();
        if let Some(natural) = at_rest.natural_frequency_hz
            && let Some(response) = frequency_response(&history.force, &history.displacement, rate)?
        {
            let free = free_from(&history.force, assembly.excitation.peak());
            let decay = history.displacement.get(free..).unwrap_or_default();
            peaks = Peaks::new(features_of(&response, natural), decay, 0.0, rate);
        }
        let interfaces = assembly.structure.contacts();
        let view = ResponseView {
            at_rest,
            interfaces,
            peaks,
            contacts: contact_views(interfaces, &transient.contacts),
            energy: Some(transient.energy),
            step: transient.step,
            steps: transient.steps,
        };
        Ok(view.observables())
    }

    /// Value of a quantity of the whole structure, or of the interface of this number.
    pub fn get(&self, quantity: Quantity, interface: Option<usize>) -> Option<f64> {
        let place = self.place(Observable { quantity, interface })?;
        self.values.get(place).copied().filter(|value| !value.is_nan())
    }

    /// Estimated errors of the values, if there are.
    pub fn estimate(&self) -> Option<&ErrorEstimate> {
        self.estimate.as_deref()
    }

    pub(crate) fn interfaces(&self) -> usize {
        self.interfaces
    }

    /// Place of an observable among the values.
    pub(crate) fn place(&self, wanted: Observable) -> Option<usize> {
        wanted.place(self.interfaces)
    }

    /// These observables with the errors of `estimate`, and a warning where they are larger than
    /// was asked for.
    pub(crate) fn with_estimate(mut self, estimate: ErrorEstimate) -> Self {
        self.set(Quantity::EstimatedError, estimate.relative);
        if !estimate.is_reached() {
            self.warnings.push(Warning::AccuracyNotReached {
                estimated: estimate.relative,
                asked: estimate.asked,
            });
        }
        self.estimate = Some(Box::new(estimate));
        self
    }

    /// These observables with the errors of others of the same response.
    pub(crate) fn with_estimate_of(mut self, other: &Self) -> Self {
        if let Some(estimate) = other.estimate() {
            self = self.with_estimate(estimate.clone());
        }
        if let Some(from_s) = other.get(Quantity::SensitiveFrom, None) {
            self.mark_sensitive(from_s);
        }
        self
    }

    /// Marks a response that depends on rounding from a time \[s\] on, as the observables of a
    /// `twin` show; without one no error is known.
    pub(crate) fn set_sensitive(&mut self, from_s: f64, twin: Option<&Self>) {
        if let Some(estimate) = self.estimate.take() {
            let asked = estimate.asked;
            let estimate = match twin {
                Some(twin) => estimate.larger(ErrorEstimate::new(self, twin, 1.0, asked)),
                None => ErrorEstimate::unknown(self, asked),
            };
            self.set(Quantity::EstimatedError, estimate.relative);
            self.estimate = Some(Box::new(estimate));
        }
        self.mark_sensitive(from_s);
    }

    /// Marks a response without error estimates that depends on rounding.
    pub(crate) fn mark_sensitive(&mut self, from_s: f64) {
        self.set(Quantity::SensitiveFrom, from_s);
        self.warnings.push(Warning::Sensitive { from_s });
    }

    fn set(&mut self, quantity: Quantity, value: f64) {
        if let Some(place) = self.place(Observable { quantity, interface: None }) {
            self.values[place] = value;
        }
    }
}

/// First sample after which no force exceeds a thousandth of `peak`.
pub fn free_from(force: &[f64], peak: f64) -> usize {
    force.iter().rposition(|force| force.abs() > FREE * peak).map_or(0, |last| last + 1)
}

/// Receptance peaks and damping of a response.
#[derive(Debug, Default)]
pub(crate) struct Peaks {
    /// Both harmonics, and the half-power damping ratio of the fundamental.
    pub(crate) features: SharedForceFeatures,
    /// Damping ratio by the logarithmic decrement.
    pub(crate) decrement: Option<f64>,
}

impl Peaks {
    /// The peaks of `features`, and the decrement of a `decay` \[m\] that is free from `start` on, in
    /// samples at `rate` \[Hz\].
    pub(crate) fn new(features: SharedForceFeatures, decay: &[f64], start: f64, rate: f64) -> Self {
        let fundamental = features.harmonics.fundamental;
        let decrement = fundamental
            .and_then(|peak| logarithmic_decrement_after(decay, start, rate, peak.frequency_hz))
            .map(|decrement| decrement.ratio);
        Self { features, decrement }
    }
}

/// Frequency response of samples at `rate` \[Hz\]: force \[N\] to displacement \[m\]; none without
/// a force.
pub(crate) fn frequency_response(
    force: &[f64],
    displacement: &[f64],
    rate: f64,
) -> Result<Option<FrequencyResponse>, SignalError> {
    if force.iter().all(|&force| force == 0.0) {
        return Ok(None);
    }
    FrequencyResponse::from_displacement(force, displacement, rate).map(Some)
}

/// Harmonics about the static frequency `natural` \[Hz\], and the half-power damping ratio.
pub(crate) fn features_of(response: &FrequencyResponse, natural: f64) -> SharedForceFeatures {
    let harmonics = find_harmonics(response, natural, &HarmonicOptions::default());
    let damping_ratio = harmonics.fundamental.and_then(|peak| half_power(response, &peak));
    SharedForceFeatures { harmonics, damping_ratio }
}

/// One contact of a response.
#[derive(Debug)]
pub(crate) struct ContactView {
    pub(crate) measures: ContactMeasures,
    /// Time without contact \[s\], if counted.
    pub(crate) lost: Option<f64>,
}

/// The contacts that integrators have recorded at `interfaces`.
pub(crate) fn contact_views(
    interfaces: &[PreloadedContact],
    records: &[ContactExtremes],
) -> Vec<ContactView> {
    let view = |(interface, record): (&PreloadedContact, &ContactExtremes)| ContactView {
        measures: ContactMeasures {
            pressure_min: record.pressure_min,
            pressure_max: record.pressure_max,
            stiffness_average: record.stiffness_average,
            stiffness_at_pressure_min: interface.law().stiffness(record.pressure_min),
        },
        lost: Some(record.lost),
    };
    interfaces.iter().zip(records).map(view).collect()
}

/// The parts of a response that observables are extracted from.
#[derive(Debug)]
pub(crate) struct ResponseView<'a> {
    pub(crate) at_rest: &'a StaticSummary,
    pub(crate) interfaces: &'a [PreloadedContact],
    pub(crate) peaks: Peaks,
    pub(crate) contacts: Vec<ContactView>,
    /// The energy balance, if there is one.
    pub(crate) energy: Option<EnergyLedger>,
    /// Integration step \[s\].
    pub(crate) step: f64,
    pub(crate) steps: usize,
}

impl ResponseView<'_> {
    /// Values of all observables, and warnings.
    pub(crate) fn observables(&self) -> Observables {
        let interfaces = self.contacts.len();
        let all = Observable::all(interfaces);
        let values = all.iter().map(|&one| self.value(one).unwrap_or(f64::NAN)).collect();
        let (frf, warnings) = (Box::default(), self.warnings());
        Observables { values, frf, warnings, estimate: None, interfaces }
    }

    /// Value of one observable, if the response has it.
    pub(crate) fn value(&self, observable: Observable) -> Option<f64> {
        let Observable { quantity, interface } = observable;
        let SharedForceFeatures { harmonics, damping_ratio } = &self.peaks.features;
        match quantity {
            Quantity::NaturalFrequency
            | Quantity::StaticPressure
            | Quantity::StaticStiffness
            | Quantity::StaticClosure => self.at_rest.value(observable),
            Quantity::FundamentalFrequency => Some(harmonics.fundamental?.frequency_hz),
            Quantity::FundamentalReceptance => Some(harmonics.fundamental?.magnitude),
            Quantity::DampingRatio => *damping_ratio,
            Quantity::DampingRatioDecrement => self.peaks.decrement,
            Quantity::SecondHarmonicFrequency => Some(harmonics.second?.frequency_hz),
            Quantity::SecondHarmonicReceptance => Some(harmonics.second?.magnitude),
            Quantity::HarmonicRatio => harmonics.ratio(),
            Quantity::PressureMin
            | Quantity::PressureMax
            | Quantity::StiffnessAverage
            | Quantity::StiffnessAtPressureMin => {
                contact_value(&self.contacts.get(interface?)?.measures, quantity)
            }
            Quantity::ContactLost => self.contacts.get(interface?)?.lost,
            Quantity::EnergyInput => Some(self.energy?.input),
            Quantity::EnergyDissipated => Some(self.energy?.dissipated),
            Quantity::EnergyContactDissipated => Some(self.energy?.contact_dissipated),
            Quantity::EnergyFrictionDissipated => Some(self.energy?.friction_dissipated),
            Quantity::EnergyStored => Some(self.energy?.stored()),
            Quantity::EnergyNumericalLoss => Some(self.energy?.numerical_loss),
            Quantity::EnergyResidual => Some(self.energy?.residual_relative()),
            Quantity::Step => Some(self.step),
            Quantity::Steps => Some(self.steps as f64),
            // Not read off one response.
            Quantity::EstimatedError | Quantity::SensitiveFrom => None,
        }
    }

    /// Warnings about the response.
    pub(crate) fn warnings(&self) -> Vec<Warning> {
        let pairs = self.interfaces.iter().zip(&self.contacts);
        let outside = pairs.filter_map(|(interface, contact)| {
            let ContactMeasures { pressure_min, pressure_max, .. } = contact.measures;
            Warning::outside_measured_range(interface, pressure_min, pressure_max)
        });
        let residual = self.energy.map(|energy| energy.residual_relative());
        let suspect = residual.filter(|residual| *residual > MOST_RESIDUAL);
        let balance = suspect.map(|residual_relative| Warning::EnergyBalance { residual_relative });
        outside.chain(balance).collect()
    }
}

/// The measure of a contact that is this quantity, if one is; of derivatives its derivative.
pub(crate) fn contact_value(measures: &ContactMeasures, quantity: Quantity) -> Option<f64> {
    match quantity {
        Quantity::PressureMin => Some(measures.pressure_min),
        Quantity::PressureMax => Some(measures.pressure_max),
        Quantity::StiffnessAverage => Some(measures.stiffness_average),
        Quantity::StiffnessAtPressureMin => Some(measures.stiffness_at_pressure_min),
        _ => None,
    }
}
