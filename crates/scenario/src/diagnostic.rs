//! What is wrong with a scenario, where, and what would be accepted.

mod problem;
mod words;

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

use crate::pointer::Pointer;

pub use problem::{Bound, Found, NameFault, Problem};
pub use words::rounded;
pub(crate) use words::{brief, count, joined, list, number, one_line};

/// One problem of a scenario: where, what, and what would be accepted.
///
/// Its `Display` is one line that says all of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// JSON Pointer (RFC 6901) to the value; empty for the whole document.
    pub pointer: String,
    /// What is wrong there.
    pub problem: Problem,
    /// What would be accepted there, in words.
    pub accepted: String,
    /// What may have been meant, as JSON text.
    pub suggestion: Option<String>,
    /// The bytes of the scenario's text to underline: the key for an unknown or
    /// repeated key, else the value. `None` when the text does not hold it,
    /// as for a value that was set on the command line.
    pub span: Option<Range<usize>>,
}

impl Diagnostic {
    /// A problem at `pointer`, with what would be accepted there.
    pub fn new(pointer: &Pointer, problem: Problem, accepted: impl Into<String>) -> Self {
        Self {
            pointer: pointer.to_string(),
            problem,
            accepted: accepted.into(),
            suggestion: None,
            span: None,
        }
    }

    /// The same with what may have been meant, as JSON text.
    #[must_use]
    pub fn suggest(mut self, suggestion: Option<String>) -> Self {
        self.suggestion = suggestion;
        self
    }

    /// The same with a word that may have been meant, put in quotes.
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
        write!(f, ": {}; ", self.problem)?;
        if let Some(suggestion) = &self.suggestion {
            write!(f, "did you mean {suggestion}? ")?;
        }
        write!(f, "accepted: {}", self.accepted)
    }
}

/// A scenario that is not valid, with every problem found.
///
/// Its `Display` is one line a problem, in the order of the text.
#[derive(Debug, Clone, PartialEq)]
pub struct Invalid {
    /// The scenario's file, or the name its text was given.
    pub path: PathBuf,
    /// The problems, in the order of the text; never empty.
    pub diagnostics: Vec<Diagnostic>,
}

impl fmt::Display for Invalid {
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

impl std::error::Error for Invalid {}
