//! One fault at its place in a document, and all faults of an invalid document.

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

use crate::fault::Fault;
use crate::pointer::JsonPointer;
use crate::wording::{brief, one_line};

/// Most faults of one document that are looked for by its schema, and by its other conditions.
pub const MAX_FAULTS: usize = 1000;

/// Fault of a document: its place, its kind, and the accepted values.
///
/// `Display` gives all of it in one line.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// JSON Pointer (RFC 6901) to the value; empty for the whole document.
    pub pointer: String,
    /// Fault of the value.
    pub fault: Fault,
    /// Accepted values, in words.
    pub accepted: String,
    /// Value that may have been meant, as JSON text.
    pub suggestion: Option<String>,
    /// Bytes of the text to underline: the key for an unknown or repeated key, else the value.
    /// `None` for a value that is not in the text, such as one changed by
    /// [`Document::set`](crate::Document::set).
    pub span: Option<Range<usize>>,
}

impl Diagnostic {
    /// Fault at `pointer`, with the accepted values in words.
    pub fn new(pointer: &JsonPointer, fault: Fault, accepted: impl Into<String>) -> Self {
        Self {
            pointer: pointer.to_string(),
            fault,
            accepted: accepted.into(),
            suggestion: None,
            span: None,
        }
    }

    /// The same diagnostic with a suggested value, as JSON text.
    #[must_use]
    pub fn suggest(mut self, suggestion: Option<String>) -> Self {
        self.suggestion = suggestion;
        self
    }

    /// The same diagnostic with a suggested word, which is put in quotes.
    #[must_use]
    pub fn suggest_word(self, word: Option<&str>) -> Self {
        self.suggest(word.map(brief))
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.pointer.as_str() {
            "" => f.write_str("(top level)")?,
            pointer => f.write_str(&one_line(pointer))?,
        }
        write!(f, ": {}; ", self.fault)?;
        if let Some(suggestion) = &self.suggestion {
            write!(f, "did you mean {suggestion}? ")?;
        }
        write!(f, "accepted: {}", self.accepted)
    }
}

/// Document that is not valid, with all its faults.
///
/// `Display` gives one line a fault, in the order of the text.
#[derive(Debug, Clone, PartialEq)]
pub struct InvalidDocument {
    /// File, or the name given to the text.
    pub path: PathBuf,
    /// Faults in the order of the text; never empty.
    pub diagnostics: Vec<Diagnostic>,
}

impl fmt::Display for InvalidDocument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, diagnostic) in self.diagnostics.iter().enumerate() {
            if index > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{}: {diagnostic}", self.path.display())?;
        }
        Ok(())
    }
}

impl std::error::Error for InvalidDocument {}
