//! Conditions between values of a scenario, which its schema cannot state.
//!
//! They are checked on the JSON value. Values that the schema rejects are skipped, so one pass
//! reports the faults of both.

mod damping;
mod extent;
mod laws;
mod loads;
mod names;
mod node;

use std::path::Path;

use serde_json::Value;

use crate::diagnostic::Diagnostic;
use crate::fault::Fault;
use crate::pointer::JsonPointer;
use crate::scenario::{Scenario, scenario_schema};
use crate::schema_check::check_schema;
use crate::structure_scenario::structure_schema;
use crate::wording::count;
use node::Node;

pub use extent::{MAX_CELLS, MAX_HISTORY_NUMBERS, MAX_STEPS, MIN_SAMPLES};

/// Checks a scenario built or changed in code, and returns all its faults.
///
/// Relative file names start from `folder`. The checks are those of
/// [`Document::scenario`](crate::Document::scenario).
pub fn validate(scenario: &Scenario, folder: &Path) -> Vec<Diagnostic> {
    // All keys are strings, so a scenario always has a JSON form; numbers that are not finite
    // become null, which the schema rejects.
    validate_json(&serde_json::to_value(scenario).unwrap_or_default(), folder)
}

/// Checks the JSON value of a scenario, of bars or of a structure of matrices, as [`validate`] does.
pub fn validate_json(scenario: &Value, folder: &Path) -> Vec<Diagnostic> {
    let is_structure = has_matrices(scenario);
    let schema = if is_structure { structure_schema() } else { scenario_schema() };
    let found = check_schema(schema, scenario);
    match (found.is_empty(), is_structure) {
        (false, _) => found,
        (true, true) => check_structure(scenario, folder),
        (true, false) => check(scenario, folder),
    }
}

/// True if a body of the JSON value of a scenario is given by matrices.
pub fn has_matrices(scenario: &Value) -> bool {
    let bodies = scenario.get("bodies").and_then(Value::as_array);
    bodies.is_some_and(|bodies| bodies.iter().any(|body| body.get("matrices").is_some()))
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
    loads::no_direction(&root, &mut found);
    found
}

/// Faults of a structure of matrices that its schema cannot state.
pub(crate) fn check_structure(scenario: &Value, folder: &Path) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let root = Node { value: scenario, at: JsonPointer::root() };
    names::check(&root, &mut found);
    laws::check(&root, &mut found);
    damping::check(&root, &mut found);
    extent::samples(&root, &mut found);
    loads::check(&root, folder, &mut found);
    found
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
