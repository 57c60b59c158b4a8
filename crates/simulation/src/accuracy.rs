//! Error estimates of observables, and the accuracy that is asked of them.
//!
//! The error of an observable is estimated from a second response, of another step, of half the
//! modes, or on another grid,
//!
//! ```text
//! e = |Q - Q'| / divisor,
//! ```
//!
//! where the order of the method gives the divisor: 3 for one of second order and twice the step, 1
//! for one of first. Errors of different origin are added. They are compared
//! with a scale of the observable, its own value for most.

use serde::Serialize;

use crate::observables::Observables;
use crate::quantity::{Observable, Quantity};

/// Relative accuracy of a run that asks for none.
pub const DEFAULT_ACCURACY: f64 = 1e-3;

/// The fundamental frequency is held to this share of the accuracy of the other observables.
const FREQUENCY_SHARE: f64 = 0.1;

/// Second-harmonic over fundamental receptance below which the second harmonic is not resolved for
/// its own sake.
const SMALL_HARMONIC: f64 = 1e-2;

/// Damping ratio below which the damping is not resolved for its own sake.
const SMALL_DAMPING: f64 = 1e-2;

/// Departure of one extreme pressure from rest, over the range of pressures, below which it is not
/// resolved for its own sake; and stiffness over the stiffness at rest.
const SMALL_DEPARTURE: f64 = 0.1;

/// Estimated errors of the observables of one response.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorEstimate {
    /// Relative accuracy that was asked for.
    pub asked: f64,
    /// Largest estimated error over the scale of its observable; that of the fundamental frequency
    /// counts tenfold.
    pub relative: f64,
    /// The observable with that error.
    pub worst: Option<Observable>,
    /// Estimated error of each observable in its own unit, in the order of [`Observable::all`]; NaN
    /// for one without an estimate.
    pub errors: Box<[f64]>,
}

/// The estimate as `summary.json` has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AccuracySummary {
    /// Relative accuracy that was asked for.
    pub asked: f64,
    /// Largest estimated error over the scale of its observable; that of the fundamental frequency
    /// counts tenfold.
    pub estimated_error: f64,
    /// True if that is at most the accuracy asked for.
    pub reached: bool,
    /// Name of the observable with that error.
    pub of: Option<String>,
    /// Estimated error of each observable in its own unit.
    pub errors: serde_json::Map<String, serde_json::Value>,
}

impl ErrorEstimate {
    /// The estimate from the observables of a response, and those of another: the error is their
    /// difference over `divisor`.
    pub(crate) fn new(found: &Observables, other: &Observables, divisor: f64, asked: f64) -> Self {
        let all = Observable::all(found.interfaces());
        let mut estimate =
            Self { asked, relative: 0.0, worst: None, errors: vec![f64::NAN; all.len()].into() };
        for (place, &observable) in all.iter().enumerate() {
            let Some(scale) = scale(found, observable) else { continue };
            let [a, b] = [found, other].map(|one| one.values[place]);
            // A peak that only one of them has is all error.
            let error = match (a.is_nan(), b.is_nan()) {
                (true, true) => continue,
                (false, false) => (a - b).abs() / divisor,
                _ => scale,
            };
            estimate.errors[place] = error;
            let relative = if error == 0.0 { 0.0 } else { error / scale };
            if relative > estimate.relative || relative.is_nan() {
                (estimate.relative, estimate.worst) = (relative, Some(observable));
            }
        }
        estimate
    }

    /// The errors of another response of the same structure to a force of the same shape, whose
    /// `observables` have the same relative errors.
    pub(crate) fn transferred(&self, from: &Observables, to: &Observables) -> Self {
        let mut errors = self.errors.clone();
        for (error, observable) in errors.iter_mut().zip(Observable::all(to.interfaces())) {
            let ratio = match (scale(from, observable), scale(to, observable)) {
                (Some(from), Some(to)) if from > 0.0 => to / from,
                _ => f64::NAN,
            };
            *error *= ratio;
        }
        Self { errors, ..self.clone() }
    }

    /// The larger error of two estimates for each observable.
    pub(crate) fn larger(self, other: Self) -> Self {
        let (mut more, less) =
            if other.relative > self.relative { (other, self) } else { (self, other) };
        for (error, lesser) in more.errors.iter_mut().zip(&less.errors) {
            *error = error.max(*lesser);
        }
        more
    }

    /// The sum of two errors of each observable.
    pub(crate) fn plus(mut self, other: &Self) -> Self {
        for (error, more) in self.errors.iter_mut().zip(&other.errors) {
            *error += more;
        }
        if other.relative > self.relative {
            self.worst = other.worst;
        }
        // At least that of any observable.
        self.relative += other.relative;
        self
    }

    /// The same relative error of all observables.
    pub(crate) fn of_share(found: &Observables, relative: f64, asked: f64) -> Self {
        let all = Observable::all(found.interfaces());
        let error = |observable| scale(found, observable).map_or(0.0, |scale| relative * scale);
        Self { asked, relative, worst: None, errors: all.into_iter().map(error).collect() }
    }

    /// No estimate: the accuracy counts as not reached.
    pub(crate) fn unknown(found: &Observables, asked: f64) -> Self {
        let errors = vec![f64::NAN; found.values.len()].into();
        Self { asked, relative: f64::INFINITY, worst: None, errors }
    }

    /// True if every error is as small as was asked for.
    pub fn is_reached(&self) -> bool {
        self.relative <= self.asked
    }

    /// The estimate with the observables by name.
    pub(crate) fn summary(&self, interfaces: &[&str]) -> AccuracySummary {
        let all = Observable::all(interfaces.len());
        let named = all.iter().zip(&self.errors).filter(|(_, error)| error.is_finite());
        AccuracySummary {
            asked: self.asked,
            estimated_error: self.relative,
            reached: self.is_reached(),
            of: self.worst.map(|observable| observable.name(interfaces)),
            errors: named.map(|(one, &error)| (one.name(interfaces), error.into())).collect(),
        }
    }
}

/// The number that the error of an observable is compared with, in its unit; none for observables
/// that are exact, that are settings, or that measure errors themselves.
fn scale(found: &Observables, observable: Observable) -> Option<f64> {
    let Observable { quantity, interface } = observable;
    let of = |quantity| found.get(quantity, interface).map(f64::abs);
    let whole = |quantity| found.get(quantity, None).map(f64::abs);
    match quantity {
        Quantity::FundamentalFrequency => Some(FREQUENCY_SHARE * of(quantity).unwrap_or(1.0)),
        Quantity::FundamentalReceptance | Quantity::StiffnessAverage => of(quantity),
        Quantity::DampingRatio | Quantity::DampingRatioDecrement => {
            Some(of(quantity)?.max(SMALL_DAMPING))
        }
        Quantity::SecondHarmonicFrequency => {
            let ratio = whole(Quantity::HarmonicRatio)?;
            (ratio >= SMALL_HARMONIC).then(|| of(quantity))?
        }
        Quantity::SecondHarmonicReceptance => {
            let first = whole(Quantity::FundamentalReceptance)?;
            Some(of(quantity)?.max(SMALL_HARMONIC * first))
        }
        Quantity::HarmonicRatio => Some(of(quantity)?.max(SMALL_HARMONIC)),
        Quantity::PressureMin | Quantity::PressureMax => {
            let range = of(Quantity::PressureMax)? - of(Quantity::PressureMin)?;
            let departure = found.get(quantity, interface)? - of(Quantity::StaticPressure)?;
            Some(departure.abs().max(SMALL_DEPARTURE * range))
        }
        Quantity::StiffnessAtPressureMin => {
            Some(of(quantity)?.max(SMALL_DEPARTURE * of(Quantity::StaticStiffness)?))
        }
        Quantity::ContactLost => {
            let period = whole(Quantity::NaturalFrequency).map_or(0.0, f64::recip);
            Some(of(quantity)?.max(period))
        }
        Quantity::EnergyInput | Quantity::EnergyDissipated | Quantity::EnergyStored => {
            whole(Quantity::EnergyInput)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::simulate;

    use asperity_scenario::Document;

    /// Against responses of a tenth of the accuracy: with loss of contact and without, the errors
    /// are as small as was asked for.
    #[test]
    fn default_responses_are_as_accurate_as_they_say() {
        for (law, peak) in [("\"modified\"", "9"), ("\"modified\"", "32"), ("\"pl\"", "32")] {
            let at = |accuracy: &str| {
                let scenario = "../../fixtures/scenarios/nouira2020-modified.json";
                let mut document = Document::read(scenario).unwrap();
                let method = format!(r#"{{"kind": "modal", "accuracy": {accuracy}}}"#);
                for (pointer, value) in [
                    ("/method", method.as_str()),
                    ("/excitation/peak_n", peak),
                    ("/interfaces/0/law", law),
                    ("/interfaces/1/law", law),
                ] {
                    document.set(pointer, value).unwrap();
                }
                simulate(&document, &document.scenario().unwrap()).unwrap().observables
            };
            let (default, fine) = (at("1e-3"), at("1e-4"));
            let [estimated, of_fine] = [&default, &fine].map(|found| found.estimate().unwrap());
            assert!(estimated.is_reached() && default.warnings.is_empty(), "{law} {peak}");
            assert!(of_fine.is_reached(), "{law} {peak}");
            let true_errors = ErrorEstimate::new(&default, &fine, 1.0, DEFAULT_ACCURACY);
            assert!(true_errors.is_reached(), "{law} {peak}: {true_errors:?}");
        }
    }
}
