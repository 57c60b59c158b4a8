//! Check of a document against a JSON Schema, with a fault at each place.
//!
//! A general validator reports that no branch of a union fits. This one is restricted to the
//! schemas that the types of a scenario generate: it selects the branch by its `kind`, or by its
//! JSON type, and reports faults inside it. The tests compare it with an independent validator.

mod accepted;
mod union;
mod walker;

use serde_json::{Map, Value};

use crate::diagnostic::{Diagnostic, MAX_FAULTS};
use crate::fault::Fault;
use crate::suggest::nearest;
use crate::wording::{brief, found, number};
use walker::{Place, Walker, has_type};

/// Checks a JSON value against a schema generated from a Rust type, and returns all faults; of more
/// than [`MAX_FAULTS`] the first.
///
/// The keywords that [`scenario_schema`](crate::scenario_schema) contains are applied.
///
/// ```
/// use asperity_scenario::{check_schema, scenario_schema};
///
/// let faults = check_schema(scenario_schema(), &serde_json::json!({"duration_s": -1.0}));
/// assert!(faults.iter().any(|fault| fault.pointer == "/duration_s"));
/// ```
pub fn check_schema(schema: &Value, document: &Value) -> Vec<Diagnostic> {
    let mut walker = Walker { root: schema, found: Vec::new() };
    walker.node(schema, document, &Place::Root);
    walker.found
}

impl<'s> Walker<'s> {
    /// Checks `value` under `node` and whatever `node` refers to.
    fn node(&mut self, node: &'s Value, value: &Value, at: &Place<'_>) {
        if self.found.len() >= MAX_FAULTS {
            return;
        }
        if let Some(target) = self.target(node) {
            self.node(target, value, at);
        }
        let kind = node.get("type").and_then(Value::as_str);
        let only = node.get("const");
        if kind.is_some_and(|kind| !has_type(value, kind)) || only.is_some_and(|only| only != value)
        {
            self.reject(node, value, at);
            return;
        }
        match value {
            Value::Object(object) => self.object(node, object, at),
            Value::Array(items) => self.array(node, items, at),
            Value::Number(_) => self.bounds(node, value, at),
            Value::String(text) => self.text(node, text, at),
            Value::Null | Value::Bool(_) => {}
        }
        self.one_of(node, value, at);
        self.any_of(node, value, at);
    }

    fn object(&mut self, node: &'s Value, object: &Map<String, Value>, at: &Place<'_>) {
        let properties = node.get("properties").and_then(Value::as_object);
        let known = |key: &str| properties.and_then(|properties| properties.get(key));
        let names = || properties.into_iter().flat_map(Map::keys).map(String::as_str);
        let mut meant = Vec::new();
        for (key, value) in object {
            if self.found.len() >= MAX_FAULTS {
                return;
            }
            let child = at.key(key);
            match (known(key), node.get("additionalProperties")) {
                (Some(property), _) => self.node(property, value, &child),
                (None, Some(Value::Bool(false))) => {
                    let free = names().filter(|name| !object.contains_key(*name));
                    let near = nearest(key, free);
                    meant.extend(near);
                    let unknown = child.diagnostic(Fault::UnknownKey, accepted::keys(names()));
                    self.found.push(unknown.suggest_word(near));
                }
                (None, Some(rest)) => self.node(rest, value, &child),
                (None, None) => {}
            }
        }
        let required = node.get("required").and_then(Value::as_array);
        for key in required.into_iter().flatten().filter_map(Value::as_str) {
            // A misspelt key is one fault, not an unknown and a missing key.
            if !object.contains_key(key) && !meant.contains(&key) {
                let accepted = match known(key) {
                    Some(property) => self.accepted(property),
                    None => brief(key),
                };
                let key = key.to_owned();
                self.found.push(at.diagnostic(Fault::MissingKey(key), accepted));
            }
        }
    }

    fn array(&mut self, node: &'s Value, items: &[Value], at: &Place<'_>) {
        let limit = |keyword: &str| node.get(keyword).and_then(Value::as_u64);
        let count = items.len();
        let few = limit("minItems").is_some_and(|least| (count as u64) < least);
        let many = limit("maxItems").is_some_and(|most| count as u64 > most);
        if few || many {
            let fault = Fault::WrongLength(count);
            self.found.push(at.diagnostic(fault, self.accepted(node)));
        }
        if let Some(item_node) = node.get("items") {
            for (index, item) in items.iter().enumerate() {
                self.node(item_node, item, &at.item(index));
            }
        }
    }

    fn bounds(&mut self, node: &'s Value, value: &Value, at: &Place<'_>) {
        let Some(size) = value.as_f64() else { return };
        for bound in accepted::bounds(node) {
            if !bound.holds(size) {
                let fault = Fault::OutOfBounds { value: size, bound };
                let default = node.get("default").and_then(Value::as_f64).map(number);
                let accepted = self.accepted(node);
                self.found.push(at.diagnostic(fault, accepted).suggest(default));
            }
        }
    }

    fn text(&mut self, node: &'s Value, text: &str, at: &Place<'_>) {
        let least = node.get("minLength").and_then(Value::as_u64);
        if least.is_some_and(|least| (text.chars().count() as u64) < least) {
            self.found.push(at.diagnostic(Fault::EmptyText, self.accepted(node)));
        }
    }

    /// Reports a value of the wrong type or the wrong word.
    fn reject(&mut self, node: &'s Value, value: &Value, at: &Place<'_>) {
        let fault = Fault::NotAccepted(found(value));
        let suggestion = self.meant(node, value);
        let accepted = self.accepted(node);
        self.found.push(at.diagnostic(fault, accepted).suggest(suggestion));
    }

    /// Value of the right type that may have been meant by `value`.
    fn meant(&self, node: &'s Value, value: &Value) -> Option<String> {
        let kind = node.get("type").and_then(Value::as_str);
        match (value, kind) {
            (Value::String(text), Some("number" | "integer")) => {
                let plain = text.trim().replace(',', ".");
                let value = plain.parse().ok().filter(|value: &f64| value.is_finite())?;
                Some(number(value))
            }
            (Value::String(text), Some("boolean")) => match text.to_lowercase().as_str() {
                "true" | "yes" | "on" => Some("true".to_owned()),
                "false" | "no" | "off" => Some("false".to_owned()),
                _ => None,
            },
            (Value::String(text), _) => {
                let words = self.words(node);
                nearest(text, words.iter().copied()).map(brief)
            }
            _ => None,
        }
    }

    /// Node that a `$ref` refers to.
    fn target(&self, node: &Value) -> Option<&'s Value> {
        let reference = node.get("$ref")?.as_str()?;
        match reference.strip_prefix("#/$defs/") {
            Some(name) if !name.contains(['/', '~']) => self.root.get("$defs")?.get(name),
            _ => self.root.pointer(reference.strip_prefix('#')?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keywords of JSON Schema that are applied, or carry no constraint.
    const KEYWORDS: [&str; 22] = [
        "$schema",
        "$defs",
        "$ref",
        "title",
        "description",
        "default",
        "format",
        "type",
        "const",
        "oneOf",
        "anyOf",
        "properties",
        "required",
        "additionalProperties",
        "items",
        "minItems",
        "maxItems",
        "minLength",
        "minimum",
        "maximum",
        "exclusiveMinimum",
        "exclusiveMaximum",
    ];

    /// An unsupported keyword would be ignored silently.
    #[test]
    fn the_schema_uses_no_other_keyword() {
        fn visit(node: &Value) {
            for (keyword, inner) in node.as_object().into_iter().flatten() {
                assert!(KEYWORDS.contains(&keyword.as_str()), "{keyword}");
                match (keyword.as_str(), inner) {
                    ("properties" | "$defs", Value::Object(nodes)) => {
                        nodes.values().for_each(visit);
                    }
                    ("oneOf" | "anyOf", Value::Array(nodes)) => nodes.iter().for_each(visit),
                    ("items" | "additionalProperties", node) => visit(node),
                    _ => {}
                }
            }
        }
        visit(crate::scenario::scenario_schema());
    }
}
