//! Conditions between values of a scenario, which its schema cannot state.
//!
//! They are checked on the JSON value. Values that the schema rejects are skipped, so one pass
//! reports the faults of both.

mod damping;
mod extent;
mod laws;
mod loads;
mod names;

use std::path::Path;

use serde_json::Value;

use crate::diagnostic::Diagnostic;
use crate::fault::Fault;
use crate::pointer::JsonPointer;
use crate::scenario::{Scenario, scenario_schema};
use crate::schema_check::check_schema;
use crate::wording::count;

/// Deepest nesting of laws in series.
pub const MAX_SERIES_DEPTH: usize = 8;

/// Most laws in series, those of nested series included.
pub const MAX_SERIES_LAWS: usize = 100;

/// Fewest output samples of a run.
pub const MIN_SAMPLES: f64 = 16.0;

/// Most numbers of the time history of a run, samples times columns: 0.8 GB, and some three times
/// as much as text.
pub const MAX_HISTORY_NUMBERS: f64 = 1e8;

/// Most finite-difference cells of one body.
pub const MAX_CELLS: f64 = 1e6;

/// Most time steps of a run by finite differences.
pub const MAX_STEPS: f64 = 2e10;

/// Checks a scenario built or changed in code, and returns all its faults.
///
/// Relative file names start from `folder`. The checks are those of
/// [`Document::scenario`](crate::Document::scenario).
pub fn validate(scenario: &Scenario, folder: &Path) -> Vec<Diagnostic> {
    // All keys are strings, so a scenario always has a JSON form; numbers that are not finite
    // become null, which the schema rejects.
    validate_json(&serde_json::to_value(scenario).unwrap_or_default(), folder)
}

/// Checks the JSON value of a scenario, as [`validate`] does.
pub fn validate_json(scenario: &Value, folder: &Path) -> Vec<Diagnostic> {
    let found = check_schema(scenario_schema(), scenario);
    if found.is_empty() { check(scenario, folder) } else { found }
}

/// Faults that the schema cannot state.
pub(crate) fn check(scenario: &Value, folder: &Path) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let root = Node { value: scenario, at: JsonPointer::root() };
    interface_count(&root, &mut found);
    names::check(&root, &mut found);
    laws::check(&root, &mut found);
    damping::check(&root, &mut found);
    extent::check(&root, &mut found);
    loads::check(&root, folder, &mut found);
    found
}

/// Value and its place.
#[derive(Clone)]
struct Node<'a> {
    value: &'a Value,
    at: JsonPointer,
}

impl<'a> Node<'a> {
    fn get(&self, key: &str) -> Option<Node<'a>> {
        let value = self.value.as_object()?.get(key)?;
        let at = self.at.child(key);
        Some(Node { value, at })
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.value.get(key)?.as_f64()
    }

    fn text(&self, key: &str) -> Option<&'a str> {
        self.value.get(key)?.as_str()
    }

    /// Items of the array at `key`; none without an array.
    fn items(&self, key: &str) -> Vec<Node<'a>> {
        let items = self.value.get(key).and_then(Value::as_array);
        let at = self.at.child(key);
        let item = |(index, value)| Node { value, at: at.child(index) };
        items.into_iter().flatten().enumerate().map(item).collect()
    }

    /// Keys and values of the object at `key`; none without an object.
    fn entries(&self, key: &str) -> Vec<(&'a str, Node<'a>)> {
        let entries = self.value.get(key).and_then(Value::as_object);
        let at = self.at.child(key);
        let entry = |(name, value): (&'a String, &'a Value)| {
            let at = at.child(name);
            (name.as_str(), Node { value, at })
        };
        entries.into_iter().flatten().map(entry).collect()
    }
}

fn interface_count(root: &Node<'_>, found: &mut Vec<Diagnostic>) {
    let length = |key: &str| root.value.get(key).and_then(Value::as_array).map(Vec::len);
    if let (Some(bodies), Some(interfaces)) = (length("bodies"), length("interfaces"))
        && bodies != interfaces
        && bodies > 0
    {
        let fault = Fault::InterfaceCount { interfaces, bodies };
        let accepted = format!(
            "{}: one below each body, the last onto the support",
            count(bodies, "interface", "interfaces")
        );
        found.push(Diagnostic::new(&root.at.child("interfaces"), fault, accepted));
    }
}
