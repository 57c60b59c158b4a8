//! Lines of a text file, plain or gzip, and the numbers in them.

use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::error::{MatricesError, Place, excerpt};

/// Longest line.
const LONGEST_LINE: usize = 1 << 20;

/// Most bytes of a decompressed file, as a multiple of its size.
const EXPANSION: u64 = 400;

/// The content of a file, decompressed if its first two bytes are the mark of gzip.
pub(crate) struct Content {
    pub(crate) name: String,
    reader: Box<dyn Read + Send>,
}

impl Content {
    pub(crate) fn open(path: &Path) -> Result<Self, MatricesError> {
        let name = path.display().to_string();
        let io = |source| MatricesError::Io { file: name.clone(), source };
        let file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let reader = unfolded(file, length).map_err(io)?;
        Ok(Self { name, reader })
    }

    pub(crate) fn of_bytes(name: &str, bytes: Vec<u8>) -> Self {
        let length = bytes.len() as u64;
        // Reading from memory does not fail.
        let reader = unfolded(Cursor::new(bytes), length);
        let reader = reader.unwrap_or_else(|_| Box::new(std::io::empty()));
        Self { name: name.to_owned(), reader }
    }

    /// At most `most` bytes from the start.
    pub(crate) fn start(mut self, most: u64) -> Result<Vec<u8>, MatricesError> {
        let mut bytes = Vec::new();
        let read = (&mut self.reader).take(most).read_to_end(&mut bytes);
        read.map_err(|source| MatricesError::Io { file: self.name, source })?;
        Ok(bytes)
    }

    /// All bytes.
    pub(crate) fn bytes(self) -> Result<Vec<u8>, MatricesError> {
        self.start(u64::MAX)
    }
}

fn unfolded(
    mut file: impl Read + Seek + Send + 'static,
    length: u64,
) -> std::io::Result<Box<dyn Read + Send>> {
    let mut mark = Vec::new();
    (&mut file).take(2).read_to_end(&mut mark)?;
    file.rewind()?;
    if mark != [0x1f, 0x8b] {
        return Ok(Box::new(file));
    }
    let left = length.saturating_mul(EXPANSION).max(1 << 20);
    Ok(Box::new(Bounded { reader: MultiGzDecoder::new(file), left }))
}

/// A reader that fails after a number of bytes.
struct Bounded<R> {
    reader: R,
    left: u64,
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.reader.read(buffer)?;
        self.left = self.left.checked_sub(read as u64).ok_or_else(|| {
            std::io::Error::other(format!(
                "decompressed, it has more than {EXPANSION} times its size"
            ))
        })?;
        Ok(read)
    }
}

/// The lines of a text.
pub(crate) struct Lines {
    pub(crate) name: String,
    reader: Box<dyn Read + Send>,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    ended: bool,
    /// Start of the last line returned, in the buffer.
    line_start: usize,
    /// Number of the last line returned.
    pub(crate) line: u64,
    last_length: usize,
    /// True if the last line returned has no line end and is shorter than the line before.
    cut: bool,
}

impl Lines {
    pub(crate) fn new(content: Content) -> Self {
        Self {
            name: content.name,
            reader: content.reader,
            buffer: vec![0; 1 << 18],
            start: 0,
            end: 0,
            ended: false,
            line_start: 0,
            line: 0,
            last_length: 0,
            cut: false,
        }
    }

    /// The next line without its end; none at the end.
    pub(crate) fn next(&mut self) -> Result<Option<&[u8]>, MatricesError> {
        let mut searched = self.start;
        self.line_start = self.start;
        loop {
            let rest = &self.buffer[searched..self.end];
            if let Some(length) = rest.iter().position(|byte| *byte == b'\n') {
                let line = self.start..searched + length;
                self.start = line.end + 1;
                self.line += 1;
                self.last_length = line.len();
                let line = &self.buffer[line];
                return Ok(Some(line.strip_suffix(b"\r").unwrap_or(line)));
            }
            if self.ended {
                let line = self.start..self.end;
                self.start = self.end;
                if line.is_empty() {
                    return Ok(None);
                }
                self.line += 1;
                self.cut = line.len() < self.last_length;
                return Ok(Some(&self.buffer[line]));
            }
            searched = self.end - self.start;
            self.fill()?;
        }
    }

    /// Moves the unread rest to the start of the buffer, and reads more.
    fn fill(&mut self) -> Result<(), MatricesError> {
        self.buffer.copy_within(self.start..self.end, 0);
        (self.start, self.line_start, self.end) = (0, 0, self.end - self.start);
        if self.end == self.buffer.len() {
            if self.end >= LONGEST_LINE {
                self.line += 1;
                let found = format!("a line of more than {LONGEST_LINE} bytes");
                return Err(self.malformed(found, "a text file"));
            }
            self.buffer.resize(2 * self.end, 0);
        }
        let read = self.reader.read(&mut self.buffer[self.end..]);
        let read = read.map_err(|source| MatricesError::Io { file: self.name.clone(), source })?;
        self.end += read;
        self.ended = read == 0;
        Ok(())
    }

    /// Returns the last line once more.
    pub(crate) fn step_back(&mut self) {
        self.start = self.line_start;
        self.line = self.line.saturating_sub(1);
    }

    pub(crate) fn place(&self) -> Place {
        Place::Line(self.line)
    }

    /// The error of the last line.
    pub(crate) fn malformed(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> MatricesError {
        MatricesError::malformed(&self.name, self.place(), found, expected)
    }

    pub(crate) fn ends_early(&self, missing: impl Into<String>) -> MatricesError {
        let (file, place) = (self.name.clone(), self.place());
        MatricesError::EndsEarly { file, place, missing: missing.into() }
    }

    /// Refuses a text whose last line has no line end and is shorter than the line before.
    pub(crate) fn check_end(&self) -> Result<(), MatricesError> {
        if !self.cut {
            return Ok(());
        }
        let missing = "the last line is shorter than the one before and has no line end; if it is whole, add one";
        Err(self.ends_early(missing))
    }
}

/// Fields separated by blanks, tabs and commas.
pub(crate) struct Fields<'a>(pub(crate) &'a [u8]);

impl<'a> Iterator for Fields<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let separates = |byte: &u8| matches!(byte, b' ' | b',' | b'\t' | b'\r');
        let start = self.0.iter().position(|byte| !separates(byte))?;
        let rest = &self.0[start..];
        let length = rest.iter().position(separates).unwrap_or(rest.len());
        let (field, rest) = rest.split_at(length);
        self.0 = rest;
        Some(field)
    }
}

/// A whole number.
pub(crate) fn whole(field: &[u8]) -> Option<i64> {
    let (negative, digits) = match field {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, field),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0_i64;
    for digit in digits {
        value = value * 10 + i64::from(digit.checked_sub(b'0').filter(|digit| *digit < 10)?);
    }
    Some(if negative { -value } else { value })
}

/// A finite number, with the exponent after E or, as in Fortran, D.
pub(crate) fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    let value = match text.parse::<f64>() {
        Ok(value) => value,
        Err(_) => text.replace(['d', 'D'], "e").parse().ok()?,
    };
    value.is_finite().then_some(value)
}

/// The line as found, for a message.
pub(crate) fn found(line: &[u8]) -> String {
    excerpt(line)
}
