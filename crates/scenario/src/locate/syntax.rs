//! What is wrong with a text that is not JSON.

use std::fmt;
use std::ops::Range;

use thiserror::Error;

use crate::diagnostic::one_line;

/// A text that is not JSON, and where.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}, column {column}: {problem}")]
pub struct SyntaxError {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The bytes of the text to underline.
    pub span: Range<usize>,
    /// What is wrong there.
    pub problem: SyntaxProblem,
}

/// What is wrong with a JSON text.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SyntaxProblem {
    /// The text stops in the middle.
    #[error("the text ends too early; expected {expected}")]
    Ended {
        /// What should come next.
        expected: Expected,
    },
    /// Something else than what should come next.
    #[error("found `{}`; expected {expected}", shown(found))]
    Unexpected {
        /// What is there.
        found: String,
        /// What should be there.
        expected: Expected,
    },
    /// A comma before a closing bracket or brace.
    #[error("a comma before {close:?}; expected another item after it, or no comma")]
    TrailingComma {
        /// The closing bracket or brace.
        close: char,
    },
    /// A comment.
    #[error("JSON has no comments; expected a value, a key or punctuation")]
    Comment,
    /// A text in other quotes.
    #[error("found a quote {quote}; expected texts and keys in double quotes, \"like this\"")]
    OtherQuotes {
        /// The quote.
        quote: char,
    },
    /// A number with a comma before its decimals.
    #[error("`{}` has a decimal comma; expected a decimal point, as in 0.5", shown(word))]
    DecimalComma {
        /// The number.
        word: String,
    },
    /// NaN or infinity.
    #[error("`{}` is not a JSON number; expected a finite number such as 0.5 or 2e5", shown(word))]
    NotFinite {
        /// The word.
        word: String,
    },
    /// A malformed number.
    #[error("`{}` is not a JSON number; expected digits as in 12, -0.5 or 2.5e-3", shown(word))]
    BadNumber {
        /// The word.
        word: String,
    },
    /// A number too large to be stored.
    #[error("the number `{}` is too large; expected a magnitude below 1.8e308", shown(word))]
    NumberTooLarge {
        /// The word.
        word: String,
    },
    /// A backslash that starts no escape.
    #[error(
        r#"`{}` is not an escape; expected \\ for a backslash or \" for a quote"#,
        shown(found)
    )]
    BadEscape {
        /// The backslash and what follows.
        found: String,
    },
    /// A line break or another control character inside a text.
    #[error(
        "a text holds the control character {character:?}; expected a closing quote before it, or an escape such as \\n"
    )]
    ControlCharacter {
        /// The character.
        character: char,
    },
    /// Arrays and objects inside one another beyond any scenario.
    #[error("arrays and objects are nested more than {most} deep; expected a scenario object")]
    TooDeep {
        /// Deepest nesting accepted.
        most: usize,
    },
    /// Text after the end of the value.
    #[error("found `{}` after the end of the document; expected nothing more", shown(found))]
    TrailingText {
        /// What is there.
        found: String,
    },
}

/// What should come next in a JSON text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expected {
    /// The object that a scenario is.
    Document,
    /// A value.
    Value,
    /// A key, after a comma.
    Key,
    /// A key or the end of the object.
    KeyOrEnd,
    /// The colon after a key.
    Colon,
    /// A comma or the end of the array.
    CommaOrBracket,
    /// A comma or the end of the object.
    CommaOrBrace,
    /// The closing quote of a text.
    Quote,
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Document => "a JSON object, starting with \"{\"",
            Self::Value => "a value: an object, an array, a text in double quotes, a number, true, false or null",
            Self::Key => "a key in double quotes",
            Self::KeyOrEnd => "a key in double quotes, or \"}\"",
            Self::Colon => "\":\" after the key",
            Self::CommaOrBracket => "\",\" or \"]\" before it",
            Self::CommaOrBrace => "\",\" or \"}\" before it",
            Self::Quote => "the closing quote of a text",
        })
    }
}

/// What the text holds, without the escapes that quotes would need.
fn shown(found: &str) -> String {
    one_line(found).replace("\\\"", "\"").replace("\\\\", "\\")
}
