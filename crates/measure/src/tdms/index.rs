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

use crate::arrays::check_channels;
use crate::decoding::Budget;
use crate::notice::Notices;
use crate::source::Source;
use crate::tdms::extent::Extent;
use crate::tdms::object::ObjectPath;
use crate::tdms::object::{ChunkContent, RawIndex, TdmsObject};
use crate::tdms::property::{Properties, Property, PropertyValue};
use crate::tdms::segment::Fields;
use crate::tdms::segment::LeadIn;
use crate::{FilePosition, MeasureError, Notice};

/// The metadata of all segments.
pub(crate) struct TdmsIndex {
    pub(crate) objects: Vec<TdmsObject>,
    pub(crate) budget: Budget,
    by_path: BTreeMap<String, usize>,
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
        source: &mut Source<'_>,
        budget: Budget,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        let mut index = Self {
            objects: Vec::new(),
            budget,
            by_path: BTreeMap::new(),
            chunk: BTreeMap::new(),
            list: 1,
            length: 0,
            channels: 0,
        };
        while source.remaining() > 0 {
            let place = source.place();
            let lead = LeadIn::read(source)?;
            let cut_off = || Notice::SegmentCutOff { place };
            if lead.open && lead.data > lead.end {
                // The file ends within the metadata: there are no samples.
                notices.add(cut_off());
                break;
            }
            if lead.has_metadata() {
                index.metadata(source, &lead)?;
            }
            let whole = !lead.has_raw_data() || index.raw_data(source, &lead, place)?;
            if lead.open || !whole {
                notices.add(cut_off());
            }
            // At least the length of a lead-in after the start of the segment.
            source.seek_to(lead.end)?;
        }
        Ok(index)
    }

    fn metadata(&mut self, source: &mut Source<'_>, lead: &LeadIn) -> Result<(), MeasureError> {
        if lead.starts_list() {
            self.list += 1;
            self.length = 0;
            self.chunk.clear();
        }
        let mut fields = Fields { source, endian: lead.endian };
        let count = fields.u32("the number of objects")?;
        // Length of a path, index and number of properties.
        fields.source.need(12 * u64::from(count), "the objects of a segment")?;
        for _ in 0..count {
            let place = fields.source.place();
            let path = fields.text("the path of an object")?;
            let id = self.object(fields.source, path, place)?;
            self.raw_data_index(&mut fields, id)?;
            for _ in 0..fields.u32("the number of properties")? {
                if let Some((name, property)) = Property::read(&mut fields)? {
                    self.keep(id, name, property)?;
                }
            }
        }
        if source.position() > lead.data {
            let (place, found) =
                (source.place(), format!("{} bytes too long", source.position() - lead.data));
            let expected = "the length in the lead-in";
            return Err(source.malformed(place, "the metadata", &found, expected));
        }
        Ok(())
    }

    /// Stores a property of an object, replacing one of that name.
    fn keep(&mut self, id: usize, name: String, property: Property) -> Result<(), MeasureError> {
        let bytes = |value: &PropertyValue| {
            if let PropertyValue::Text(text) = value { text.len() as u64 } else { 0 }
        };
        let properties = &mut self.objects[id].properties;
        let grown = match properties.get(&name) {
            Some(known) => bytes(&property.value).saturating_sub(bytes(&known.value)),
            None => 160 + 2 * name.len() as u64 + bytes(&property.value),
        };
        self.budget.take(grown, property.place, "the properties")?;
        properties.insert(name, property);
        Ok(())
    }

    /// The object of a path, new or known.
    fn object(
        &mut self,
        source: &Source<'_>,
        text: String,
        place: FilePosition,
    ) -> Result<usize, MeasureError> {
        if let Some(id) = self.by_path.get(&text) {
            return Ok(*id);
        }
        let Some(path) = ObjectPath::parse(&text) else {
            let expected = "`/`, `/'group'` or `/'group'/'channel'`";
            return Err(source.malformed(place, "the path of an object", &text, expected));
        };
        if matches!(path, ObjectPath::Channel(..)) {
            self.channels += 1;
            check_channels(source, self.channels)?;
        }
        self.budget.take(600 + 4 * text.len() as u64, place, "the objects")?;
        self.objects.push(TdmsObject {
            path,
            properties: Properties::new(),
            index: None,
            list: 0,
            place: 0,
            extents: Vec::new(),
            samples: 0,
            other: None,
        });
        self.by_path.insert(text, self.objects.len() - 1);
        Ok(self.objects.len() - 1)
    }

    fn raw_data_index(
        &mut self,
        fields: &mut Fields<'_, '_>,
        id: usize,
    ) -> Result<(), MeasureError> {
        let place = fields.source.place();
        let quantity = "the raw data index";
        let length = fields.u32(quantity)?;
        let object = &mut self.objects[id];
        let is_channel = matches!(object.path, ObjectPath::Channel(..));
        match (length, object.index) {
            (u32::MAX, _) => {}
            (0, None) if is_channel => {
                let expected = "a description of its samples, as no segment before gave one";
                return Err(fields.source.malformed(place, quantity, "0", expected));
            }
            (0, _) => {}
            _ if !is_channel => {
                let expected = "none (4294967295) for the file and its groups";
                let found = length.to_string();
                return Err(fields.source.malformed(place, quantity, &found, expected));
            }
            _ => object.index = Some(RawIndex::read(fields, length)?),
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

    /// Stores the positions of the samples of a segment; false if its last chunk is incomplete.
    fn raw_data(
        &mut self,
        source: &Source<'_>,
        lead: &LeadIn,
        start: FilePosition,
    ) -> Result<bool, MeasureError> {
        let available = lead.end - lead.data;
        if available == 0 {
            return Ok(true);
        }
        let place = FilePosition::Offset(lead.data);
        let wrong = |found: String, expected: &str| {
            Err(source.malformed(place, "the raw data of a segment", &found, expected))
        };
        let (mut row, mut bytes, mut even) = (0, 0_u64, true);
        let mut values = None;
        for id in self.chunk.values() {
            let Some(index) = self.objects[*id].index else { continue };
            bytes = bytes.saturating_add(index.bytes);
            match index.content {
                ChunkContent::Numbers(number) => row += number.size() as u64,
                ChunkContent::Other(_) => even = false,
            }
            even &= *values.get_or_insert(index.values) == index.values;
        }
        if bytes == 0 {
            return wrong(format!("{available} bytes long"), "empty: no channel has samples here");
        }
        if lead.is_interleaved() && !even {
            return wrong("interleaved".into(), "channels of numbers, each with as many samples");
        }
        // A single channel is a row of one, for which chunks make no difference.
        let rows = even && (lead.is_interleaved() || self.chunk.len() == 1);
        let unit = if rows { row } else { bytes };
        let rest = available % unit;
        if rest > 0 && !lead.open {
            let expected = format!("a multiple of {unit} bytes, by its metadata");
            return wrong(format!("{available} bytes long"), &expected);
        }
        let count = available / unit;
        if count > 0 {
            let shape = if rows { (row, count * row, 1) } else { (0, bytes, count) };
            let values = rows.then_some(count);
            self.extents(lead, shape, values, start)?;
        }
        Ok(rest == 0)
    }

    /// Adds an extent to each channel of the chunk: row, stride and chunks, and
    /// the number of values if it differs from the description.
    fn extents(
        &mut self,
        lead: &LeadIn,
        (row, stride, chunks): (u64, u64, u64),
        values: Option<u64>,
        place: FilePosition,
    ) -> Result<(), MeasureError> {
        let mut column = 0;
        for id in self.chunk.values() {
            let object = &mut self.objects[*id];
            let Some(index) = object.index else { continue };
            let number = match index.content {
                ChunkContent::Numbers(number) => number,
                ChunkContent::Other(what) => {
                    object.other = Some(what);
                    column += index.bytes;
                    continue;
                }
            };
            let (base, endian) = (lead.data, lead.endian);
            let values = values.unwrap_or(index.values);
            let extent = Extent { base, column, row, stride, chunks, values, number, endian };
            object.samples += values * chunks;
            if !object.extents.last_mut().is_some_and(|last| last.carry_on(&extent)) {
                // Lists grow by doubling, with both copies in memory.
                self.budget.take(3 * size_of::<Extent>() as u64, place, "the segments")?;
                object.extents.push(extent);
            }
            column += if row > 0 { number.size() as u64 } else { index.bytes };
        }
        Ok(())
    }
}
