//! Lead-ins of segments, and the fields of lead-ins and metadata.

use crate::MeasureError;
use crate::number::Endian;
use crate::source::Source;
use crate::source::decode_text;

/// Longest path or property.
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

    /// A string after its length.
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
            Err(error) => decode_text(error.as_bytes()).0.into_owned(),
        })
    }

    /// Skips `length` bytes.
    pub(crate) fn skip(&mut self, length: u64, quantity: &'static str) -> Result<(), MeasureError> {
        self.source.need(length, quantity)?;
        self.source.seek_to(self.source.position() + length)
    }
}

/// Bytes of a lead-in.
pub(crate) const LENGTH: u64 = 28;

const METADATA: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;

/// Content and positions of a segment.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeadIn {
    pub(crate) endian: Endian,
    contents: u32,
    /// Start of the raw data.
    pub(crate) data: u64,
    /// End of the segment; that of the file for a segment that was not closed.
    pub(crate) end: u64,
    /// True for a segment that was not closed by its writer.
    pub(crate) open: bool,
}

impl LeadIn {
    /// Reads the lead-in at the current position.
    pub(crate) fn read(source: &mut Source<'_>) -> Result<Self, MeasureError> {
        let (start, place) = (source.position(), source.place());
        source.need(LENGTH, "the lead-in of a segment")?;
        let mut tag = [0; 4];
        source.read_exact(&mut tag, "the lead-in of a segment")?;
        if &tag != b"TDSm" {
            let found = String::from_utf8_lossy(&tag);
            return Err(source.malformed(place, "the tag of a segment", &found, "`TDSm`"));
        }
        // The contents are always little endian.
        let contents = Fields { source, endian: Endian::Little }.u32("the contents")?;
        if contents & DAQMX != 0 {
            return Err(daqmx(source));
        }
        let endian = if contents & BIG_ENDIAN != 0 { Endian::Big } else { Endian::Little };
        let mut fields = Fields { source, endian };
        let version_place = fields.source.place();
        let version = fields.u32("the version")?;
        if !matches!(version, 4712 | 4713) {
            let found = version.to_string();
            let expected = "4712 (TDMS 1.0) or 4713 (TDMS 2.0)";
            return Err(source.malformed(version_place, "the version", &found, expected));
        }
        let next = fields.u64("the length of a segment")?;
        let raw = fields.u64("the length of the metadata")?;
        let (open, rest) = (next == u64::MAX, source.len() - start - LENGTH);
        if !open && next > rest {
            source.need(next, "a segment")?;
        }
        let length = if open { rest } else { next };
        if raw > length && !open {
            let expected = format!("at most the {length} bytes of its segment");
            let found = raw.to_string();
            return Err(source.malformed(place, "the length of the metadata", &found, expected));
        }
        Ok(Self {
            endian,
            contents,
            data: (start + LENGTH).saturating_add(raw),
            end: start + LENGTH + length,
            open,
        })
    }

    pub(crate) fn has_metadata(&self) -> bool {
        self.contents & METADATA != 0
    }

    /// True if the list of objects does not continue that of the segment before.
    pub(crate) fn starts_list(&self) -> bool {
        self.contents & NEW_LIST != 0
    }

    pub(crate) fn has_raw_data(&self) -> bool {
        self.contents & RAW_DATA != 0
    }

    pub(crate) fn is_interleaved(&self) -> bool {
        self.contents & INTERLEAVED != 0
    }
}

/// The error of raw data of the driver.
pub(crate) fn daqmx(source: &Source<'_>) -> MeasureError {
    MeasureError::Unsupported {
        file: source.name().to_owned(),
        feature: "a TDMS file with raw data of NI-DAQmx",
        instead: "save it from LabVIEW or DIAdem as scaled TDMS, or as UFF or CSV",
    }
}
