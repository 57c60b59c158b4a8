//! Data elements: a tag of type and length, the data, padding to eight bytes.

use std::io::Read;

use crate::number::Endian;
use crate::{FilePosition, MeasureError};

/// An error in an element, without its position.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ElementFault {
    /// Content that violates the format.
    #[error("{quantity} is {found}; expected {expected}")]
    Unexpected { quantity: &'static str, found: String, expected: &'static str },
    /// The stream ended or could not be decompressed.
    #[error(transparent)]
    Stream(#[from] std::io::Error),
    /// An error with its position.
    #[error(transparent)]
    Placed(#[from] MeasureError),
}

impl ElementFault {
    pub(crate) fn unexpected(
        quantity: &'static str,
        found: impl std::fmt::Display,
        expected: &'static str,
    ) -> Self {
        Self::Unexpected { quantity, found: found.to_string(), expected }
    }

    /// The error of an element at a position.
    pub(crate) fn at(self, file: &str, place: FilePosition) -> MeasureError {
        let (quantity, found, expected) = match self {
            Self::Placed(error) => return error,
            Self::Unexpected { quantity, found, expected } => (quantity, found, expected),
            Self::Stream(error) => ("an element", error.to_string(), "the length in its tag"),
        };
        MeasureError::malformed(file, place, quantity, found, expected)
    }
}

/// The tag of an element.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tag {
    pub(crate) kind: u32,
    pub(crate) length: u32,
    /// Data of a small element, contained in the tag.
    small: Option<[u8; 4]>,
}

impl Tag {
    /// The tag of eight bytes; none if a small element has more than four.
    pub(crate) fn parse(bytes: [u8; 8], endian: Endian) -> Option<Self> {
        let [a, b, c, d, data @ ..] = bytes;
        let first = endian.u32([a, b, c, d]);
        if first >> 16 == 0 {
            return Some(Self { kind: first, length: endian.u32(data), small: None });
        }
        let length = first >> 16;
        (length <= 4).then_some(Self { kind: first & 0xffff, length, small: Some(data) })
    }

    pub(crate) fn is_small(&self) -> bool {
        self.small.is_some()
    }
}

/// A sequence of elements of a given length.
pub(crate) struct Elements<R> {
    reader: R,
    pub(crate) endian: Endian,
    /// Remaining bytes, by the tag of the enclosing element.
    pub(crate) left: u64,
}

impl<R: Read> Elements<R> {
    pub(crate) fn new(reader: R, endian: Endian, length: u64) -> Self {
        Self { reader, endian, left: length }
    }

    /// The tag of the next element.
    pub(crate) fn tag(&mut self) -> Result<Tag, ElementFault> {
        let mut bytes = [0; 8];
        self.fill(&mut bytes)?;
        let tag = Tag::parse(bytes, self.endian);
        let tag = tag.ok_or_else(|| {
            let expected = "at most 4 bytes in a small element";
            ElementFault::unexpected("a tag", format!("{bytes:02x?}"), expected)
        })?;
        if !tag.is_small() && u64::from(tag.length) > self.left {
            let found = format!("{} bytes", tag.length);
            let expected = "at most the rest of the enclosing element";
            return Err(ElementFault::unexpected("an element's length", found, expected));
        }
        Ok(tag)
    }

    /// The data of the element of `tag`, of at most `most` bytes.
    pub(crate) fn bytes(&mut self, tag: Tag, most: u32) -> Result<Vec<u8>, ElementFault> {
        if tag.length > most {
            let found = format!("{} bytes", tag.length);
            return Err(ElementFault::unexpected("a small array", found, "a shorter array"));
        }
        if let Some(small) = tag.small {
            return Ok(small[..tag.length as usize].to_vec());
        }
        let mut bytes = vec![0; tag.length as usize];
        self.fill(&mut bytes)?;
        self.skip_padding(tag)?;
        Ok(bytes)
    }

    /// Calls `read` with a reader of exactly the data of `tag`, and skips the rest.
    pub(crate) fn with_data<T>(
        &mut self,
        tag: Tag,
        read: impl FnOnce(&mut dyn Read) -> std::io::Result<T>,
    ) -> Result<T, ElementFault> {
        if let Some(small) = tag.small {
            return Ok(read(&mut &small[..tag.length as usize])?);
        }
        let length = u64::from(tag.length);
        self.left -= length;
        let mut data = (&mut self.reader).take(length);
        let value = read(&mut data)?;
        let copied = std::io::copy(&mut data, &mut std::io::sink())?;
        if data.limit() > 0 && copied < length {
            return Err(std::io::Error::from(std::io::ErrorKind::UnexpectedEof).into());
        }
        self.skip_padding(tag)?;
        Ok(value)
    }

    /// Skips all but the last `left` bytes.
    pub(crate) fn skip_to(&mut self, left: u64) -> Result<(), ElementFault> {
        let Some(length) = self.left.checked_sub(left) else {
            let (found, expected) = ("longer than its tag", "the length in its tag");
            return Err(ElementFault::unexpected("a field", found, expected));
        };
        let mut passed = (&mut self.reader).take(length);
        if std::io::copy(&mut passed, &mut std::io::sink())? < length {
            return Err(std::io::Error::from(std::io::ErrorKind::UnexpectedEof).into());
        }
        self.left = left;
        Ok(())
    }

    /// Skips the padding to a multiple of eight bytes, which may be missing at the end.
    fn skip_padding(&mut self, tag: Tag) -> Result<(), ElementFault> {
        let padding = u64::from(tag.length).wrapping_neg() % 8;
        let mut rest = [0; 8];
        let padding = padding.min(self.left) as usize;
        self.fill(&mut rest[..padding])
    }

    fn fill(&mut self, buffer: &mut [u8]) -> Result<(), ElementFault> {
        if buffer.len() as u64 > self.left {
            let found = format!("{} bytes left", self.left);
            return Err(ElementFault::unexpected("an element", found, "the length in its tag"));
        }
        self.reader.read_exact(buffer)?;
        self.left -= buffer.len() as u64;
        Ok(())
    }
}
