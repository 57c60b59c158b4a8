//! Lead-ins of segments.

use std::io::{Read, Seek};

use crate::tdms_file::TdmsError;
use crate::tdms_file::byte_reader::ByteReader;
use crate::tdms_file::data_type::Endian;

/// Bytes of a lead-in.
pub(crate) const LENGTH: u64 = 28;

/// Flags of the contents.
pub(crate) const METADATA: u32 = 1 << 1;
/// The list of objects does not continue the list of the previous segment.
pub(crate) const NEW_LIST: u32 = 1 << 2;
pub(crate) const RAW_DATA: u32 = 1 << 3;
pub(crate) const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;

/// Content and positions of a segment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeadIn {
    pub(crate) endian: Endian,
    contents: u32,
    /// Start of the raw data.
    pub(crate) data: u64,
    /// End of the segment; the end of the file for a segment that was not closed.
    pub(crate) end: u64,
    /// True for a segment that was not closed by its writer.
    pub(crate) open: bool,
}

impl LeadIn {
    /// Reads the lead-in at the current position, and sets the byte order of `bytes`.
    pub(crate) fn read(bytes: &mut ByteReader<impl Read + Seek>) -> Result<Self, TdmsError> {
        let start = bytes.position();
        bytes.need(LENGTH, "the lead-in of a segment")?;
        let mut tag = [0; 4];
        bytes.read_exact(&mut tag, "the lead-in of a segment")?;
        if &tag != b"TDSm" {
            let found = String::from_utf8_lossy(&tag);
            return Err(TdmsError::malformed(start, "the tag of a segment", &found, "`TDSm`"));
        }
        // The contents are always little endian.
        bytes.endian = Endian::Little;
        let contents = bytes.u32("the contents")?;
        if contents & DAQMX != 0 {
            return Err(TdmsError::RawDaqmx);
        }
        bytes.endian = if contents & BIG_ENDIAN != 0 { Endian::Big } else { Endian::Little };
        let (version_offset, version) = (bytes.position(), bytes.u32("the version")?);
        if !matches!(version, 4712 | 4713) {
            let (found, expected) = (version.to_string(), "4712 (TDMS 1.0) or 4713 (TDMS 2.0)");
            return Err(TdmsError::malformed(version_offset, "the version", &found, expected));
        }
        let next = bytes.u64("the length of a segment")?;
        let raw = bytes.u64("the length of the metadata")?;
        let (open, rest) = (next == u64::MAX, bytes.len() - start - LENGTH);
        if !open {
            bytes.need(next, "a segment")?;
        }
        let length = if open { rest } else { next };
        if raw > length && !open {
            let expected = format!("at most the {length} bytes of its segment");
            let quantity = "the length of the metadata";
            return Err(TdmsError::malformed(start, quantity, &raw.to_string(), expected));
        }
        Ok(Self {
            endian: bytes.endian,
            contents,
            data: (start + LENGTH).saturating_add(raw),
            end: start + LENGTH + length,
            open,
        })
    }

    /// True for contents with the given flag.
    pub(crate) fn has(&self, flag: u32) -> bool {
        self.contents & flag != 0
    }
}
