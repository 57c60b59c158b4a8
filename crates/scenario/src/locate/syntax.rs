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
    #[error("unexpected end of the text; expected {0}")]
    Ended(ExpectedToken),
    /// Token other than the expected one.
    #[error("found `{}`; expected {expected}", shown(found))]
    Unexpected {
        /// Text found.
        found: String,
        /// Expected token.
        expected: ExpectedToken,
    },
    /// Comma before a closing bracket or brace.
    #[error("a comma before {0:?}; expected another item after it, or no comma")]
    TrailingComma(char),
    /// Comment.
    #[error("JSON has no comments; expected a value, a key or punctuation")]
    Comment,
    /// String in other quotes.
    #[error("found a quote {0}; expected strings and keys in double quotes, \"like this\"")]
    OtherQuotes(char),
    /// Number with a decimal comma.
    #[error("`{}` has a decimal comma; expected a decimal point, as in 0.5", shown(.0))]
    DecimalComma(String),
    /// NaN or infinity.
    #[error("`{}` is not a JSON number; expected a finite number such as 0.5 or 2e5", shown(.0))]
    NotFinite(String),
    /// Malformed number.
    #[error("`{}` is not a JSON number; expected digits as in 12, -0.5 or 2.5e-3", shown(.0))]
    BadNumber(String),
    /// Number above the range of double precision.
    #[error("the number `{}` is too large; expected a magnitude below 1.8e308", shown(.0))]
    NumberTooLarge(String),
    /// Backslash that does not start an escape sequence.
    #[error(
        r#"`{}` is not an escape; expected \\ for a backslash or \" for a quote"#,
        shown(.0)
    )]
    BadEscape(String),
    /// Line break or another control character inside a string.
    #[error(
        "a string contains the control character {0:?}; expected a closing quote before it, or an escape such as \\n"
    )]
    ControlCharacter(char),
    /// Arrays and objects nested too deep.
    #[error("arrays and objects are nested more than {0} deep; expected a scenario object")]
    TooDeep(usize),
    /// Text after the end of the document.
    #[error("found `{}` after the end of the document; expected nothing more", shown(.0))]
    TrailingText(String),
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
