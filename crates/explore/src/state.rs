//! The scenario of a state: the scenario of the file with the changes of the page.

use std::collections::HashSet;

use asperity_scenario::{
    AnyScenario, DEFAULT_OUTPUT_RATE_HZ, Document, InvalidDocument, scenario_schema,
    structure_schema,
};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A value of the scenario and its new value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Change(pub(crate) String, pub(crate) Value);

/// A value that is not accepted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Fault {
    /// JSON Pointer to the value; empty for the whole scenario.
    pub(crate) pointer: String,
    pub(crate) text: String,
}

/// The scenario of the file.
#[derive(Debug)]
pub(crate) struct Base {
    pub(crate) document: Document,
    /// Texts that a change may hold: words of the schema, and the keys and texts of the scenario.
    words: HashSet<String>,
}

/// A scenario with the changes of a state, checked.
#[derive(Debug)]
pub(crate) struct State {
    pub(crate) document: Document,
    pub(crate) scenario: AnyScenario,
}

impl Base {
    pub(crate) fn new(document: Document) -> Self {
        let mut words = HashSet::new();
        add_texts(document.value(), &mut words);
        add_words(schema_of(&document), &mut words);
        Self { document, words }
    }

    /// The JSON Schema of the scenario.
    pub(crate) fn schema(&self) -> &'static Value {
        schema_of(&self.document)
    }

    /// The document with some changes, not checked as a whole.
    pub(crate) fn changed(&self, changes: &[Change]) -> Result<Document, Fault> {
        let mut document = self.document.clone();
        for Change(pointer, value) in changes {
            let fault = |text: String| Fault { pointer: pointer.clone(), text };
            if let Some(text) = self.unknown_text(value) {
                return Err(fault(format!(
                    "{pointer}: the text {text:?} is neither in the scenario nor in its schema"
                )));
            }
            let set = document.set(pointer, &value.to_string());
            set.map_err(|error| fault(error.to_string()))?;
        }
        Ok(document)
    }

    /// The scenario with some changes.
    pub(crate) fn state(&self, changes: &[Change]) -> Result<State, Vec<Fault>> {
        let document = self.changed(changes).map_err(|fault| vec![fault])?;
        let scenario = document.any_scenario().map_err(|invalid| faults(&invalid))?;
        match too_long(document.value()) {
            Some(fault) => Err(vec![fault]),
            None => Ok(State { document, scenario }),
        }
    }

    /// A text of a value that a change may not hold: it could be the name of a file.
    fn unknown_text<'v>(&self, value: &'v Value) -> Option<&'v str> {
        match value {
            Value::String(text) => (!self.words.contains(text)).then_some(text),
            Value::Array(items) => items.iter().find_map(|item| self.unknown_text(item)),
            Value::Object(object) => object.values().find_map(|item| self.unknown_text(item)),
            _ => None,
        }
    }
}

/// Numbers of a history that the page takes: 80 MB.
const MOST_NUMBERS: f64 = 1e7;

/// Columns of a history, and of each interface in it.
const COLUMNS: (f64, f64) = (4.0, 3.0);

/// The fault of a history that is too long for a page.
fn too_long(document: &Value) -> Option<Fault> {
    let number = |key: &str| document.get(key).and_then(Value::as_f64);
    let duration = number("duration_s")?;
    let rate = number("output_rate_hz").unwrap_or(DEFAULT_OUTPUT_RATE_HZ);
    let interfaces = document.get("interfaces").and_then(Value::as_array).map_or(0, Vec::len);
    let size = duration * rate * (COLUMNS.0 + COLUMNS.1 * interfaces as f64);
    (size > MOST_NUMBERS).then(|| Fault {
        pointer: "/duration_s".to_owned(),
        text: format!(
            "/duration_s: the history would have {size:.1e} numbers, duration times output_rate_hz times \
             columns; the page takes at most {MOST_NUMBERS:.0e}, `asperity simulate` more"
        ),
    })
}

/// The faults of a scenario that is not valid.
pub(crate) fn faults(invalid: &InvalidDocument) -> Vec<Fault> {
    let fault = |found: &asperity_scenario::Diagnostic| Fault {
        pointer: found.pointer.clone(),
        text: found.to_string(),
    };
    invalid.diagnostics.iter().map(fault).collect()
}

fn schema_of(document: &Document) -> &'static Value {
    if document.has_matrices() { structure_schema() } else { scenario_schema() }
}

/// The keys and texts of a value.
fn add_texts(value: &Value, words: &mut HashSet<String>) {
    match value {
        Value::String(text) => {
            words.insert(text.clone());
        }
        Value::Array(items) => items.iter().for_each(|item| add_texts(item, words)),
        Value::Object(object) => {
            words.extend(object.keys().cloned());
            object.values().for_each(|item| add_texts(item, words));
        }
        _ => {}
    }
}

/// The words that a schema lets a value be.
fn add_words(schema: &Value, words: &mut HashSet<String>) {
    match schema {
        Value::Array(items) => items.iter().for_each(|item| add_words(item, words)),
        Value::Object(object) => {
            for (keyword, inner) in object {
                match (keyword.as_str(), inner) {
                    ("const", Value::String(text)) => {
                        words.insert(text.clone());
                    }
                    ("enum", list) => add_texts(list, words),
                    _ => add_words(inner, words),
                }
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn base() -> Base {
        Base::new(Document::read("../simulation/examples/block.json").unwrap())
    }

    #[test]
    fn changes_are_those_of_set() {
        let mut expected = base().document;
        expected.set("/excitation/peak_n", "5").unwrap();
        let changes = [Change("/excitation/peak_n".to_owned(), json!(5))];
        assert_eq!(base().changed(&changes).unwrap().value(), expected.value());
    }

    /// A page may not have other files read.
    #[test]
    fn a_change_cannot_name_a_file() {
        let file = json!({"kind": "samples", "file": "/etc/passwd"});
        for (pointer, value) in [
            ("/excitation", file.clone()),
            ("/excitation/file", json!("/etc/passwd")),
            ("/bodies/-", json!([{"deep": [file]}])),
        ] {
            let found = base().changed(&[Change(pointer.to_owned(), value)]).unwrap_err();
            assert!(found.text.contains("/etc/passwd"), "{found:?}");
        }
        let kind = json!({"kind": "half_sine", "peak_n": 3, "duration_s": 1e-3});
        assert!(base().state(&[Change("/excitation".to_owned(), kind)]).is_ok());
    }

    #[test]
    fn a_history_that_is_too_long_for_a_page_is_refused() {
        let changes = |seconds: f64| [Change("/duration_s".to_owned(), json!(seconds))];
        assert!(base().state(&changes(7.0)).is_ok());
        let found = base().state(&changes(8.0)).unwrap_err();
        assert!(found[0].text.contains("1e7"), "{found:?}");
    }

    #[test]
    fn faults_have_their_places() {
        let changes = [Change("/duration_s".to_owned(), json!(-1))];
        let found = base().state(&changes).unwrap_err();
        assert_eq!(found[0].pointer, "/duration_s");
    }
}
