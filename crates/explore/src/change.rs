//! Changes of a scenario, and faults in them.

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
