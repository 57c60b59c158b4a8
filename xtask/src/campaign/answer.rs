//! Answers of an engine as `summary.json` states them, and their distance in tolerances.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use anyhow::Result;
use asperity_scenario::{Document, MethodSpec, Scenario};
use asperity_simulation::run::simulate;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Harmonic ratio A2/A1 below which its error counts relative to this.
pub(super) const RATIO_FLOOR: f64 = 1e-3;

/// Damping ratio below which its error counts relative to this.
pub(super) const DAMPING_FLOOR: f64 = 5e-3;

/// Departure of a pressure extreme from rest below which its error counts relative to this part
/// of the other extreme's departure.
pub(super) const DEPARTURE_FLOOR: f64 = 0.1;

/// Kind of an observable, with its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Kind {
    /// Frequency f1 of the fundamental.
    Frequency,
    /// Receptance A1 at the fundamental.
    Receptance,
    /// Damping ratio, by half power and by the decrement.
    Damping,
    /// Harmonic ratio A2/A1.
    Ratio,
    /// Extreme of a contact pressure.
    Pressure,
    /// Average stiffness of a contact.
    Stiffness,
}

impl Kind {
    /// All kinds.
    pub(super) const ALL: [Self; 6] = [
        Self::Frequency,
        Self::Receptance,
        Self::Damping,
        Self::Ratio,
        Self::Pressure,
        Self::Stiffness,
    ];

    /// Largest error, relative to the scale of the observable, that counts as right.
    pub(super) fn tolerance(self) -> f64 {
        match self {
            Self::Frequency => 5e-4,
            Self::Receptance | Self::Pressure => 1e-2,
            Self::Damping | Self::Ratio => 2e-2,
            Self::Stiffness => 5e-3,
        }
    }

    /// Description in words, with the scale.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Frequency => "frequency f1, relative",
            Self::Receptance => "receptance A1, relative",
            Self::Damping => "damping ratios, relative to them or to 0.005",
            Self::Ratio => "harmonic ratio A2/A1, relative to it or to 0.001",
            Self::Pressure => {
                "lowest and highest pressure, relative to the departure from rest, or to 10 % of \
                 the other departure"
            }
            Self::Stiffness => "average stiffness, relative",
        }
    }
}

/// One observable of an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Observable {
    /// Dotted name, as in `sweep.csv`.
    pub(super) name: String,
    /// Kind.
    pub(super) kind: Kind,
    /// Value; none where the response does not have it.
    pub(super) value: Option<f64>,
    /// Magnitude that errors are relative to.
    pub(super) scale: f64,
}

impl Observable {
    pub(super) fn new(name: impl Into<String>, kind: Kind, value: Option<f64>) -> Self {
        let magnitude = value.map_or(0.0, f64::abs);
        let least = match kind {
            Kind::Ratio => RATIO_FLOOR,
            Kind::Damping => DAMPING_FLOOR,
            _ => 0.0,
        };
        let scale = magnitude.max(least);
        Self { name: name.into(), kind, value, scale }
    }

    /// Distance of `value` from this observable in tolerances; infinite where one has it alone.
    pub(super) fn distance(&self, value: Option<f64>) -> f64 {
        let difference = match (value, self.value) {
            (Some(value), Some(own)) => (value - own).abs(),
            (None, None) => 0.0,
            // A harmonic below the floor may have no peak.
            (Some(one), None) | (None, Some(one))
                if self.kind == Kind::Ratio && one.abs() < RATIO_FLOOR =>
            {
                0.0
            }
            _ => f64::INFINITY,
        };
        let factor = difference / (self.kind.tolerance() * self.scale);
        if difference == 0.0 {
            0.0
        } else if factor.is_nan() {
            f64::INFINITY
        } else {
            factor
        }
    }
}

/// Answer of an engine.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Answer {
    pub(super) observables: Vec<Observable>,
    /// Estimated errors by the name of their observable.
    pub(super) stated: BTreeMap<String, f64>,
    /// Statements of the answer that its numbers may be wrong.
    pub(super) reservations: Vec<String>,
    /// True if the answer says that its record ends early, and widens the half-power damping ratio.
    pub(super) is_undecayed: bool,
    /// Integration step \[s\].
    pub(super) step_s: f64,
    /// Most modes of a body; zero of finite differences.
    pub(super) modes_per_body: usize,
    /// Residual of the energy balance, over the input.
    pub(super) residual: f64,
    /// True if a contact opens for a time.
    pub(super) contact_lost: bool,
}

impl Answer {
    /// The answer that a summary states.
    fn of(summary: &Value) -> Self {
        let number = |pointer: &str| summary.pointer(pointer).and_then(Value::as_f64);
        let mut observables = vec![
            Observable::new(
                "fundamental.frequency_hz",
                Kind::Frequency,
                number("/fundamental/frequency_hz"),
            ),
            Observable::new(
                "fundamental.receptance_m_per_n",
                Kind::Receptance,
                number("/fundamental/receptance_m_per_n")
                    .or_else(|| number("/fundamental/receptance_s2")),
            ),
            Observable::new("harmonic_ratio", Kind::Ratio, number("/harmonic_ratio")),
        ];
        let interfaces = summary["interfaces"].as_array().map(Vec::as_slice).unwrap_or_default();
        for (at, interface) in interfaces.iter().enumerate() {
            let name = interface["name"].as_str().unwrap_or_default();
            let of_contact = |key: &str| number(&format!("/interfaces/{at}/{key}"));
            let at_rest = number(&format!("/static/interfaces/{at}/pressure_pa")).unwrap_or(0.0);
            let keys = ["pressure_min_pa", "pressure_max_pa"];
            let departures =
                keys.map(|key| of_contact(key).map_or(0.0, |value| (value - at_rest).abs()));
            let larger = departures[0].max(departures[1]);
            for (key, departure) in keys.into_iter().zip(departures) {
                observables.push(Observable {
                    name: format!("interfaces.{name}.{key}"),
                    kind: Kind::Pressure,
                    value: of_contact(key),
                    scale: departure.max(DEPARTURE_FLOOR * larger).max(1e-9 * at_rest),
                });
            }
            let key = "stiffness_average_pa_per_m";
            let name = format!("interfaces.{name}.{key}");
            observables.push(Observable::new(name, Kind::Stiffness, of_contact(key)));
        }
        for key in ["damping_ratio", "damping_ratio_decrement"] {
            let value = number(&format!("/fundamental/{key}"));
            observables.push(Observable::new(format!("fundamental.{key}"), Kind::Damping, value));
        }
        let errors = summary["accuracy"]["errors"].as_object().into_iter().flatten();
        Self {
            observables,
            stated: errors
                .filter_map(|(name, error)| Some((name.clone(), error.as_f64()?)))
                .collect(),
            reservations: reservations(summary),
            is_undecayed: kinds(summary).any(|kind| kind == NOT_DECAYED),
            step_s: number("/numerics/step_s").unwrap_or(f64::NAN),
            modes_per_body: most_modes(summary),
            residual: number("/energy/residual_relative").unwrap_or(f64::NAN),
            contact_lost: interfaces.iter().any(|one| one["contact_lost_s"].as_f64() > Some(0.0)),
        }
    }

    /// True if it says of the observables of these names that they may be wrong.
    pub(super) fn is_reserved_about<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> bool {
        let is_widened = |name| self.is_undecayed && name == HALF_POWER;
        !self.reservations.is_empty() || names.into_iter().all(is_widened)
    }

    /// Value of the observable of this name.
    pub(super) fn value(&self, name: &str) -> Option<f64> {
        self.observables.iter().find(|one| one.name == name)?.value
    }

    /// Largest distance from another answer, in the tolerances of that one.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        let pairs = self.observables.iter().zip(&other.observables);
        pairs.map(|(one, other)| other.distance(one.value)).fold(0.0, f64::max)
    }
}

/// The most modes of a body that a summary states; zero without any.
fn most_modes(summary: &Value) -> usize {
    let counts = summary["numerics"]["modes_per_body"].as_array().map(Vec::as_slice);
    let counts = counts.unwrap_or_default().iter().filter_map(Value::as_u64);
    counts.max().map_or(0, |most| usize::try_from(most).unwrap_or(usize::MAX))
}

/// Observable that a record that ends early widens, and the warning about it.
const HALF_POWER: &str = "fundamental.damping_ratio";
const NOT_DECAYED: &str = "not_decayed";

/// Kinds of the warnings of a summary.
fn kinds(summary: &Value) -> impl Iterator<Item = &str> {
    let warnings = summary["warnings"].as_array().map(Vec::as_slice).unwrap_or_default();
    warnings.iter().filter_map(|warning| warning["kind"].as_str())
}

/// Statements of a summary that its numbers may be wrong. Pressures beyond the measured range are
/// a reservation about the law, not about the numbers, and a record that ends early about [one](HALF_POWER) of them.
fn reservations(summary: &Value) -> Vec<String> {
    let is_about_all = |kind: &&str| !["outside_measured_range", NOT_DECAYED].contains(kind);
    let mut found: Vec<String> = kinds(summary).filter(is_about_all).map(str::to_owned).collect();
    if summary["sensitive"] == true {
        found.push("sensitive".to_owned());
    }
    if summary["accuracy"]["reached"] == false {
        found.push("accuracy not reached".to_owned());
    }
    found
}

/// Outcome of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Outcome {
    /// An answer.
    Answered(Answer),
    /// An error, in its words.
    Refused(String),
    /// A panic.
    Panicked(String),
}

impl Outcome {
    /// The answer, if there is one.
    pub(super) fn answer(&self) -> Option<&Answer> {
        match self {
            Self::Answered(answer) => Some(answer),
            Self::Refused(_) | Self::Panicked(_) => None,
        }
    }
}

impl Outcome {
    /// True if it states nothing without a reservation.
    pub(super) fn is_reserved(&self) -> bool {
        match self {
            Self::Answered(answer) => !answer.reservations.is_empty(),
            Self::Refused(_) => true,
            Self::Panicked(_) => false,
        }
    }
}

/// The outcome of `scenario` of `document` with `method`.
pub(super) fn run(document: &Document, scenario: &Scenario, method: MethodSpec) -> Outcome {
    let scenario = Scenario { method, ..scenario.clone() };
    let attempt = || -> Result<Value> {
        let run = simulate(document, &scenario)?;
        Ok(serde_json::to_value(&run.summary)?)
    };
    match catch_unwind(AssertUnwindSafe(attempt)) {
        Ok(Ok(summary)) => Outcome::Answered(Answer::of(&summary)),
        Ok(Err(error)) => Outcome::Refused(format!("{error:#}")),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Outcome::Panicked(text.unwrap_or("no message").to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn summary() -> Value {
        json!({
            "static": {"interfaces": [{"name": "foot", "pressure_pa": 100.0}]},
            "fundamental": {"frequency_hz": 50.0, "receptance_m_per_n": 1e-6},
            "harmonic_ratio": null,
            "interfaces": [{"name": "foot", "pressure_min_pa": 90.0, "pressure_max_pa": 100.02,
                            "stiffness_average_pa_per_m": 1e9}],
            "energy": {"residual_relative": 1e-6},
            "warnings": [{"kind": "outside_measured_range"}, {"kind": "energy_balance"}],
            "numerics": {"step_s": 1e-5, "modes_per_body": [3, 7]},
        })
    }

    #[test]
    fn distances_are_in_tolerances_of_each_scale() {
        let truth = Answer::of(&summary());
        let distance = |pointer: &str, value: f64| {
            let mut changed = summary();
            *changed.pointer_mut(pointer).unwrap() = json!(value);
            Answer::of(&changed).distance(&truth)
        };
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-6, "{found}");
        assert_eq!(truth.distance(&truth), 0.0);
        close(distance("/fundamental/frequency_hz", 50.05), 2.0);
        close(distance("/fundamental/receptance_m_per_n", 1.01e-6), 1.0);
        close(distance("/interfaces/0/pressure_min_pa", 90.2), 2.0);
        // The departure of 0.02 Pa counts as 10 % of that of 10 Pa.
        close(distance("/interfaces/0/pressure_max_pa", 100.04), 2.0);
        close(distance("/interfaces/0/stiffness_average_pa_per_m", 1.01e9), 2.0);
        close(distance("/harmonic_ratio", 0.5 * RATIO_FLOOR), 0.0);
        assert_eq!(distance("/harmonic_ratio", 2.0 * RATIO_FLOOR), f64::INFINITY);
    }

    #[test]
    fn modes_are_those_of_the_body_with_most() {
        assert_eq!(Answer::of(&summary()).modes_per_body, 7);
        let mut cells = summary();
        cells["numerics"] = json!({"step_s": 1e-7});
        assert_eq!(Answer::of(&cells).modes_per_body, 0);
    }

    #[test]
    fn reservations_are_those_about_the_numbers() {
        let mut summary = summary();
        assert_eq!(reservations(&summary), ["energy_balance"]);
        summary["sensitive"] = json!(true);
        summary["accuracy"] = json!({"reached": false});
        summary["warnings"] = json!([]);
        assert_eq!(reservations(&summary), ["sensitive", "accuracy not reached"]);
    }

    /// A record that ends early is a reservation about the half-power damping ratio, and about nothing else.
    #[test]
    fn an_undecayed_record_is_a_reservation_about_its_width() {
        let mut summary = summary();
        summary["warnings"] = json!([{"kind": "not_decayed", "remaining": 0.3}]);
        let answer = Answer::of(&summary);
        assert!(answer.reservations.is_empty());
        assert!(answer.is_reserved_about([HALF_POWER]));
        assert!(!answer.is_reserved_about([HALF_POWER, "harmonic_ratio"]));
        summary["warnings"] = json!([]);
        assert!(!Answer::of(&summary).is_reserved_about([HALF_POWER]));
    }
}
