//! A value of the document, and its place.

use serde_json::Value;

use crate::pointer::JsonPointer;

/// Value and its place.
#[derive(Clone)]
pub(super) struct Node<'a> {
    pub(super) value: &'a Value,
    pub(super) at: JsonPointer,
}

impl<'a> Node<'a> {
    pub(super) fn get(&self, key: &str) -> Option<Node<'a>> {
        let value = self.value.as_object()?.get(key)?;
        let at = self.at.child(key);
        Some(Node { value, at })
    }

    pub(super) fn number(&self, key: &str) -> Option<f64> {
        self.value.get(key)?.as_f64()
    }

    pub(super) fn text(&self, key: &str) -> Option<&'a str> {
        self.value.get(key)?.as_str()
    }

    /// Items of the array at `key`; none without an array.
    pub(super) fn items(&self, key: &str) -> Vec<Node<'a>> {
        let items = self.value.get(key).and_then(Value::as_array);
        let at = self.at.child(key);
        let item = |(index, value)| Node { value, at: at.child(index) };
        items.into_iter().flatten().enumerate().map(item).collect()
    }

    /// Keys and values of the object at `key`; none without an object.
    pub(super) fn entries(&self, key: &str) -> Vec<(&'a str, Node<'a>)> {
        let entries = self.value.get(key).and_then(Value::as_object);
        let at = self.at.child(key);
        let entry = |(name, value): (&'a String, &'a Value)| {
            let at = at.child(name);
            (name.as_str(), Node { value, at })
        };
        entries.into_iter().flatten().map(entry).collect()
    }
}
