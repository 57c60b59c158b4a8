//! The scenario of a row of values.

use std::path::Path;

use asperity_dynamics::History;
use asperity_scenario::{Document, ExcitationSpec, set_value, validate_json};
use asperity_signal::{Complex64, transform_at};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::error::SimulationError;
use crate::response_parts::to_end;

/// One input of a row: the places of the scenario that take its value.
pub type Places = Vec<String>;

/// A scenario and the places that take the values of a row.
#[derive(Debug)]
pub(crate) struct RowInputs {
    document: Document,
    places: Vec<Places>,
    /// True if each row is checked as a whole scenario before it is run.
    checks_rows: bool,
}

impl RowInputs {
    pub(crate) fn new(document: Document, places: Vec<Places>, checks_rows: bool) -> Self {
        Self { document, places, checks_rows }
    }

    pub(crate) fn document(&self) -> &Document {
        &self.document
    }

    pub(crate) fn folder(&self) -> &Path {
        self.document.folder()
    }

    /// Checks a row, if rows are to be checked.
    pub(crate) fn check<T: AsRef<str>>(&self, row: &[T]) -> Result<(), SimulationError> {
        if !self.checks_rows {
            return Ok(());
        }
        let faults = validate_json(&self.value(row)?, self.folder());
        if faults.is_empty() {
            return Ok(());
        }
        let words: Vec<String> = faults.iter().map(ToString::to_string).collect();
        Err(SimulationError::Scenario(words.join("; ")))
    }

    /// The scenario of a row.
    pub(crate) fn scenario<T: AsRef<str>, S: DeserializeOwned>(
        &self,
        row: &[T],
    ) -> Result<S, SimulationError> {
        deserialised(self.value(row)?)
    }

    fn value<T: AsRef<str>>(&self, row: &[T]) -> Result<Value, SimulationError> {
        let mut value = self.document.value().clone();
        for (places, text) in self.places.iter().zip(row) {
            for place in places {
                set_value(&mut value, place, text.as_ref())?;
            }
        }
        Ok(value)
    }

    /// The excitation of a row.
    pub(crate) fn excitation<T: AsRef<str>>(
        &self,
        row: &[T],
    ) -> Result<ExcitationSpec, SimulationError> {
        let mut part = match self.document.value().get("excitation") {
            Some(excitation) => json!({ "excitation": excitation }),
            None => json!({}),
        };
        for (places, text) in self.places.iter().zip(row) {
            for place in places.iter().filter(|place| is_in_excitation(place)) {
                set_value(&mut part, place, text.as_ref())?;
            }
        }
        deserialised(part.get_mut("excitation").map(Value::take).unwrap_or_default())
    }

    /// The values of a row, rounded where they are numbers of the structure, but for whole numbers and texts: other rows
    /// share that structure.
    pub(crate) fn rounded<T: AsRef<str>>(&self, row: &[T]) -> Vec<String> {
        let is_rounded = |place: &String| ROUNDED.iter().any(|start| place.starts_with(start));
        let near = |(places, text): (&Places, &T)| {
            let text = text.as_ref();
            let number = serde_json::from_str::<serde_json::Number>(text).ok();
            match number.filter(serde_json::Number::is_f64).and_then(|number| number.as_f64()) {
                Some(number) if places.iter().all(is_rounded) => rounded(number).to_string(),
                _ => text.to_owned(),
            }
        };
        self.places.iter().zip(row).map(near).collect()
    }

    /// The values of a row that change more than the excitation, but for its kind and for what else `changes`
    /// the structure.
    pub(crate) fn of_structure<T: AsRef<str>>(
        &self,
        row: &[T],
        changes: impl Fn(&str) -> bool,
    ) -> Vec<String> {
        let of_excitation = |place: &String| is_in_excitation(place) && !changes(place);
        let inputs = self.places.iter().zip(row);
        let others = inputs.filter(|(places, _)| !places.iter().all(of_excitation));
        others.map(|(_, text)| text.as_ref().to_owned()).collect()
    }
}

/// Places whose numbers are rounded for the near structure of a row.
const ROUNDED: [&str; 6] =
    ["/bodies/", "/interfaces/", "/laws/", "/damping/", "/support/", "/gravity_m_per_s2"];

/// Binary digits that a rounded number keeps behind its first.
const DIGITS: u32 = 4;

/// A number rounded to five binary digits: by 3 % at most.
pub(crate) fn rounded(number: f64) -> f64 {
    let dropped = f64::MANTISSA_DIGITS - 1 - DIGITS;
    let half = 1_u64 << (dropped - 1);
    // A carry out of the mantissa raises the exponent, as it should.
    let bits = number.to_bits().saturating_add(half) >> dropped << dropped;
    let near = f64::from_bits(bits);
    if near.is_finite() { near } else { number }
}

/// True for a place in the scenario's excitation that does not change its kind.
fn is_in_excitation(place: &str) -> bool {
    place.starts_with("/excitation/") && place != "/excitation/kind"
}

fn deserialised<T: DeserializeOwned>(value: Value) -> Result<T, SimulationError> {
    serde_json::from_value(value).map_err(|error| SimulationError::Scenario(error.to_string()))
}

/// Receptance of the first sensor at `frequencies` \[Hz\], from a history [to its end](to_end); NaN from half of the
/// sample rate on.
pub(crate) fn receptance_of(history: &History, rate: f64, frequencies: &[f64]) -> Vec<Complex64> {
    let samples = [&history.sensors[0].displacement, &history.load].map(|samples| to_end(samples));
    let receptance = |&frequency: &f64| {
        if frequency >= 0.5 * rate {
            return Complex64::new(f64::NAN, f64::NAN);
        }
        let [response, force] = samples.each_ref().map(|all| transform_at(all, rate, frequency));
        response / force
    };
    frequencies.iter().map(receptance).collect()
}

/// Magnitudes of a receptance at `frequencies`; NaN where it is not known.
pub(crate) fn magnitudes(
    frequencies: &[f64],
    receptance: impl FnOnce() -> Option<Vec<Complex64>>,
) -> Box<[f64]> {
    if frequencies.is_empty() {
        return Box::default();
    }
    let found = receptance().unwrap_or_default();
    let known = found.iter().map(|value| value.norm());
    known.chain(std::iter::repeat(f64::NAN)).take(frequencies.len()).collect()
}

#[cfg(test)]
mod tests {
    use asperity_dynamics::SensorHistory;

    use super::*;

    #[test]
    fn rounded_numbers_are_within_three_percent_and_shared() {
        for number in [0.0, 1.0, 0.035, -2.7e11, 1.15e-4, f64::MAX] {
            let near = rounded(number);
            assert!((near - number).abs() <= number.abs() / 32.0, "{near} for {number}");
            assert_eq!(rounded(near), near);
        }
        assert_eq!(rounded(0.0310), rounded(0.0315));
        assert_eq!(rounded(0.999), 1.0);
    }

    /// Numbers of the structure are rounded; whole numbers, laws by name, and settings stay.
    #[test]
    fn values_of_the_structure_are_rounded() {
        let places = ["/damping/ratio", "/interfaces/0/law", "/method/step_s", "/bodies/0/mass_kg"];
        let places = places.map(|place| vec![place.to_owned()]).to_vec();
        let document = Document::read("examples/block.json").unwrap();
        let inputs = RowInputs::new(document, places, false);
        let row = ["0.0312", "\"pl\"", "1.3e-5", "2"];
        assert_eq!(inputs.rounded(&row), ["0.03125", "\"pl\"", "1.3e-5", "2"]);
    }

    /// A response that ends while it rings, `exp(-a t) sin(w t)` up to `T`, after a smooth pulse: the transform of
    /// a record ends at `T` at any rate, to second order.
    #[test]
    fn receptances_of_a_history_reach_to_its_end() {
        let (pulse, duration, frequency) = (2e-3, 0.0163, 730.0);
        let rate_of_change = Complex64::new(-60.0, std::f64::consts::TAU * 800.0);
        let turn = std::f64::consts::TAU * frequency;
        // Of exp(z t) and of sin^4(pi t / pulse), in closed form.
        let integral = |z: Complex64, end: f64| ((z * end).exp() - 1.0) / z;
        let i = Complex64::i();
        let response =
            [rate_of_change, rate_of_change.conj()].map(|z| integral(z - i * turn, duration));
        let response = (response[0] - response[1]) / (2.0 * i);
        let harmonic = |k: i32, share: f64| {
            let z = i * (std::f64::consts::TAU * f64::from(k) / pulse - turn);
            share * integral(z, pulse)
        };
        let force: Complex64 = [(-2, 0.0625), (-1, -0.25), (0, 0.375), (1, -0.25), (2, 0.0625)]
            .map(|(k, share)| harmonic(k, share))
            .iter()
            .sum();
        let error = |samples: u32| {
            let rate = f64::from(samples) / duration;
            let time: Vec<f64> = (0..samples).map(|n| f64::from(n) / rate).collect();
            let displacement =
                time.iter().map(|&t| (-60.0 * t).exp() * (rate_of_change.im * t).sin()).collect();
            let sine = |t: f64| (std::f64::consts::PI * t / pulse).sin();
            let load =
                time.iter().map(|&t| if t < pulse { sine(t).powi(4) } else { 0.0 }).collect();
            let sensors = vec![SensorHistory { displacement, ..SensorHistory::default() }];
            let history = History { time, load, sensors, interfaces: Vec::new() };
            let found = receptance_of(&history, rate, &[frequency])[0];
            (found * force / response - 1.0).norm()
        };
        let errors = [1000, 2000, 4000].map(error);
        let slopes = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
        assert!(slopes.iter().all(|slope| (slope - 2.0).abs() < 0.1), "{slopes:?} {errors:?}");
        assert!(errors[0] < 1e-3, "{errors:?}");
    }
}
