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
//! with the error scale of the observable
//! ([`quantity`](crate::quantity)), its own value for most.

use serde::Serialize;

use crate::quantity::{Observable, Values};

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
    pub(crate) fn new(found: Values<'_>, other: Values<'_>, divisor: f64, asked: f64) -> Self {
        let all = Observable::all(found.interfaces);
        let mut estimate =
            Self { asked, relative: 0.0, worst: None, errors: vec![f64::NAN; all.len()].into() };
        for (place, &observable) in all.iter().enumerate() {
            let Some(scale) = found.error_scale(observable) else { continue };
            let [a, b] = [found, other].map(|one| one.all[place]);
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
    pub(crate) fn transferred(&self, from: Values<'_>, to: Values<'_>) -> Self {
        let mut errors = self.errors.clone();
        for (error, observable) in errors.iter_mut().zip(Observable::all(to.interfaces)) {
            let ratio = match (from.error_scale(observable), to.error_scale(observable)) {
                (Some(from), Some(to)) if from > 0.0 => to / from,
                _ => f64::NAN,
            };
            *error *= ratio;
        }
        Self { errors, ..self.clone() }
    }

    /// So many times the errors.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let errors = self.errors.iter().map(|error| factor * error).collect();
        Self { errors, relative: factor * self.relative, ..self.clone() }
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
    pub(crate) fn of_share(found: Values<'_>, relative: f64, asked: f64) -> Self {
        let all = Observable::all(found.interfaces);
        let error = |one| found.error_scale(one).map_or(0.0, |scale| relative * scale);
        Self { asked, relative, worst: None, errors: all.into_iter().map(error).collect() }
    }

    /// No estimate: the accuracy counts as not reached.
    pub(crate) fn unknown(found: Values<'_>, asked: f64) -> Self {
        let errors = vec![f64::NAN; found.all.len()].into();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assemble::DEFAULT_ACCURACY;
    use crate::observables::Observables;
    use crate::quantity::Quantity;
    use crate::row_simulator::RowSimulator;
    use crate::run::simulate;

    use asperity_scenario::Document;
    use serde_json::{Value, json};

    const SCENARIO: &str = "../../fixtures/scenarios/nouira2020-modified.json";

    /// Places that a study varies together, bounds, the law, the force \[N\], and if contact is lost.
    type Varied = (&'static [&'static str], [f64; 2], &'static str, &'static str, bool);

    const STUDIES: [Varied; 6] = [
        (&["/damping/ratio"], [0.02, 0.05], "pl", "9", false),
        (&["/bodies/0/length_m"], [0.2, 0.26], "modified", "15", false),
        (&["/laws/pl/coefficient"], [1.5e10, 2.1e10], "pl", "9", false),
        (&["/bodies/0/length_m"], [0.2, 0.26], "pl", "32", true),
        (&["/interfaces/0/area_m2", "/interfaces/1/area_m2"], [1e-4, 1.4e-4], "pl", "40", true),
        (&["/excitation/peak_n"], [30.0, 45.0], "pl", "32", true),
    ];

    fn document(law: &str, peak: &str, accuracy: f64) -> Document {
        let mut document = Document::read(SCENARIO).unwrap();
        let method = json!({"kind": "modal", "accuracy": accuracy}).to_string();
        let law = format!("\"{law}\"");
        for (pointer, value) in [
            ("/method", method.as_str()),
            ("/excitation/peak_n", peak),
            ("/interfaces/0/law", &law),
            ("/interfaces/1/law", &law),
        ] {
            document.set(pointer, value).unwrap();
        }
        document
    }

    /// Rows take errors from structures near their own. Against responses of a tenth of the accuracy, refined by
    /// themselves, they are as accurate as they say; and each is the same alone, bit for bit.
    #[test]
    fn rows_of_a_study_are_as_accurate_as_they_say() {
        let bits = |found: &Observables| -> Vec<u64> {
            found.values.iter().map(|value| value.to_bits()).collect()
        };
        for (places, [low, high], law, peak, opens) in STUDIES {
            let places: Vec<String> = places.iter().map(|&place| place.to_owned()).collect();
            let simulator = || {
                let document = document(law, peak, 1e-3);
                RowSimulator::new(document, vec![places.clone()]).unwrap().with_near_structures()
            };
            let value = |row: u32| low + (high - low) * (f64::from(row) + 0.37) / 24.0;
            let rows: Vec<Vec<Value>> = (0..24).map(|row| vec![json!(value(row))]).collect();
            let found = simulator().run(&rows);
            for (n, (row, found)) in rows.iter().zip(&found).enumerate().step_by(5) {
                let found = found.as_ref().unwrap();
                let case = format!("{places:?} {law} {peak} N: {row:?}");
                assert!(found.estimate().unwrap().is_reached(), "{case}");
                let lost = found.get(Quantity::ContactLost, Some(0)).unwrap();
                assert_eq!(lost > 0.0, opens, "{case}");
                let mut fine = document(law, peak, 1e-4);
                for place in &places {
                    fine.set(place, &row[0].to_string()).unwrap();
                }
                let fine = simulate(&fine, &fine.scenario().unwrap()).unwrap().observables;
                let off = ErrorEstimate::new(found.all(), fine.all(), 1.0, DEFAULT_ACCURACY);
                assert!(off.is_reached(), "{case}: {} of {:?}", off.relative, off.worst);
                if n % 10 == 0 {
                    let alone = simulator().run(&rows[n..=n]);
                    assert_eq!(bits(found), bits(alone[0].as_ref().unwrap()), "{case}");
                }
            }
        }
    }

    /// Against responses of a tenth of the accuracy: with loss of contact and without, the errors
    /// are as small as was asked for.
    #[test]
    fn default_responses_are_as_accurate_as_they_say() {
        for (law, peak) in [("modified", "9"), ("modified", "32"), ("pl", "32")] {
            let at = |accuracy: f64| {
                let document = document(law, peak, accuracy);
                simulate(&document, &document.scenario().unwrap()).unwrap().observables
            };
            let (default, fine) = (at(1e-3), at(1e-4));
            let [estimated, of_fine] = [&default, &fine].map(|found| found.estimate().unwrap());
            assert!(estimated.is_reached() && default.warnings.is_empty(), "{law} {peak}");
            assert!(of_fine.is_reached(), "{law} {peak}");
            let true_errors = ErrorEstimate::new(default.all(), fine.all(), 1.0, DEFAULT_ACCURACY);
            assert!(true_errors.is_reached(), "{law} {peak}: {true_errors:?}");
        }
    }
}
