//! Syntax errors of a JSON text.

use std::fmt;
use std::ops::Range;

use thiserror::Error;

use crate::wording::one_line;

/// Syntax error of a text, with its place.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}, column {column}: {fault}")]
pub struct SyntaxError {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Bytes of the text to underline.
    pub span: Range<usize>,
    /// Fault of the text.
    pub fault: SyntaxFault,
}

/// Kind of a syntax error.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SyntaxFault {
    /// End of the text inside a value.
    #[error("unexpected end of the text; expected {expected}")]
    Ended {
        /// Expected token.
        expected: ExpectedToken,
    },
    /// Token other than the expected one.
    #[error("found `{}`; expected {expected}", shown(found))]
    Unexpected {
        /// Text found.
        found: String,
        /// Expected token.
        expected: ExpectedToken,
    },
    /// Comma before a closing bracket or brace.
    #[error("a comma before {close:?}; expected another item after it, or no comma")]
    TrailingComma {
        /// Closing bracket or brace.
        close: char,
    },
    /// Comment.
    #[error("JSON has no comments; expected a value, a key or punctuation")]
    Comment,
    /// String in other quotes.
    #[error("found a quote {quote}; expected strings and keys in double quotes, \"like this\"")]
    OtherQuotes {
        /// Quote.
        quote: char,
    },
    /// Number with a decimal comma.
    #[error("`{}` has a decimal comma; expected a decimal point, as in 0.5", shown(word))]
    DecimalComma {
        /// Number.
        word: String,
    },
    /// NaN or infinity.
    #[error("`{}` is not a JSON number; expected a finite number such as 0.5 or 2e5", shown(word))]
    NotFinite {
        /// Word.
        word: String,
    },
    /// Malformed number.
    #[error("`{}` is not a JSON number; expected digits as in 12, -0.5 or 2.5e-3", shown(word))]
    BadNumber {
        /// Word.
        word: String,
    },
    /// Number above the range of double precision.
    #[error("the number `{}` is too large; expected a magnitude below 1.8e308", shown(word))]
    NumberTooLarge {
        /// Word.
        word: String,
    },
    /// Backslash that does not start an escape sequence.
    #[error(
        r#"`{}` is not an escape; expected \\ for a backslash or \" for a quote"#,
        shown(found)
    )]
    BadEscape {
        /// Backslash and the characters after it.
        found: String,
    },
    /// Line break or another control character inside a string.
    #[error(
        "a string contains the control character {character:?}; expected a closing quote before it, or an escape such as \\n"
    )]
    ControlCharacter {
        /// Character.
        character: char,
    },
    /// Arrays and objects nested too deep.
    #[error("arrays and objects are nested more than {max} deep; expected a scenario object")]
    TooDeep {
        /// Deepest accepted nesting.
        max: usize,
    },
    /// Text after the end of the document.
    #[error("found `{}` after the end of the document; expected nothing more", shown(found))]
    TrailingText {
        /// Text found.
        found: String,
    },
}

/// Token expected in a JSON text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExpectedToken {
    /// Object of the whole document.
    Document,
    /// Value.
    Value,
    /// Key, after a comma.
    Key,
    /// Key or the end of the object.
    KeyOrEnd,
    /// Colon after a key.
    Colon,
    /// Comma or the end of the array.
    CommaOrBracket,
    /// Comma or the end of the object.
    CommaOrBrace,
    /// Closing quote of a string.
    Quote,
}

impl fmt::Display for ExpectedToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Document => "a JSON object, starting with \"{\"",
            Self::Value => "a value: an object, an array, a string, a number, true, false or null",
            Self::Key => "a key in double quotes",
            Self::KeyOrEnd => "a key in double quotes, or \"}\"",
            Self::Colon => "\":\" after the key",
            Self::CommaOrBracket => "\",\" or \"]\" before it",
            Self::CommaOrBrace => "\",\" or \"}\" before it",
            Self::Quote => "the closing quote of a string",
        })
    }
}

/// Text on one line, without the escapes of quotes and backslashes.
fn shown(found: &str) -> String {
    one_line(found).replace("\\\"", "\"").replace("\\\\", "\\")
}
