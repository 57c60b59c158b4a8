//! The source of measurements: a file, or bytes.

use std::borrow::Cow;
use std::io::{BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use crate::error::excerpt;
use crate::{FilePosition, MeasureError};

/// A stream that measurements can be read from.
pub trait ByteStream: Read + Seek + Send {}

impl<T: Read + Seek + Send> ByteStream for T {}

/// A stream with its name, length and position.
pub(crate) struct Source<'a> {
    name: Arc<str>,
    inner: BufReader<Box<dyn ByteStream + 'a>>,
    length: u64,
    position: Position,
}

/// A position in a source.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Position {
    offset: u64,
    /// Number of the last line read as text.
    line: u64,
}

/// Longest line of a text; a row of 10 000 channels has some 200 kB.
pub(crate) const LONGEST_LINE: u64 = 1 << 20;

impl<'a> Source<'a> {
    pub(crate) fn open(path: &Path) -> Result<Self, MeasureError> {
        let name = path.display().to_string();
        let io = |source| MeasureError::Io { file: name.clone(), source };
        let file = std::fs::File::open(path).map_err(io)?;
        if file.metadata().map_err(io)?.is_dir() {
            return Err(io(std::io::Error::from(std::io::ErrorKind::IsADirectory)));
        }
        Self::new(&name, Box::new(file))
    }

    pub(crate) fn new(
        name: &str,
        mut stream: Box<dyn ByteStream + 'a>,
    ) -> Result<Self, MeasureError> {
        let io = |source| MeasureError::Io { file: name.to_owned(), source };
        let length = stream.seek(SeekFrom::End(0)).map_err(io)?;
        stream.rewind().map_err(io)?;
        let inner = BufReader::with_capacity(1 << 16, stream);
        Ok(Self { name: name.into(), inner, length, position: Position::default() })
    }

    /// The source, or, if it is text in UTF-16, its text in UTF-8.
    ///
    /// UTF-16 has a byte order mark, or nothing but ASCII at the start.
    pub(crate) fn decoded(mut self) -> Result<Self, MeasureError> {
        let mut start = [0; 256];
        let length = self.peek(&mut start)?;
        let start = &start[..length & !1];
        let ascii = |high: usize| {
            let (pairs, _) = start.as_chunks::<2>();
            !pairs.is_empty() && pairs.iter().all(|pair| pair[high] == 0 && is_text(pair[1 - high]))
        };
        let little = start.starts_with(b"\xff\xfe") || ascii(1);
        if !little && !start.starts_with(b"\xfe\xff") && !ascii(0) {
            return Ok(self);
        }
        let mut bytes = Vec::new();
        self.inner.read_to_end(&mut bytes).map_err(|source| self.io(source))?;
        let (pairs, _) = bytes.as_chunks::<2>();
        let unit = |pair: &[u8; 2]| {
            if little { u16::from_le_bytes(*pair) } else { u16::from_be_bytes(*pair) }
        };
        let characters = char::decode_utf16(pairs.iter().map(unit));
        let text: String = characters.map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
        Self::new(&self.name, Box::new(Cursor::new(text.into_bytes())))
    }

    /// The stream, at any position.
    pub(crate) fn into_stream(self) -> Box<dyn ByteStream + 'a> {
        self.inner.into_inner()
    }

    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Length in bytes.
    pub(crate) fn len(&self) -> u64 {
        self.length
    }

    /// Position in bytes.
    pub(crate) fn position(&self) -> u64 {
        self.position.offset
    }

    /// Position in bytes and lines.
    pub(crate) fn mark(&self) -> Position {
        self.position
    }

    /// Continues at a position of [`Source::mark`].
    pub(crate) fn resume(&mut self, position: Position) -> Result<(), MeasureError> {
        self.position.line = position.line;
        self.seek_to(position.offset)
    }

    /// Moves to the line after line `number`, at `offset` bytes.
    pub(crate) fn skip_to_line(&mut self, number: u64, offset: u64) -> Result<(), MeasureError> {
        self.resume(Position { offset, line: number })
    }

    /// The last line read as text.
    pub(crate) fn line_place(&self) -> FilePosition {
        FilePosition::Line(self.position.line)
    }

    pub(crate) fn place(&self) -> FilePosition {
        FilePosition::Offset(self.position.offset)
    }

    /// Remaining bytes.
    pub(crate) fn remaining(&self) -> u64 {
        self.length.saturating_sub(self.position.offset)
    }

    pub(crate) fn seek_to(&mut self, position: u64) -> Result<(), MeasureError> {
        let jump = i64::try_from(i128::from(position) - i128::from(self.position.offset));
        let result = match jump {
            Ok(jump) => self.inner.seek_relative(jump),
            Err(_) => self.inner.seek(SeekFrom::Start(position)).map(|_| ()),
        };
        result.map_err(|source| self.io(source))?;
        self.position.offset = position;
        Ok(())
    }

    /// Fills `buffer`, or reports the missing bytes.
    pub(crate) fn read_exact(
        &mut self,
        buffer: &mut [u8],
        quantity: &'static str,
    ) -> Result<(), MeasureError> {
        self.need(buffer.len() as u64, quantity)?;
        self.inner.read_exact(buffer).map_err(|source| self.io(source))?;
        self.position.offset += buffer.len() as u64;
        Ok(())
    }

    /// Rejects content longer than the rest of the file, before memory is allocated.
    pub(crate) fn need(&self, bytes: u64, quantity: &'static str) -> Result<(), MeasureError> {
        let available = self.remaining();
        if bytes <= available {
            return Ok(());
        }
        Err(MeasureError::Truncated {
            file: self.name.to_string(),
            place: self.place(),
            quantity,
            needed: bytes,
            available,
        })
    }

    /// Reads into `buffer` as far as possible without changing the position.
    pub(crate) fn peek(&mut self, buffer: &mut [u8]) -> Result<usize, MeasureError> {
        let start = self.position.offset;
        let length = buffer.len().min(usize::try_from(self.remaining()).unwrap_or(usize::MAX));
        self.read_exact(&mut buffer[..length], "the start")?;
        self.seek_to(start)?;
        Ok(length)
    }

    /// Reads the next line into `line`, without its end; false at the end of the file.
    pub(crate) fn read_line(&mut self, line: &mut Vec<u8>) -> Result<bool, MeasureError> {
        line.clear();
        self.position.line += 1;
        let mut limited = (&mut self.inner).take(LONGEST_LINE + 1);
        let read = limited.read_until(b'\n', line);
        let read = read.map_err(|source| self.io(source))? as u64;
        self.position.offset += read;
        if read > LONGEST_LINE && line.last() != Some(&b'\n') {
            return Err(self.malformed(
                self.line_place(),
                "a line",
                &format!("longer than {LONGEST_LINE} bytes"),
                "shorter lines of text",
            ));
        }
        if line.last() == Some(&b'\n') {
            line.pop();
        }
        if line.last() == Some(&b'\r') {
            line.pop();
        }
        Ok(read > 0)
    }

    pub(crate) fn io(&self, source: std::io::Error) -> MeasureError {
        MeasureError::Io { file: self.name.to_string(), source }
    }

    /// The error of content that violates the format.
    pub(crate) fn malformed(
        &self,
        place: FilePosition,
        quantity: &'static str,
        found: &str,
        expected: impl Into<String>,
    ) -> MeasureError {
        MeasureError::malformed(&self.name, place, quantity, excerpt(found), expected)
    }
}

impl Read for Source<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.inner.read(buffer)?;
        self.position.offset += read as u64;
        Ok(read)
    }
}

impl Seek for Source<'_> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::Current(jump) => self.position.offset.checked_add_signed(jump),
            SeekFrom::End(jump) => self.length.checked_add_signed(jump),
        };
        let position = position.ok_or(std::io::ErrorKind::InvalidInput)?;
        self.seek_to(position).map_err(|error| match error {
            MeasureError::Io { source, .. } => source,
            _ => std::io::ErrorKind::InvalidInput.into(),
        })?;
        Ok(position)
    }
}

/// True for a byte of printed ASCII, or of a blank or a line break.
fn is_text(byte: u8) -> bool {
    matches!(byte, b'\t' | b'\n' | b'\r' | 0x20..0x7f)
}

/// The text of bytes as UTF-8, else as Latin-1; true for the latter.
pub(crate) fn decode_text(bytes: &[u8]) -> (Cow<'_, str>, bool) {
    match std::str::from_utf8(bytes) {
        Ok(text) => (Cow::Borrowed(text), false),
        Err(_) => (Cow::Owned(bytes.iter().map(|byte| char::from(*byte)).collect()), true),
    }
}
