//! Accepted values of a node of the schema, in words.

use serde_json::Value;

use super::walker::Walker;
use crate::fault::Bound;
use crate::wording::{brief, list};

impl<'s> Walker<'s> {
    /// Accepted values of `node` in words, with its description.
    pub(super) fn accepted(&self, node: &'s Value) -> String {
        let shape = self.shape(node);
        match node.get("description").and_then(first_sentence) {
            Some(meaning) => format!("{shape} ({meaning})"),
            None => shape,
        }
    }

    /// Accepted values of `node` in words.
    fn shape(&self, node: &'s Value) -> String {
        if let Some(only) = node.get("const") {
            return only.to_string();
        }
        if let Some(target) = self.target(node) {
            return self.shape(target);
        }
        let kinds = self.kinds(node);
        if !kinds.is_empty() {
            return format!("an object whose \"kind\" is {}", one_of(&kinds));
        }
        let words = self.words(node);
        if let Some(branches) = node.get("anyOf").and_then(Value::as_array) {
            let shapes: Vec<String> = branches.iter().map(|branch| self.shape(branch)).collect();
            return shapes.join(", or ");
        }
        if !words.is_empty() {
            return one_of(&words);
        }
        match node.get("type").and_then(Value::as_str) {
            Some("number") => with_bounds("a number", node),
            Some("integer") => with_bounds("a whole number", node),
            Some("boolean") => "true or false".to_owned(),
            Some("string") if node.get("minLength").is_some() => "a non-empty string".to_owned(),
            Some("string") => "a string".to_owned(),
            Some("array") => self.array_shape(node),
            Some("object") => match node.get("properties").and_then(Value::as_object) {
                Some(properties) => format!("an object with the keys {}", list(properties.keys())),
                None => "an object".to_owned(),
            },
            _ => "another value".to_owned(),
        }
    }

    fn array_shape(&self, node: &'s Value) -> String {
        let limit = |keyword: &str| node.get(keyword).and_then(Value::as_u64);
        let item = node
            .get("items")
            .map_or_else(String::new, |items| format!(", each {}", self.shape(items)));
        match (limit("minItems"), limit("maxItems")) {
            (Some(least), Some(most)) if least == most => {
                format!("an array of {least} items{item}")
            }
            (Some(least), Some(most)) => format!("an array of {least} to {most} items{item}"),
            (Some(1), None) => format!("an array of at least 1 item{item}"),
            (Some(least), None) => format!("an array of at least {least} items{item}"),
            _ => format!("an array{item}"),
        }
    }

    /// Words that `node` accepts, if it accepts words only.
    pub(super) fn words(&self, node: &'s Value) -> Vec<&'s str> {
        if let Some(word) = node.get("const").and_then(Value::as_str) {
            return vec![word];
        }
        if let Some(target) = self.target(node) {
            return self.words(target);
        }
        branches(node).flat_map(|branch| self.words(branch)).collect()
    }

    /// Kinds of a tagged union; none if `node` is not one.
    pub(super) fn kinds(&self, node: &'s Value) -> Vec<&'s str> {
        if let Some(target) = self.target(node) {
            return self.kinds(target);
        }
        branches(node).filter_map(kind_of).collect()
    }
}

/// Branches of a union.
pub(super) fn branches(node: &Value) -> impl Iterator<Item = &Value> {
    let one_of = node.get("oneOf").and_then(Value::as_array);
    one_of.into_iter().flatten()
}

/// `kind` that selects a branch of a tagged union.
pub(super) fn kind_of(branch: &Value) -> Option<&str> {
    branch.get("properties")?.get("kind")?.get("const")?.as_str()
}

/// Bounds of a number.
pub(super) fn bounds(node: &Value) -> impl Iterator<Item = Bound> {
    let limit = |keyword: &str| node.get(keyword).and_then(Value::as_f64);
    [
        limit("exclusiveMinimum").map(Bound::Above),
        limit("minimum").map(Bound::AtLeast),
        limit("exclusiveMaximum").map(Bound::Below),
        limit("maximum").map(Bound::AtMost),
    ]
    .into_iter()
    .flatten()
}

/// List of keys, or "no keys".
pub(super) fn keys<'a>(names: impl Iterator<Item = &'a str>) -> String {
    match list(names) {
        none if none.is_empty() => "no keys".to_owned(),
        names => names,
    }
}

/// Words in quotes, as alternatives.
pub(super) fn one_of(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| brief(word)).collect();
    match quoted.as_slice() {
        [only] => only.clone(),
        _ => format!("one of {}", list(&quoted)),
    }
}

/// First paragraph of a description, without its full stop.
pub(super) fn first_sentence(description: &Value) -> Option<String> {
    let paragraph = description.as_str()?.split("\n\n").next()?;
    let line = paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
    Some(line.trim_end_matches('.').to_owned()).filter(|line| !line.is_empty())
}

fn with_bounds(what: &str, node: &Value) -> String {
    let bounds: Vec<String> = bounds(node).map(|bound| bound.to_string()).collect();
    match bounds.join(" and ") {
        none if none.is_empty() => what.to_owned(),
        bounds if bounds.starts_with("at ") => format!("{what} of {bounds}"),
        bounds => format!("{what} {bounds}"),
    }
}
