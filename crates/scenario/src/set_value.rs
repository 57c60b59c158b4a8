//! Changing one value of a scenario, by its JSON Pointer.

use std::collections::BTreeSet;

use serde_json::{Map, Value};
use thiserror::Error;

use crate::locate::{self, SyntaxError};
use crate::pointer::{JsonPointer, PointerError};
use crate::scenario::scenario_schema;
use crate::suggest::nearest;
use crate::wording::{brief, list};

/// Error of a value that cannot be set.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SetError {
    /// Pointer that is not a JSON Pointer.
    #[error(transparent)]
    Pointer(#[from] PointerError),
    /// Empty pointer, which would replace the whole scenario.
    #[error(
        "the empty pointer denotes the whole scenario; expected a pointer such as /excitation/peak_n"
    )]
    WholeDocument,
    /// Pointer through a key or an index that does not exist.
    #[error("{pointer}: {} has no {}; {}accepted there: {}", place(deepest), brief(part), meant(suggestion.as_deref()), list(accepted))]
    Missing {
        /// Pointer to the value.
        pointer: String,
        /// Deepest part of the pointer that exists.
        deepest: String,
        /// Part that does not exist.
        part: String,
        /// Keys or indices that exist.
        accepted: Vec<String>,
        /// Pointer that may have been meant.
        suggestion: Option<String>,
    },
    /// Pointer into a number, a string, a truth value or null.
    #[error("{pointer}: {deepest} is neither an object nor an array; nothing inside it can be set")]
    NotAContainer {
        /// Pointer to the value.
        pointer: String,
        /// Pointer to that value.
        deepest: String,
    },
    /// Value that starts like a JSON array, object or string but is not JSON.
    #[error("{pointer}: the value is not JSON: {source}")]
    Value {
        /// Pointer to the value.
        pointer: String,
        /// Cause.
        source: SyntaxError,
    },
    /// Value with a repeated key.
    #[error(
        "{pointer}: the value contains the key {repeated} more than once; expected each key once"
    )]
    RepeatedKey {
        /// Pointer to the value.
        pointer: String,
        /// Pointer to the key inside the value.
        repeated: String,
    },
}

/// Sets the value at a JSON Pointer of a scenario, and returns the pointer.
///
/// `text` is taken as JSON if it is JSON, else as a string. The pointer leads to an existing value,
/// to a new key of an object, or to `-` after the last item of an array. An object that the
/// scenario leaves to its default is written out when a value inside it is set.
///
/// # Errors
/// [`SetError`] for a pointer or a value that is not valid; `document` is then unchanged.
///
/// ```
/// let mut scenario = serde_json::json!({"gravity_m_per_s2": 9.81});
/// asperity_scenario::set_value(&mut scenario, "/method/step_s", "1e-5")?;
/// assert_eq!(scenario["method"], serde_json::json!({"kind": "modal", "step_s": 1e-5}));
/// # Ok::<(), asperity_scenario::SetError>(())
/// ```
pub fn set_value(document: &mut Value, pointer: &str, text: &str) -> Result<JsonPointer, SetError> {
    let target: JsonPointer = pointer.parse()?;
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

fn place(deepest: &str) -> &str {
    if deepest.is_empty() { "the top level" } else { deepest }
}

fn meant(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |pointer| format!("did you mean {pointer}? "))
}

/// Checks that the part at `depth` of the pointer exists, or can be added if it is the last one.
fn check_part(document: &Value, target: &JsonPointer, depth: usize) -> Result<(), SetError> {
    let Some(part) = target.parts().get(depth) else { return Ok(()) };
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

/// Index of the item whose "name" is `part`.
fn by_name(items: &[Value], part: &str) -> Option<usize> {
    let named = |item: &Value| item.get("name").and_then(Value::as_str) == Some(part);
    items.iter().position(named)
}

/// Array index in the notation of RFC 6901: digits without a leading zero.
fn index(part: &str) -> Option<usize> {
    let digits = part.bytes().all(|byte| byte.is_ascii_digit());
    let plain = digits && (part == "0" || !part.starts_with('0'));
    part.parse().ok().filter(|_| plain)
}

/// Writes out the default of the top-level object that the pointer leads into, where the scenario
/// leaves it out or gives its kind alone.
fn fill_default(document: &mut Value, target: &JsonPointer) {
    let (Some(key), Value::Object(object)) = (target.parts().first(), document) else { return };
    let Some(default @ Value::Object(_)) =
        scenario_schema().pointer(&format!("/properties{}/default", target.ancestor(1)))
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

/// Value of a text: JSON if it is JSON, else the text as a string.
fn parse(target: &JsonPointer, text: &str) -> Result<Value, SetError> {
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
