//! The stream of a file, read field by field within limits of length and memory.

use std::io::{BufReader, Read, Seek, SeekFrom};

use crate::tdms_file::TdmsError;
use crate::tdms_file::data_type::{Endian, NumberType};

/// Longest path or property.
const LONGEST_TEXT: u32 = 1 << 16;

/// A stream with its length, position and byte order, and the memory of its content.
#[derive(Debug)]
pub(crate) struct ByteReader<R> {
    inner: BufReader<R>,
    length: u64,
    position: u64,
    pub(crate) endian: Endian,
    limit: u64,
    /// Memory reserved.
    pub(crate) reserved: u64,
}

impl<R: Read + Seek> ByteReader<R> {
    /// A reader from the start of `stream`, with `expansion` bytes of memory per byte of the stream.
    pub(crate) fn new(mut stream: R, expansion: u64) -> Result<Self, TdmsError> {
        let length = stream.seek(SeekFrom::End(0))?;
        stream.rewind()?;
        Ok(Self {
            inner: BufReader::with_capacity(1 << 16, stream),
            length,
            position: 0,
            endian: Endian::Little,
            limit: length.saturating_mul(expansion).max(1 << 20),
            reserved: 0,
        })
    }

    pub(crate) fn len(&self) -> u64 {
        self.length
    }

    pub(crate) fn position(&self) -> u64 {
        self.position
    }

    pub(crate) fn seek_to(&mut self, position: u64) -> Result<(), TdmsError> {
        match i64::try_from(i128::from(position) - i128::from(self.position)) {
            Ok(jump) => self.inner.seek_relative(jump)?,
            Err(_) => self.inner.seek(SeekFrom::Start(position)).map(drop)?,
        }
        self.position = position;
        Ok(())
    }

    /// Rejects content longer than the rest of the file, before memory is allocated.
    pub(crate) fn need(&self, needed: u64, quantity: &'static str) -> Result<(), TdmsError> {
        let (offset, available) = (self.position, self.length.saturating_sub(self.position));
        if needed <= available {
            return Ok(());
        }
        Err(TdmsError::Truncated { offset, quantity, needed, available })
    }

    /// Accounts for `bytes` of memory, or rejects them.
    pub(crate) fn reserve(
        &mut self,
        bytes: u64,
        offset: u64,
        quantity: &'static str,
    ) -> Result<(), TdmsError> {
        self.reserved = self.reserved.saturating_add(bytes);
        let (needed, limit) = (self.reserved, self.limit);
        if needed <= limit {
            return Ok(());
        }
        Err(TdmsError::TooLarge { offset, quantity, needed, limit })
    }

    /// Fills `buffer`, or reports the missing bytes.
    pub(crate) fn read_exact(
        &mut self,
        buffer: &mut [u8],
        quantity: &'static str,
    ) -> Result<(), TdmsError> {
        self.need(buffer.len() as u64, quantity)?;
        self.inner.read_exact(buffer)?;
        self.position += buffer.len() as u64;
        Ok(())
    }

    /// Skips `length` bytes.
    pub(crate) fn skip(&mut self, length: u64, quantity: &'static str) -> Result<(), TdmsError> {
        self.need(length, quantity)?;
        self.seek_to(self.position + length)
    }

    fn array<const N: usize>(&mut self, quantity: &'static str) -> Result<[u8; N], TdmsError> {
        let mut bytes = [0; N];
        self.read_exact(&mut bytes, quantity)?;
        if self.endian == Endian::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub(crate) fn u32(&mut self, quantity: &'static str) -> Result<u32, TdmsError> {
        self.array(quantity).map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self, quantity: &'static str) -> Result<u64, TdmsError> {
        self.array(quantity).map(u64::from_le_bytes)
    }

    /// A string after its length, in UTF-8, else in Latin-1.
    pub(crate) fn text(&mut self, quantity: &'static str) -> Result<String, TdmsError> {
        let offset = self.position;
        let length = self.u32(quantity)?;
        self.need(u64::from(length), quantity)?;
        if length > LONGEST_TEXT {
            let expected = format!("at most {LONGEST_TEXT} bytes");
            let found = format!("{length} bytes long");
            return Err(TdmsError::malformed(offset, quantity, &found, expected));
        }
        let mut bytes = vec![0; length as usize];
        self.read_exact(&mut bytes, quantity)?;
        let latin_1 = |bytes: &[u8]| bytes.iter().map(|byte| char::from(*byte)).collect();
        Ok(String::from_utf8(bytes).unwrap_or_else(|error| latin_1(error.as_bytes())))
    }

    /// Appends `count` numbers to `values`, in pieces.
    pub(crate) fn numbers(
        &mut self,
        (number, endian): (NumberType, Endian),
        count: u64,
        values: &mut Vec<f64>,
        quantity: &'static str,
    ) -> Result<(), TdmsError> {
        self.need(count.saturating_mul(number.size()), quantity)?;
        let mut piece = [0; 1 << 13];
        let per_piece = piece.len() as u64 / number.size();
        let mut left = count;
        while left > 0 {
            let now = left.min(per_piece);
            let bytes = &mut piece[..(now * number.size()) as usize];
            self.read_exact(bytes, quantity)?;
            number.decode(endian, bytes, values);
            left -= now;
        }
        Ok(())
    }
}
