//! Places of values in a JSON text: the bytes of the key and the value of a pointer, repeated keys,
//! and syntax errors.
//!
//! The scanner accepts the texts that `serde_json` accepts, except for deeper nesting, so a text
//! that passes it can be parsed.

mod scanner;
mod syntax;

use std::collections::BTreeSet;

pub use scanner::MAX_NESTING;
pub(crate) use scanner::Places;
pub use syntax::{ExpectedToken, SyntaxError, SyntaxFault};

/// Scans a JSON text for the places of the `wanted` pointers (of a repeated key, the last one) and
/// for repeated keys.
///
/// # Errors
/// [`SyntaxError`] for a text that is not JSON, or is nested deeper than [`MAX_NESTING`].
pub(crate) fn locate(text: &str, wanted: &BTreeSet<&str>) -> Result<Places, SyntaxError> {
    scanner::scan(text, wanted)
}

#[cfg(test)]
mod tests {
    use super::scanner::line_and_column;
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
