//! Errors of reading matrices, meshes, cells and loads.

use std::fmt;

/// A position in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// Line of a text, from one.
    Line(u64),
    /// Bytes from the start of the file, from zero.
    Byte(u64),
    /// Name of an array.
    Array(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Array(name) => write!(f, "array {name}"),
        }
    }
}

/// Errors of reading matrices, meshes, cells and loads.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MatricesError {
    /// An error of the operating system.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: String,
        /// The error.
        source: std::io::Error,
    },
    /// Content that violates the format.
    #[error("{file}, {place}: {found}; expected {expected}")]
    Malformed {
        /// The file.
        file: String,
        /// The position.
        place: Place,
        /// The content found.
        found: String,
        /// The content accepted.
        expected: String,
    },
    /// A file that ends before it is complete.
    #[error("{file} ends early, at {place}: {missing}")]
    EndsEarly {
        /// The file.
        file: String,
        /// The end.
        place: Place,
        /// The part that is missing.
        missing: String,
    },
    /// Content that needs more memory than the size of the file allows.
    #[error(
        "{file}, {place}: {what} takes {announced} bytes; at most {limit} for a file of this size"
    )]
    TooLarge {
        /// The file.
        file: String,
        /// The position.
        place: Place,
        /// The part of the file.
        what: String,
        /// Bytes needed.
        announced: u64,
        /// Most bytes accepted.
        limit: u64,
    },
    /// A matrix that is not symmetric.
    #[error(
        "{file}: the matrix is not symmetric: the entry of row {row} and column {column} is {value:e}, \
         its partner {partner}; expected one triangle, or both with equal entries"
    )]
    Asymmetric {
        /// The file.
        file: String,
        /// The row.
        row: String,
        /// The column.
        column: String,
        /// The entry.
        value: f64,
        /// The entry with row and column exchanged, in words.
        partner: String,
    },
    /// An entry that is given twice.
    #[error(
        "{file}: the entry of row {row} and column {column} is given twice; expected each entry once"
    )]
    Twice {
        /// The file.
        file: String,
        /// The row.
        row: String,
        /// The column.
        column: String,
    },
    /// Parts of a structure that do not fit together.
    #[error("{what}; {remedy}")]
    Inconsistent {
        /// The fault, and its place.
        what: String,
        /// The content accepted.
        remedy: String,
    },
    /// A feature of a file that cannot be read.
    #[error("{file}, {place}: {feature} cannot be read; {remedy}")]
    Unsupported {
        /// The file.
        file: String,
        /// The position.
        place: Place,
        /// The feature.
        feature: String,
        /// The remedy.
        remedy: String,
    },
}

impl MatricesError {
    pub(crate) fn malformed(
        file: &str,
        place: Place,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        let (found, expected) = (found.into(), expected.into());
        Self::Malformed { file: file.to_owned(), place, found, expected }
    }

    pub(crate) fn inconsistent(what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Inconsistent { what: what.into(), remedy: remedy.into() }
    }
}

/// Text from a file, shortened for a message.
pub(crate) fn excerpt(bytes: &[u8]) -> String {
    const MOST: usize = 60;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * MOST)]);
    let text = text.trim();
    let mut short: String = text.chars().take(MOST).collect();
    if text.chars().nth(MOST).is_some() {
        short.push_str("...");
    }
    format!("`{}`", short.escape_debug())
}
