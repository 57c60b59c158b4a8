//! Observables of a response, extracted by one definition from a full run, a decimated record, or
//! the steps of a differentiated hit.

use asperity_dynamics::Transient;
use asperity_signal::{HarmonicOptions, ReceptanceFeatures};

use crate::accuracy::ErrorEstimate;
use crate::assemble::{Assembly, Interfaces};
use crate::error::SimulationError;
use crate::quantity::{Observable, Quantity, Values};
use crate::response_parts::{ResponseParts, history_response};
pub use crate::response_parts::{displacement_to_rest, free_from};
use crate::static_state::StaticSummary;
use crate::warning::Warning;

/// Values of all observables of one response, and the warnings about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Observables {
    /// In the order of [`Observable::all`], then the [features](Quantity::features) of each further
    /// sensor; NaN for a quantity that the response does not have.
    pub values: Box<[f64]>,
    /// Magnitudes of the receptance \[m/N\] at the frequencies that were asked for; NaN for a response without
    /// a force.
    pub frf: Box<[f64]>,
    /// Frequencies \[Hz\] of maxima of the first sensor's receptance in the windows of the fundamental and the
    /// second harmonic that are no peaks since the force is too weak there, see
    /// [`Harmonics::masked_hz`](asperity_signal::Harmonics::masked_hz).
    pub masked_hz: Box<[f64]>,
    /// Warnings about the response.
    pub warnings: Vec<Warning>,
    estimate: Option<Box<ErrorEstimate>>,
    interfaces: usize,
}

impl Observables {
    /// The observables of a response whose history has this sample rate \[Hz\], read at all sensors.
    pub(crate) fn of_transient<S: Interfaces>(
        assembly: &Assembly<S>,
        at_rest: &StaticSummary,
        (transient, rate): (&Transient, f64),
    ) -> Result<Self, SimulationError> {
        let read = |sensor| Self::at_sensor(assembly, at_rest, (transient, rate), sensor);
        let first = read(0)?;
        let others = (1..assembly.sensors.len()).map(read);
        Ok(first.with_sensors(others.collect::<Result<Vec<_>, _>>()?))
    }

    /// The observables of a response, read at one sensor.
    fn at_sensor<S: Interfaces>(
        assembly: &Assembly<S>,
        at_rest: &StaticSummary,
        (transient, rate): (&Transient, f64),
        sensor: usize,
    ) -> Result<Self, SimulationError> {
        let history = &transient.history;
        let displacement = &history.sensors[sensor].displacement;
        let mut features = ReceptanceFeatures::default();
        if let Some(natural) = at_rest.natural_frequency_hz
            && let Some(response) = history_response(
                &history.load,
                displacement,
                rate,
                assembly.structure.has_friction(),
            )?
        {
            let free = free_from(&history.load, assembly.load.peak());
            let decay = displacement.get(free..).unwrap_or_default();
            features = ReceptanceFeatures::of(&response, natural, &HarmonicOptions::default())
                .with_decay(decay, 0.0..decay.len().saturating_sub(1) as f64, rate);
        }
        Ok(Self::of(&ResponseParts::new(
            at_rest,
            assembly.structure.interfaces(),
            &features,
            &transient.contacts,
            transient.energy,
            (transient.step, transient.steps),
        )))
    }

    /// Values of all observables, and warnings, of a response.
    pub(crate) fn of(parts: &ResponseParts<'_>) -> Self {
        let interfaces = parts.contacts.len();
        let all = Observable::all(interfaces);
        let values = all.iter().map(|&one| one.value(parts).unwrap_or(f64::NAN)).collect();
        Self {
            values,
            frf: Box::default(),
            masked_hz: parts.masked_hz.as_slice().into(),
            warnings: parts.warnings(),
            estimate: None,
            interfaces,
        }
    }

    /// These observables with the features of further sensors, from the observables of the same response
    /// there.
    pub(crate) fn with_sensors(mut self, others: Vec<Self>) -> Self {
        let mut values = self.values.into_vec();
        for other in others {
            values.extend(Quantity::features().map(|one| other.get(one, None).unwrap_or(f64::NAN)));
            if let (Some(own), Some(estimate)) = (self.estimate.take(), other.estimate) {
                self.estimate = Some(Box::new(own.larger(*estimate)));
            }
            for warning in other.warnings {
                if !self.warnings.contains(&warning) {
                    self.warnings.push(warning);
                }
            }
        }
        self.values = values.into();
        if let Some(relative) = self.estimate().map(|estimate| estimate.relative) {
            self.set(Quantity::EstimatedError, relative);
        }
        self
    }

    /// Value of a feature at the sensor of this number.
    pub fn at(&self, sensor: usize, feature: Quantity) -> Option<f64> {
        let Some(further) = sensor.checked_sub(1) else { return self.get(feature, None) };
        let count = Quantity::features().count();
        let place = Quantity::features().position(|one| one == feature)?;
        let first = Observable::all(self.interfaces).len();
        let value = self.values.get(first + further * count + place)?;
        Some(*value).filter(|value| !value.is_nan())
    }

    /// Value of a quantity of the whole structure, or of the interface of this number.
    pub fn get(&self, quantity: Quantity, interface: Option<usize>) -> Option<f64> {
        self.all().get(quantity, interface)
    }

    pub(crate) fn all(&self) -> Values<'_> {
        Values { all: &self.values, interfaces: self.interfaces }
    }

    /// Estimated errors of the values, if there are.
    pub fn estimate(&self) -> Option<&ErrorEstimate> {
        self.estimate.as_deref()
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

    /// Marks a response that depends on rounding from a time \[s\] on, as the observables of a
    /// `perturbed` run show; without one no error is known.
    pub(crate) fn set_sensitive(&mut self, from_s: f64, perturbed: Option<&Self>) {
        if let Some(estimate) = self.estimate.take() {
            let asked = estimate.asked;
            let estimate = match perturbed {
                Some(other) => {
                    estimate.larger(ErrorEstimate::new(self.all(), other.all(), 1.0, asked))
                }
                None => ErrorEstimate::unknown(self.all(), asked),
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
        if let Some(place) = (Observable { quantity, interface: None }).place(self.interfaces) {
            self.values[place] = value;
        }
    }
}
