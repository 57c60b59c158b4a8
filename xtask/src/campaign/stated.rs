//! The errors that modal answers state, against a run to a tenth of them.

use asperity_scenario::{Document, MethodSpec, ModalSpec, Scenario};
use serde::Serialize;

use super::answer::{Answer, run};

/// Accuracy of the run that is compared with, a tenth of that by default.
const FINE: f64 = 1e-4;

/// Part of an observable's scale up to which errors are rounding.
const ROUNDING: f64 = 1e-9;

/// The largest error of an answer over its stated ones.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct StatedErrors {
    /// Difference from the finer run over the sum of both stated errors.
    pub(super) ratio: f64,
    /// Name of the observable with this ratio.
    pub(super) observable: String,
    /// The difference over the observable's scale.
    pub(super) relative: f64,
}

impl StatedErrors {
    /// The errors of a default `answer` of modes, by a finer run; none where either has a reservation, or no
    /// observable in common with the other.
    pub(super) fn of(answer: &Answer, document: &Document, scenario: &Scenario) -> Option<Self> {
        if !answer.reservations.is_empty() {
            return None;
        }
        let fine = ModalSpec { accuracy: Some(FINE), ..ModalSpec::default() };
        let outcome = run(document, scenario, MethodSpec::Modal(fine));
        let finer = outcome.answer().filter(|_| !outcome.is_reserved())?;
        Self::between(answer, finer)
    }

    fn between(answer: &Answer, finer: &Answer) -> Option<Self> {
        let of_each = answer.observables.iter().filter_map(|observable| {
            let name = &observable.name;
            let difference = (observable.value? - finer.value(name)?).abs();
            let stated = answer.stated.get(name)? + finer.stated.get(name)?;
            let counted = (difference - ROUNDING * observable.scale).max(0.0);
            let ratio = if counted == 0.0 { 0.0 } else { counted / stated };
            let relative = difference / observable.scale;
            Some(Self { ratio, observable: name.clone(), relative })
        });
        of_each.max_by(|one, other| one.ratio.total_cmp(&other.ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::answer::{Kind, Observable};

    fn answer(values: [f64; 2], stated: [f64; 2]) -> Answer {
        let names = ["f", "p"];
        Answer {
            observables: vec![
                Observable::new(names[0], Kind::Frequency, Some(values[0])),
                Observable::new(names[1], Kind::Pressure, Some(values[1])),
            ],
            stated: names.map(str::to_owned).into_iter().zip(stated).collect(),
            reservations: Vec::new(),
            is_undecayed: false,
            step_s: 1e-5,
            modes_per_body: 3,
            residual: 1e-6,
            contact_lost: false,
        }
    }

    #[test]
    fn the_largest_error_over_the_stated_ones_is_found() {
        let finer = answer([100.0, 500.0], [0.001, 0.1]);
        let found = StatedErrors::between(&answer([100.01, 501.0], [0.019, 0.3]), &finer).unwrap();
        assert_eq!(found.observable, "p");
        assert!((found.ratio - 2.5).abs() < 1e-5, "{found:?}");
        assert!((found.relative - 1.0 / 501.0).abs() < 1e-12, "{found:?}");
        let rounded = answer([100.0 + 1e-8, 500.0], [0.0, 0.0]);
        let none = answer([100.0, 500.0], [0.0, 0.0]);
        assert_eq!(StatedErrors::between(&rounded, &none).unwrap().ratio, 0.0);
    }
}
