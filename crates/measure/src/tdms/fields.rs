//! Numbers and strings of lead-ins and metadata, in the byte order of their segment.

use crate::number::Endian;
use crate::source::Source;
use crate::{MeasureError, latin1};

/// Longest path or property that is kept.
const LONGEST_TEXT: u32 = 1 << 16;

/// A source read field by field.
pub(crate) struct Fields<'s, 'a> {
    pub(crate) source: &'s mut Source<'a>,
    pub(crate) endian: Endian,
}

impl Fields<'_, '_> {
    fn bytes<const N: usize>(&mut self, quantity: &'static str) -> Result<[u8; N], MeasureError> {
        let mut bytes = [0; N];
        self.source.read_exact(&mut bytes, quantity)?;
        Ok(bytes)
    }

    pub(crate) fn u32(&mut self, quantity: &'static str) -> Result<u32, MeasureError> {
        let bytes = self.bytes(quantity)?;
        Ok(match self.endian {
            Endian::Little => u32::from_le_bytes(bytes),
            Endian::Big => u32::from_be_bytes(bytes),
        })
    }

    pub(crate) fn u64(&mut self, quantity: &'static str) -> Result<u64, MeasureError> {
        let bytes = self.bytes(quantity)?;
        Ok(match self.endian {
            Endian::Little => u64::from_le_bytes(bytes),
            Endian::Big => u64::from_be_bytes(bytes),
        })
    }

    /// A string behind its length.
    pub(crate) fn text(&mut self, quantity: &'static str) -> Result<String, MeasureError> {
        let place = self.source.place();
        let length = self.u32(quantity)?;
        self.source.need(u64::from(length), quantity)?;
        if length > LONGEST_TEXT {
            let expected = format!("at most {LONGEST_TEXT} bytes");
            let found = format!("{length} bytes long");
            return Err(self.source.malformed(place, quantity, &found, expected));
        }
        let mut bytes = vec![0; length as usize];
        self.source.read_exact(&mut bytes, quantity)?;
        Ok(match String::from_utf8(bytes) {
            Ok(text) => text,
            Err(error) => latin1::decode(error.as_bytes()).0.into_owned(),
        })
    }

    /// Passes over `length` bytes.
    pub(crate) fn skip(&mut self, length: u64, quantity: &'static str) -> Result<(), MeasureError> {
        self.source.need(length, quantity)?;
        self.source.seek_to(self.source.position() + length)
    }
}
