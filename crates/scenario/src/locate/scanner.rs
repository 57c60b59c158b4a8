//! Recursive scan of a JSON text, which builds no values.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::ops::Range;

use super::syntax::{ExpectedToken, SyntaxError, SyntaxFault};
use crate::pointer;

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

/// Scans the text, as `locate` does.
pub(super) fn scan(text: &str, wanted: &BTreeSet<&str>) -> Result<Places, SyntaxError> {
    let mut scanner =
        Scanner { text, at: 0, pointer: String::new(), wanted, places: Places::default() };
    scanner.value(None, 0)?;
    match scanner.word() {
        None => Ok(scanner.places),
        Some(word) => Err(scanner.quoting(word, SyntaxFault::TrailingText)),
    }
}

struct Scanner<'a> {
    text: &'a str,
    at: usize,
    /// Pointer to the value being scanned.
    pointer: String,
    wanted: &'a BTreeSet<&'a str>,
    places: Places,
}

type Scanned<T = ()> = Result<T, SyntaxError>;

impl Scanner<'_> {
    fn value(&mut self, key: Option<Range<usize>>, depth: usize) -> Scanned {
        self.skip_space();
        let start = self.at;
        match self.peek() {
            Some('{' | '[') if depth == MAX_NESTING => {
                return Err(self.error(start..start + 1, SyntaxFault::TooDeep(MAX_NESTING)));
            }
            Some('{') => self.object(depth)?,
            Some('[') => self.array(depth)?,
            Some('"') => drop(self.string()?),
            _ => self.scalar()?,
        }
        if self.wanted.contains(self.pointer.as_str()) {
            let value = start..self.at;
            self.places.found.insert(self.pointer.clone(), Place { key, value });
        }
        Ok(())
    }

    fn object(&mut self, depth: usize) -> Scanned {
        self.at += 1;
        self.skip_space();
        if self.eat('}') {
            return Ok(());
        }
        let mut keys = HashSet::new();
        let mut expected = ExpectedToken::KeyOrEnd;
        loop {
            self.skip_space();
            let start = self.at;
            if self.peek() != Some('"') {
                return Err(self.decimal_comma().unwrap_or_else(|| self.unexpected(expected)));
            }
            let key = self.string()?;
            let span = start..self.at;
            self.skip_space();
            if !self.eat(':') {
                return Err(self.unexpected(ExpectedToken::Colon));
            }
            let parent = self.enter(&pointer::escape(&key));
            if !keys.insert(key) {
                self.places.repeated.push((self.pointer.clone(), span.clone()));
            }
            self.value(Some(span), depth + 1)?;
            self.pointer.truncate(parent);
            self.skip_space();
            if self.eat('}') {
                return Ok(());
            }
            self.comma('}', ExpectedToken::CommaOrBrace)?;
            expected = ExpectedToken::Key;
        }
    }

    fn array(&mut self, depth: usize) -> Scanned {
        self.at += 1;
        self.skip_space();
        if self.eat(']') {
            return Ok(());
        }
        for index in 0_usize.. {
            let parent = self.enter(&index.to_string());
            self.value(None, depth + 1)?;
            self.pointer.truncate(parent);
            self.skip_space();
            if self.eat(']') {
                break;
            }
            self.comma(']', ExpectedToken::CommaOrBracket)?;
        }
        Ok(())
    }

    /// Reads a comma that is not followed by `close`.
    fn comma(&mut self, close: char, expected: ExpectedToken) -> Scanned {
        let start = self.at;
        if !self.eat(',') {
            return Err(self.unexpected(expected));
        }
        self.skip_space();
        if self.peek() == Some(close) {
            return Err(self.error(start..start + 1, SyntaxFault::TrailingComma(close)));
        }
        Ok(())
    }

    /// Error of a decimal comma: digits in place of a key, after digits and a comma.
    fn decimal_comma(&self) -> Option<SyntaxError> {
        let is_number = |character: char| character.is_ascii_digit() || "-+.eE".contains(character);
        let (before, rest) = (self.text.get(..self.at)?, self.text.get(self.at..)?);
        let whole = before.strip_suffix(',')?;
        let start = whole.trim_end_matches(is_number).len();
        let end = self.at + rest.len() - rest.trim_start_matches(is_number).len();
        let decimals = start < whole.len() && end > self.at;
        decimals.then(|| self.quoting(start..end, SyntaxFault::DecimalComma))
    }

    /// Reads a string, and returns it unescaped.
    fn string(&mut self) -> Scanned<String> {
        let start = self.at;
        self.at += 1;
        loop {
            match self.peek() {
                None => return Err(self.unexpected(ExpectedToken::Quote)),
                Some('"') => break,
                Some('\\') => self.escape()?,
                Some(character) if character < ' ' => {
                    let span = self.at..self.at + 1;
                    return Err(self.error(span, SyntaxFault::ControlCharacter(character)));
                }
                Some(character) => self.at += character.len_utf8(),
            }
        }
        self.at += 1;
        let quoted = self.text.get(start..self.at).unwrap_or_default();
        serde_json::from_str(quoted).map_err(|_| {
            let from = quoted.find('\\').map_or(start, |escape| start + escape);
            self.quoting(from..self.at, SyntaxFault::BadEscape)
        })
    }

    /// Reads a backslash and the character after it.
    fn escape(&mut self) -> Scanned {
        let start = self.at;
        self.at += 1;
        let escaped = self.peek();
        self.at += escaped.map_or(0, char::len_utf8);
        match escaped {
            Some('"' | '\\' | '/' | 'b' | 'f' | 'n' | 'r' | 't' | 'u') | None => Ok(()),
            Some(_) => Err(self.quoting(start..self.at, SyntaxFault::BadEscape)),
        }
    }

    /// Reads a number, `true`, `false` or `null`.
    fn scalar(&mut self) -> Scanned {
        let expected =
            if self.pointer.is_empty() { ExpectedToken::Document } else { ExpectedToken::Value };
        let Some(span) = self.word() else { return Err(self.unexpected(expected)) };
        let word = self.text.get(span.clone()).unwrap_or_default();
        let bare = word.trim_start_matches(['-', '+']).to_ascii_lowercase();
        if matches!(bare.as_str(), "nan" | "inf" | "infinity") {
            return Err(self.quoting(span, SyntaxFault::NotFinite));
        }
        if word.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first)) {
            match word.parse::<f64>() {
                Ok(value) if value.is_infinite() => {
                    return Err(self.quoting(span, SyntaxFault::NumberTooLarge));
                }
                _ if serde_json::from_str::<f64>(word).is_err() => {
                    return Err(self.quoting(span, SyntaxFault::BadNumber));
                }
                _ => {}
            }
        } else if !matches!(word, "true" | "false" | "null") {
            return Err(self.unexpected(expected));
        }
        self.at = span.end;
        Ok(())
    }

    /// Bytes of the next word, up to white space or punctuation and at least one character; `None`
    /// at the end of the text.
    fn word(&mut self) -> Option<Range<usize>> {
        self.skip_space();
        let rest = self.text.get(self.at..)?;
        let first = rest.chars().next()?;
        let stops = |character: char| character.is_whitespace() || ",:[]{}\"'".contains(character);
        let length = rest.find(stops).unwrap_or(rest.len()).max(first.len_utf8());
        Some(self.at..self.at + length)
    }

    fn unexpected(&mut self, expected: ExpectedToken) -> SyntaxError {
        let Some(span) = self.word() else {
            let end = self.text.trim_end().len();
            return self.error(end..end, SyntaxFault::Ended(expected));
        };
        let found = self.text.get(span.clone()).unwrap_or_default();
        if found.starts_with("//") || found.starts_with("/*") || found.starts_with('#') {
            return self.error(span, SyntaxFault::Comment);
        }
        match found.chars().next() {
            Some(quote @ ('\'' | '`' | '“' | '”' | '‘' | '’')) => {
                self.error(span, SyntaxFault::OtherQuotes(quote))
            }
            Some('"') => {
                // The whole string is quoted, not only its quote.
                let quoted = self.text.get(span.end..).unwrap_or_default();
                let length = quoted.find(['"', '\n']).map_or(0, |end| end + 1);
                let span = span.start..span.end + length;
                self.quoting(span, |found| SyntaxFault::Unexpected { found, expected })
            }
            _ => self.quoting(span, |found| SyntaxFault::Unexpected { found, expected }),
        }
    }

    /// Error that quotes the text of its span.
    fn quoting(
        &self,
        span: Range<usize>,
        fault: impl FnOnce(String) -> SyntaxFault,
    ) -> SyntaxError {
        let found = self.text.get(span.clone()).unwrap_or_default();
        self.error(span, fault(found.chars().take(80).collect()))
    }

    fn error(&self, span: Range<usize>, fault: SyntaxFault) -> SyntaxError {
        let (line, column) = line_and_column(self.text, span.start);
        SyntaxError { line, column, span, fault }
    }

    /// Descends into a part; returns the length of the pointer to its parent.
    fn enter(&mut self, part: &str) -> usize {
        let parent = self.pointer.len();
        self.pointer.push('/');
        self.pointer.push_str(part);
        parent
    }

    fn peek(&self) -> Option<char> {
        self.text.get(self.at..).and_then(|rest| rest.chars().next())
    }

    fn eat(&mut self, character: char) -> bool {
        let there = self.peek() == Some(character);
        self.at += if there { character.len_utf8() } else { 0 };
        there
    }

    fn skip_space(&mut self) {
        while matches!(self.peek(), Some(' ' | '\t' | '\n' | '\r')) {
            self.at += 1;
        }
    }
}

/// Line and column of a byte of the text, both from 1; columns count characters.
pub(super) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let column = before.get(start..).map_or(0, |line| line.chars().count()) + 1;
    (line, column)
}
