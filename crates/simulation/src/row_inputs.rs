//! The scenario of a row of values.

use std::path::Path;

use asperity_dynamics::History;
use asperity_scenario::{Document, ExcitationSpec, set_value, validate_json};
use asperity_signal::{Complex64, transform_at};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::error::SimulationError;

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

/// True for a place in the scenario's excitation that does not change its kind.
fn is_in_excitation(place: &str) -> bool {
    place.starts_with("/excitation/") && place != "/excitation/kind"
}

fn deserialised<T: DeserializeOwned>(value: Value) -> Result<T, SimulationError> {
    serde_json::from_value(value).map_err(|error| SimulationError::Scenario(error.to_string()))
}

/// Receptance of the first sensor at the frequencies \[Hz\] below half of the sample rate, from a history.
pub(crate) fn receptance_of(history: &History, rate: f64, frequencies: &[f64]) -> Vec<Complex64> {
    let receptance = |frequency: &f64| {
        let [response, force] = [&history.sensors[0].displacement, &history.load]
            .map(|samples| transform_at(samples, rate, *frequency));
        response / force
    };
    let known = |frequency: &&f64| **frequency < 0.5 * rate;
    frequencies.iter().take_while(known).map(receptance).collect()
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
