//! The state of a check, and the types of JSON Schema.

use serde_json::Value;

use crate::diagnostic::Diagnostic;

/// A walk over a document and its schema, and the faults found on it.
pub(super) struct Walker<'s> {
    pub(super) root: &'s Value,
    pub(super) found: Vec<Diagnostic>,
}

/// True where `value` has the JSON Schema type `kind`.
///
/// JSON Schema accepts 1.0 as an integer and serde does not, so an integer is written without a
/// fraction.
pub(super) fn has_type(value: &Value, kind: &str) -> bool {
    match kind {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "object" => value.is_object(),
        "array" => value.is_array(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        _ => false,
    }
}
