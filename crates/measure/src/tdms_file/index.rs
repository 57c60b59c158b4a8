//! First pass over the lead-ins and metadata of all segments.
//!
//! The metadata of a segment contain changes only. Its channels are those of the list left by the
//! segments before, each with its last description. The
//! samples of the channels in that list follow each other in a chunk; a segment is a sequence of
//! such chunks.
//!
//! The cost is proportional to the length of the file: the list is processed only for a
//! segment with at least one byte for each of its channels.

use std::collections::BTreeMap;
use std::io::{Read, Seek};

use crate::tdms_file::byte_reader::ByteReader;
use crate::tdms_file::data_type::DataType;
use crate::tdms_file::extent::Extent;
use crate::tdms_file::object::RawIndex;
use crate::tdms_file::segment::{INTERLEAVED, LeadIn, METADATA, NEW_LIST, RAW_DATA};
use crate::tdms_file::{TdmsError, TdmsObject, TdmsPath, TdmsProperty};

/// The metadata of all segments.
#[derive(Debug, Default)]
pub(crate) struct TdmsIndex {
    pub(crate) objects: Vec<TdmsObject>,
    pub(crate) by_path: BTreeMap<String, usize>,
    /// Start of a segment that was not closed by its writer.
    pub(crate) cut_off: Option<u64>,
    /// Objects of the current list with samples in a chunk, by their index in it.
    chunk: BTreeMap<usize, usize>,
    /// The current list, by number, and its length.
    list: u64,
    length: usize,
    channels: u64,
}

impl TdmsIndex {
    /// Reads the lead-ins and metadata of all segments.
    pub(crate) fn read(
        bytes: &mut ByteReader<impl Read + Seek>,
        keep: fn(&str) -> bool,
    ) -> Result<Self, TdmsError> {
        let mut index = Self { list: 1, ..Self::default() };
        while bytes.position() < bytes.len() {
            let start = bytes.position();
            let lead = LeadIn::read(bytes)?;
            if lead.open {
                index.cut_off = Some(start);
                if lead.data > lead.end {
                    // The file ends within the metadata: there are no samples.
                    break;
                }
            }
            if lead.has(METADATA) {
                index.metadata(bytes, &lead, keep)?;
            }
            if lead.has(RAW_DATA) {
                index.raw_data(bytes, &lead, start)?;
            }
            // At least the length of a lead-in after the start of the segment.
            bytes.seek_to(lead.end)?;
        }
        Ok(index)
    }

    fn metadata(
        &mut self,
        bytes: &mut ByteReader<impl Read + Seek>,
        lead: &LeadIn,
        keep: fn(&str) -> bool,
    ) -> Result<(), TdmsError> {
        if lead.has(NEW_LIST) {
            self.list += 1;
            self.length = 0;
            self.chunk.clear();
        }
        let count = bytes.u32("the number of objects")?;
        // Length of a path, index and number of properties.
        bytes.need(12 * u64::from(count), "the objects of a segment")?;
        for _ in 0..count {
            let offset = bytes.position();
            let path = bytes.text("the path of an object")?;
            let id = self.object(bytes, path, offset)?;
            self.raw_data_index(bytes, id)?;
            for _ in 0..bytes.u32("the number of properties")? {
                let Some((name, property)) = TdmsProperty::read(bytes, keep)? else {
                    continue;
                };
                let properties = &mut self.objects[id].properties;
                let grown = match properties.get(&name) {
                    Some(known) => property.text_len().saturating_sub(known.text_len()),
                    None => 160 + 2 * name.len() as u64 + property.text_len(),
                };
                bytes.reserve(grown, property.offset, "the properties")?;
                properties.insert(name, property);
            }
        }
        let end = bytes.position();
        if end > lead.data {
            let found = format!("{} bytes too long", end - lead.data);
            let expected = "the length in the lead-in";
            return Err(TdmsError::malformed(end, "the metadata", &found, expected));
        }
        Ok(())
    }

    /// The object of a path, new or known.
    fn object(
        &mut self,
        bytes: &mut ByteReader<impl Read + Seek>,
        text: String,
        offset: u64,
    ) -> Result<usize, TdmsError> {
        if let Some(id) = self.by_path.get(&text) {
            return Ok(*id);
        }
        let Some(path) = TdmsPath::parse(&text) else {
            let expected = "`/`, `/'group'` or `/'group'/'channel'`";
            return Err(TdmsError::malformed(offset, "the path of an object", &text, expected));
        };
        if matches!(path, TdmsPath::Channel(..)) {
            self.channels += 1;
            let most = 256.max(bytes.len() / 128);
            if self.channels > most {
                let (found, quantity) = (self.channels.to_string(), "the number of channels");
                let expected = format!("at most {most} in a file of {} bytes", bytes.len());
                return Err(TdmsError::malformed(bytes.position(), quantity, &found, expected));
            }
        }
        bytes.reserve(600 + 4 * text.len() as u64, offset, "the objects")?;
        self.objects.push(TdmsObject { path, ..TdmsObject::default() });
        self.by_path.insert(text, self.objects.len() - 1);
        Ok(self.objects.len() - 1)
    }

    fn raw_data_index(
        &mut self,
        bytes: &mut ByteReader<impl Read + Seek>,
        id: usize,
    ) -> Result<(), TdmsError> {
        let (offset, quantity) = (bytes.position(), "the raw data index");
        let length = bytes.u32(quantity)?;
        let object = &mut self.objects[id];
        let is_channel = matches!(object.path, TdmsPath::Channel(..));
        match (length, object.index) {
            (u32::MAX, _) => {}
            (0, None) if is_channel => {
                let expected = "a description of its samples, as no segment before gave one";
                return Err(TdmsError::malformed(offset, quantity, "0", expected));
            }
            (0, _) => {}
            _ if !is_channel => {
                let expected = "none (4294967295) for the file and its groups";
                return Err(TdmsError::malformed(offset, quantity, &length.to_string(), expected));
            }
            _ => object.index = Some(RawIndex::read(bytes, length)?),
        }
        if object.list != self.list {
            (object.list, object.place) = (self.list, self.length);
            self.length += 1;
        }
        let has_bytes = object.index.is_some_and(|index| index.values > 0 && index.bytes > 0);
        if length != u32::MAX && has_bytes {
            self.chunk.insert(object.place, id);
        } else {
            self.chunk.remove(&object.place);
        }
        Ok(())
    }

    /// Stores the positions of the samples of the segment at `start`.
    fn raw_data(
        &mut self,
        bytes: &mut ByteReader<impl Read + Seek>,
        lead: &LeadIn,
        start: u64,
    ) -> Result<(), TdmsError> {
        let available = lead.end - lead.data;
        if available == 0 {
            return Ok(());
        }
        let wrong = |found: &str, expected: &str| {
            Err(TdmsError::malformed(lead.data, "the raw data of a segment", found, expected))
        };
        let length = format!("{available} bytes long");
        let (mut row, mut chunk, mut even, mut values) = (0, 0_u64, true, None);
        for id in self.chunk.values() {
            let Some(index) = self.objects[*id].index else { continue };
            chunk = chunk.saturating_add(index.bytes);
            row += index.kind.size();
            even &= matches!(index.kind, DataType::Number(_));
            even &= *values.get_or_insert(index.values) == index.values;
        }
        if chunk == 0 {
            return wrong(&length, "empty: no channel has samples here");
        }
        if lead.has(INTERLEAVED) && !even {
            return wrong("interleaved", "channels of numbers, each with as many samples");
        }
        // A single channel is a row of one, for which chunks make no difference.
        let rows = even && (lead.has(INTERLEAVED) || self.chunk.len() == 1);
        let unit = if rows { row } else { chunk };
        if !available.is_multiple_of(unit) && !lead.open {
            return wrong(&length, &format!("a multiple of {unit} bytes, by its metadata"));
        }
        match available / unit {
            0 => Ok(()),
            count if rows => self.extents(bytes, lead, (row, count * row, 1), Some(count), start),
            count => self.extents(bytes, lead, (0, chunk, count), None, start),
        }
    }

    /// Adds an extent to each channel of the chunk: row, stride and chunks, and
    /// the number of values if it differs from the description.
    fn extents(
        &mut self,
        bytes: &mut ByteReader<impl Read + Seek>,
        lead: &LeadIn,
        (row, stride, chunks): (u64, u64, u64),
        values: Option<u64>,
        offset: u64,
    ) -> Result<(), TdmsError> {
        let mut column = 0;
        for id in self.chunk.values() {
            let object = &mut self.objects[*id];
            let Some(index) = object.index else { continue };
            let DataType::Number(number) = index.kind else {
                object.other_content = index.kind.other_content();
                column += index.bytes;
                continue;
            };
            let (base, endian) = (lead.data, lead.endian);
            let values = values.unwrap_or(index.values);
            let extent = Extent { base, column, row, stride, chunks, values, number, endian };
            object.samples += values * chunks;
            if !object.extents.last_mut().is_some_and(|last| last.carry_on(&extent)) {
                // Lists grow by doubling, with both copies in memory.
                bytes.reserve(3 * size_of::<Extent>() as u64, offset, "the segments")?;
                object.extents.push(extent);
            }
            column += if row > 0 { number.size() } else { index.bytes };
        }
        Ok(())
    }
}
