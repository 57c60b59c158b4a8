//! Setting one value of a scenario: `--set POINTER=VALUE`.

use std::collections::BTreeSet;

use serde_json::{Map, Value};
use thiserror::Error;

use crate::diagnostic::{brief, list};
use crate::locate::{self, SyntaxError};
use crate::pointer::{Pointer, PointerError};
use crate::schema::schema;
use crate::suggest::nearest;

/// A value that cannot be set.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SetError {
    /// The pointer is not a JSON Pointer.
    #[error(transparent)]
    Pointer {
        /// Why.
        #[from]
        source: PointerError,
    },
    /// The pointer is empty: it would replace the whole scenario.
    #[error(
        "the empty pointer stands for the whole scenario; expected a pointer such as /excitation/peak_n"
    )]
    WholeDocument,
    /// The pointer leads through a key or an index that is not there.
    #[error("{pointer}: {} has no {}; {}accepted there: {}", place(deepest), brief(part), meant(suggestion.as_deref()), list(accepted))]
    Missing {
        /// The pointer asked for.
        pointer: String,
        /// The deepest pointer that exists.
        deepest: String,
        /// The part that is not there.
        part: String,
        /// The keys or indices that are.
        accepted: Vec<String>,
        /// The pointer that may have been meant.
        suggestion: Option<String>,
    },
    /// The pointer leads into a value that holds nothing.
    #[error("{pointer}: {deepest} holds a single value, so there is nothing inside it to set")]
    NotAContainer {
        /// The pointer asked for.
        pointer: String,
        /// The pointer to the single value.
        deepest: String,
    },
    /// The value starts as a JSON array, object or text, but is none.
    #[error("{pointer}: the value is not JSON: {source}")]
    Value {
        /// The pointer asked for.
        pointer: String,
        /// Why.
        source: SyntaxError,
    },
    /// The value writes a key more than once.
    #[error(
        "{pointer}: the value writes the key {repeated} more than once; expected each key once"
    )]
    RepeatedKey {
        /// The pointer asked for.
        pointer: String,
        /// Pointer to the key inside the value.
        repeated: String,
    },
}

fn place(deepest: &str) -> &str {
    if deepest.is_empty() { "the top level" } else { deepest }
}

fn meant(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |pointer| format!("did you mean {pointer}? "))
}

/// Sets a value inside `document`, or leaves it as it is; returns where.
pub fn set(document: &mut Value, pointer: &str, text: &str) -> Result<Pointer, SetError> {
    let target: Pointer = pointer.parse()?;
    let value = parse(&target, text)?;
    let Some((last, parents)) = target.parts().split_last() else {
        return Err(SetError::WholeDocument);
    };
    let mut changed = document.clone();
    if !parents.is_empty() {
        fill_default(&mut changed, &target);
    }
    for depth in 0..=parents.len() {
        check_part(&changed, &target, depth)?;
    }
    match changed.pointer_mut(&target.ancestor(parents.len()).to_string()) {
        Some(Value::Object(object)) => {
            object.insert(last.clone(), value);
        }
        Some(Value::Array(items)) => match index(last).and_then(|index| items.get_mut(index)) {
            Some(item) => *item = value,
            None => items.push(value),
        },
        _ => {}
    }
    *document = changed;
    Ok(target)
}

/// Whether the part at `depth` of the pointer can be followed, or be set if it
/// is the last one.
fn check_part(document: &Value, target: &Pointer, depth: usize) -> Result<(), SetError> {
    let Some(part) = target.parts().get(depth) else {
        return Ok(());
    };
    let last = depth + 1 == target.parts().len();
    let deepest = target.ancestor(depth);
    let pointer = target.to_string();
    let (accepted, near): (Vec<String>, Option<String>) =
        match document.pointer(&deepest.to_string()) {
            Some(Value::Object(object)) => {
                if last || object.contains_key(part) {
                    return Ok(());
                }
                let keys = object.keys().map(String::as_str);
                let near = nearest(part, keys.clone()).map(str::to_owned);
                (keys.map(brief).collect(), near)
            }
            Some(Value::Array(items)) => {
                let there = index(part).is_some_and(|index| index < items.len());
                if there || (last && part == "-") {
                    return Ok(());
                }
                let mut accepted: Vec<String> = match items.len() {
                    0 => Vec::new(),
                    1 => vec!["index 0".to_owned()],
                    count => vec![format!("indices 0 to {}", count - 1)],
                };
                if last {
                    accepted.push("\"-\" for a new last item".to_owned());
                }
                (accepted, by_name(items, part).map(|index| index.to_string()))
            }
            _ => {
                let deepest = deepest.to_string();
                return Err(SetError::NotAContainer { pointer, deepest });
            }
        };
    let rest = target.parts().iter().skip(depth + 1);
    let suggestion =
        near.map(|near| rest.fold(deepest.child(near), |path, part| path.child(part)).to_string());
    Err(SetError::Missing {
        pointer,
        deepest: deepest.to_string(),
        part: part.clone(),
        accepted,
        suggestion,
    })
}

/// The index of the item whose "name" is `part`.
fn by_name(items: &[Value], part: &str) -> Option<usize> {
    let named = |item: &Value| item.get("name").and_then(Value::as_str) == Some(part);
    items.iter().position(named)
}

/// An array index as RFC 6901 writes it: digits without a leading zero.
fn index(part: &str) -> Option<usize> {
    let digits = part.bytes().all(|byte| byte.is_ascii_digit());
    let plain = digits && (part == "0" || !part.starts_with('0'));
    part.parse().ok().filter(|_| plain)
}

/// Writes out the default of the top-level object that the pointer leads into,
/// when the scenario leaves it out or gives its kind alone.
fn fill_default(document: &mut Value, target: &Pointer) {
    let (Some(key), Value::Object(object)) = (target.parts().first(), document) else {
        return;
    };
    let schema = schema();
    let Some(default @ Value::Object(_)) =
        schema.pointer(&format!("/properties{}/default", target.ancestor(1)))
    else {
        return;
    };
    match object.get(key) {
        None => {
            object.insert(key.clone(), default.clone());
        }
        Some(Value::String(kind)) => {
            let settings = Map::from_iter([("kind".to_owned(), Value::from(kind.as_str()))]);
            object.insert(key.clone(), settings.into());
        }
        Some(_) => {}
    }
}

/// The value a text stands for: JSON where it is JSON, else the text itself.
fn parse(target: &Pointer, text: &str) -> Result<Value, SetError> {
    let pointer = || target.to_string();
    match (locate::locate(text, &BTreeSet::new()), serde_json::from_str(text)) {
        (Ok(places), Ok(value)) => match places.repeated.into_iter().next() {
            None => Ok(value),
            Some((repeated, _)) => Err(SetError::RepeatedKey { pointer: pointer(), repeated }),
        },
        (Err(source), _) if text.trim_start().starts_with(['{', '[', '"']) => {
            Err(SetError::Value { pointer: pointer(), source })
        }
        _ => Ok(Value::String(text.to_owned())),
    }
}
