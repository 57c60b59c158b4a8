//! JSON Pointers (RFC 6901): addresses of values in a document.

use std::fmt;

use thiserror::Error;

/// JSON Pointer (RFC 6901), as its unescaped parts; none for the whole document.
///
/// ```
/// use asperity_scenario::JsonPointer;
///
/// let pointer: JsonPointer = "/laws/a~1b/knots/0".parse()?;
/// assert_eq!(pointer.parts(), ["laws", "a/b", "knots", "0"]);
/// assert_eq!(pointer.to_string(), "/laws/a~1b/knots/0");
/// # Ok::<(), asperity_scenario::PointerError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct JsonPointer {
    parts: Vec<String>,
}

/// Error of a text that is not a JSON Pointer.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PointerError {
    /// Text without a leading slash.
    #[error(
        "{text:?} is not a JSON Pointer: it must start with \"/\"; did you mean {suggestion:?}?"
    )]
    NoLeadingSlash {
        /// Text.
        text: String,
        /// Pointer that may have been meant.
        suggestion: String,
    },
    /// Tilde that is not followed by 0 or 1.
    #[error(
        "{0:?} is not a JSON Pointer: inside a key \"~\" is written \"~0\" and \"/\" is written \"~1\""
    )]
    BadEscape(String),
}

impl JsonPointer {
    /// Pointer to the whole document.
    pub fn root() -> Self {
        Self::default()
    }

    /// Unescaped parts, outermost first.
    pub fn parts(&self) -> &[String] {
        &self.parts
    }

    /// Pointer to the value under `part`, a key or an index.
    #[must_use]
    pub fn child(&self, part: impl fmt::Display) -> Self {
        let mut parts = self.parts.clone();
        parts.push(part.to_string());
        Self { parts }
    }

    /// Pointer made of the first `count` parts.
    #[must_use]
    pub fn ancestor(&self, count: usize) -> Self {
        let parts = self.parts.iter().take(count).cloned().collect();
        Self { parts }
    }
}

impl std::str::FromStr for JsonPointer {
    type Err = PointerError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text.is_empty() {
            return Ok(Self::root());
        }
        let Some(tail) = text.strip_prefix('/') else {
            let separator = if text.contains('/') { '/' } else { '.' };
            return Err(PointerError::NoLeadingSlash {
                text: text.to_owned(),
                suggestion: format!("/{}", text.replace(separator, "/")),
            });
        };
        let parts: Option<Vec<String>> = tail.split('/').map(unescape).collect();
        match parts {
            Some(parts) => Ok(Self { parts }),
            None => Err(PointerError::BadEscape(text.to_owned())),
        }
    }
}

impl fmt::Display for JsonPointer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for part in &self.parts {
            write!(f, "/{}", escape(part))?;
        }
        Ok(())
    }
}

/// Part in the notation of a pointer: `~` as `~0`, `/` as `~1`.
pub(crate) fn escape(part: &str) -> String {
    part.replace('~', "~0").replace('/', "~1")
}

fn unescape(part: &str) -> Option<String> {
    let mut plain = String::with_capacity(part.len());
    let mut characters = part.chars();
    while let Some(character) = characters.next() {
        plain.push(match character {
            '~' => match characters.next()? {
                '0' => '~',
                '1' => '/',
                _ => return None,
            },
            other => other,
        });
    }
    Some(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_round_trip() {
        for text in ["", "/", "/a", "/a~1b/~0~01/0/-", "/ /%"] {
            let pointer: JsonPointer = text.parse().unwrap();
            assert_eq!(pointer.to_string(), text);
        }
        let pointer: JsonPointer = "/~01".parse().unwrap();
        assert_eq!(pointer.parts(), ["~1"]);
    }

    #[test]
    fn a_pointer_is_suggested_for_a_similar_text() {
        for (text, expected) in [("a/b", "/a/b"), ("a.b", "/a/b"), ("a", "/a")] {
            match text.parse::<JsonPointer>() {
                Err(PointerError::NoLeadingSlash { suggestion, .. }) => {
                    assert_eq!(suggestion, expected);
                }
                other => panic!("{other:?}"),
            }
        }
        for text in ["/~", "/a~2"] {
            assert!(matches!(text.parse::<JsonPointer>(), Err(PointerError::BadEscape { .. })));
        }
    }
}
