//! The state of a check, places in a document, and the types of JSON Schema.

use serde_json::Value;

use crate::diagnostic::Diagnostic;
use crate::fault::Fault;
use crate::pointer::JsonPointer;

/// A walk over a document and its schema, and the faults found on it.
pub(super) struct Walker<'s> {
    pub(super) root: &'s Value,
    pub(super) found: Vec<Diagnostic>,
}

/// A value's place: that of the value around it, and its key or index there. It becomes a pointer where a fault is.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place<'a> {
    Root,
    Key(&'a Place<'a>, &'a str),
    Item(&'a Place<'a>, usize),
}

impl<'a> Place<'a> {
    pub(super) fn key(&'a self, key: &'a str) -> Self {
        Place::Key(self, key)
    }

    pub(super) fn item(&'a self, index: usize) -> Self {
        Place::Item(self, index)
    }

    /// A fault at this place.
    pub(super) fn diagnostic(&self, fault: Fault, accepted: impl Into<String>) -> Diagnostic {
        Diagnostic::new(&self.pointer(), fault, accepted)
    }

    pub(super) fn pointer(&self) -> JsonPointer {
        match self {
            Place::Root => JsonPointer::root(),
            Place::Key(around, key) => around.pointer().child(key),
            Place::Item(around, index) => around.pointer().child(index),
        }
    }
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
