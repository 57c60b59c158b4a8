//! The conditions that tie several values of a scenario together.
//!
//! They are checked on the JSON value and pass over whatever the schema already
//! refuses, so that one reading reports every problem of either sort.

mod extent;
mod laws;
mod names;

use std::path::Path;

use serde_json::Value;

use crate::Scenario;
use crate::diagnostic::{Diagnostic, Problem, count};
use crate::pointer::Pointer;
use crate::samples::{ForceSamples, SamplesError};

/// Deepest nesting of laws in series.
pub const MOST_SERIES_DEPTH: usize = 8;

/// Fewest output samples of a run.
pub const FEWEST_SAMPLES: f64 = 16.0;

/// Most output samples of a run.
pub const MOST_SAMPLES: f64 = 2e8;

/// Most finite-difference cells of one body.
pub const MOST_CELLS: f64 = 1e6;

/// Most time steps of a run.
pub const MOST_STEPS: f64 = 1e11;

/// All the problems of a scenario built or changed in code, as
/// [`crate::document::Document::scenario`] finds them in a text. Relative
/// file names start from `folder`.
pub fn validate(scenario: &Scenario, folder: &Path) -> Vec<Diagnostic> {
    // A scenario holds only maps with text keys, so it always has a JSON form;
    // numbers that are not finite become null, which the schema refuses.
    validate_value(&serde_json::to_value(scenario).unwrap_or_default(), folder)
}

/// The same of a scenario's JSON.
pub fn validate_value(scenario: &Value, folder: &Path) -> Vec<Diagnostic> {
    let found = crate::schema_check::check(crate::schema::schema(), scenario);
    if found.is_empty() { check(scenario, folder) } else { found }
}

/// The problems of a scenario's JSON that its schema cannot state.
pub(crate) fn check(scenario: &Value, folder: &Path) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let root = Node { value: scenario, at: Pointer::root() };
    interface_count(&root, &mut found);
    names::check(&root, &mut found);
    laws::check(&root, &mut found);
    extent::check(&root, &mut found);
    samples(&root, folder, &mut found);
    found
}

/// A value and its place.
#[derive(Clone)]
struct Node<'a> {
    value: &'a Value,
    at: Pointer,
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

    /// The items of the array at `key`; none if there is no array.
    fn items(&self, key: &str) -> Vec<Node<'a>> {
        let items = self.value.get(key).and_then(Value::as_array);
        let at = self.at.child(key);
        let item = |(index, value)| Node { value, at: at.child(index) };
        items.into_iter().flatten().enumerate().map(item).collect()
    }

    /// The keys and values of the object at `key`; none if there is no object.
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
        let problem = Problem::InterfaceCount { interfaces, bodies };
        let accepted = format!(
            "{}: one below each body, the last onto the support",
            count(bodies, "interface", "interfaces")
        );
        found.push(Diagnostic::new(&root.at.child("interfaces"), problem, accepted));
    }
}

fn samples(root: &Node<'_>, folder: &Path, found: &mut Vec<Diagnostic>) {
    let Some(excitation) = root.get("excitation") else {
        return;
    };
    let (Some("samples"), Some(file)) = (excitation.text("kind"), excitation.text("file")) else {
        return;
    };
    let read = ForceSamples::read(&folder.join(file));
    let read = read.and_then(|samples| match excitation.number("peak_n") {
        Some(peak_n) => samples.rescaled(peak_n),
        None => Ok(samples),
    });
    if let Err(source) = read {
        let key = if source == SamplesError::ZeroForce { "peak_n" } else { "file" };
        let accepted = match key {
            "file" => {
                "a CSV file with the header time_s,force_n and rows of increasing time, relative to the scenario's folder"
            }
            _ => "no peak_n, or samples with a force that is not zero",
        };
        let near = match source {
            SamplesError::Input { source: crate::input::InputError::NotFound } => {
                neighbour(folder, file)
            }
            _ => None,
        };
        let file = file.to_owned();
        let problem = Problem::Samples { file, source };
        let diagnostic = Diagnostic::new(&excitation.at.child(key), problem, accepted);
        found.push(diagnostic.suggest_word(near.as_deref()));
    }
}

/// The CSV file in the same folder whose name is nearest to the one asked for.
fn neighbour(folder: &Path, file: &str) -> Option<String> {
    let asked = Path::new(file);
    let beside = asked.parent()?;
    let wanted = asked.file_name()?.to_str()?;
    let entries = std::fs::read_dir(folder.join(beside)).ok()?;
    let mut names: Vec<String> = entries
        .take(1000)
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.to_lowercase().ends_with(".csv"))
        .collect();
    names.sort();
    let near = crate::suggest::nearest(wanted, names.iter().map(String::as_str))?;
    Some(beside.join(near).to_string_lossy().into_owned())
}
