//! The place of a value in a document, without memory of its own.

use crate::pointer::JsonPointer;

/// A value's place: that of the value around it, and its key or index there.
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

    pub(super) fn pointer(&self) -> JsonPointer {
        match self {
            Place::Root => JsonPointer::root(),
            Place::Key(around, key) => around.pointer().child(key),
            Place::Item(around, index) => around.pointer().child(index),
        }
    }
}
