//! Places of values in a JSON text: the bytes of the key and the value of a pointer, repeated keys,
//! and syntax errors.
//!
//! The scanner accepts the texts that `serde_json` accepts, except for deeper nesting, so a text
//! that passes it can be parsed.

mod scanner;
mod syntax;

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

pub use syntax::{ExpectedToken, SyntaxError, SyntaxFault};

/// Deepest accepted nesting of arrays and objects.
pub const MAX_NESTING: usize = 100;

/// Place of a value in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Place {
    /// Bytes of the key with its quotes; `None` for array items and the whole document.
    pub key: Option<Range<usize>>,
    /// Bytes of the value.
    pub value: Range<usize>,
}

/// Places found by a scan.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Places {
    /// Places of the wanted pointers that exist.
    pub found: HashMap<String, Place>,
    /// Pointers of keys written more than once in their object, with the bytes of the repetition.
    pub repeated: Vec<(String, Range<usize>)>,
}

/// Scans a JSON text for the places of the `wanted` pointers (of a repeated key, the last one) and
/// for repeated keys.
///
/// # Errors
/// [`SyntaxError`] for a text that is not JSON, or is nested deeper than [`MAX_NESTING`].
pub(crate) fn locate(text: &str, wanted: &BTreeSet<&str>) -> Result<Places, SyntaxError> {
    scanner::scan(text, wanted)
}

/// Line and column of a byte of the text, both from 1; columns count characters.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let column = before.get(start..).map_or(0, |line| line.chars().count()) + 1;
    (line, column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_values_and_repetitions_are_found() {
        let text = r#"{ "a": [1, {"b/c": "x\u00e9"}], "a\n": -0.5e3, "d": {}, "d": [] }"#;
        let wanted = BTreeSet::from(["", "/a/0", "/a/1/b~1c", "/a\n", "/d", "/none"]);
        let places = locate(text, &wanted).unwrap();
        let shown = |pointer: &str| {
            let place = &places.found[pointer];
            let key = place.key.clone().map(|range| &text[range]);
            (key, &text[place.value.clone()])
        };
        assert_eq!(shown(""), (None, text));
        assert_eq!(shown("/a/0"), (None, "1"));
        assert_eq!(shown("/a/1/b~1c"), (Some(r#""b/c""#), r#""x\u00e9""#));
        assert_eq!(shown("/a\n"), (Some(r#""a\n""#), "-0.5e3"));
        assert_eq!(shown("/d"), (Some(r#""d""#), "[]"));
        assert!(!places.found.contains_key("/none"));
        assert_eq!(places.repeated.len(), 1);
        assert_eq!(places.repeated[0].0, "/d");
        assert_eq!(line_and_column("ä\nbé c", 6), (2, 3));
    }

    #[test]
    fn texts_that_are_not_json_are_rejected() {
        let nested = "[".repeat(MAX_NESTING + 1);
        for text in [
            "",
            " ",
            "{",
            "[1,]",
            "{\"a\":1,}",
            "[1 2]",
            "{a:1}",
            "{'a':1}",
            "nul",
            "NaN",
            "-",
            "01",
            "1.",
            ".5",
            "+1",
            "1e",
            "1e999",
            "\"\\x\"",
            "\"\\ud800\"",
            "\"\u{1}\"",
            "\"",
            "1 2",
            "// c\n1",
            "[1]]",
            "{\"a\" 1}",
            "{\"a\":}",
            "-Infinity",
            "1_000",
            "0x1F",
            "tru",
            "truely",
            "True",
            &nested,
        ] {
            let error = locate(text, &BTreeSet::new());
            assert!(error.is_err(), "{text:?}");
            assert!(serde_json::from_str::<serde_json::Value>(text).is_err() || text == nested);
        }
    }
}
