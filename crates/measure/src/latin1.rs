//! Bytes of a text whose encoding nobody wrote down.

use std::borrow::Cow;

/// The text, and whether it had to be read as Latin-1 because it is not UTF-8.
pub(crate) fn decode(bytes: &[u8]) -> (Cow<'_, str>, bool) {
    match std::str::from_utf8(bytes) {
        Ok(text) => (Cow::Borrowed(text), false),
        Err(_) => (Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()), true),
    }
}
