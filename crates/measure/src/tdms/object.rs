//! The file, its groups and channels, their paths and the description of their samples.

use crate::MeasureError;
use crate::number::NumberType;
use crate::tdms::extent::Extent;
use crate::tdms::property::{Properties, number_type};
use crate::tdms::segment::Fields;
use crate::tdms::segment::daqmx;

/// An object of the file.
#[derive(Debug)]
pub(crate) struct TdmsObject {
    pub(crate) path: ObjectPath,
    pub(crate) properties: Properties,
    /// The latest description of its samples.
    pub(crate) index: Option<RawIndex>,
    /// Number of its list of objects, and its index there.
    pub(crate) list: u64,
    pub(crate) place: usize,
    /// Positions of its samples.
    pub(crate) extents: Vec<Extent>,
    /// Number of samples.
    pub(crate) samples: u64,
    /// Content other than numbers.
    pub(crate) other: Option<&'static str>,
}

/// Description of the samples of a channel in a chunk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RawIndex {
    pub(crate) content: ChunkContent,
    pub(crate) values: u64,
    /// Bytes of all values.
    pub(crate) bytes: u64,
}

/// Type of values.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ChunkContent {
    Numbers(NumberType),
    /// Another type, with the reason to leave it out.
    Other(&'static str),
}

impl RawIndex {
    /// Reads the description that follows its `length`.
    pub(crate) fn read(fields: &mut Fields<'_, '_>, length: u32) -> Result<Self, MeasureError> {
        let place = fields.source.place();
        let wrong = |fields: &Fields<'_, '_>, quantity, found: u64, expected: &str| {
            Err(fields.source.malformed(place, quantity, &found.to_string(), expected))
        };
        // Descriptions of the driver have other lengths.
        if matches!(length, 0x1269 | 0x126a) {
            return Err(daqmx(fields.source));
        }
        let code = fields.u32("the type of a channel")?;
        if code == u32::MAX {
            return Err(daqmx(fields.source));
        }
        let dimension = fields.u32("the dimension of a channel")?;
        if dimension != 1 {
            let quantity = "the dimension of a channel";
            return wrong(fields, quantity, u64::from(dimension), "1");
        }
        let values = fields.u64("the number of samples")?;
        let (content, size) = match (code, number_type(code)) {
            (_, Some(number)) => (ChunkContent::Numbers(number), number.size() as u64),
            (0x20, _) => (ChunkContent::Other("its values are texts"), 0),
            (0x21, _) => (ChunkContent::Other("its values are truth values"), 1),
            (0x44, _) => (ChunkContent::Other("its values are times of day"), 16),
            (0x08_000c, _) => (ChunkContent::Other("its values are complex numbers"), 8),
            (0x10_000d, _) => (ChunkContent::Other("its values are complex numbers"), 16),
            (0, _) if values == 0 => (ChunkContent::Other("it has no values"), 0),
            _ => {
                let expected = "a number of 1 to 8 bytes (1 to 10, 25, 26)";
                return wrong(fields, "the type of a channel", u64::from(code), expected);
            }
        };
        let is_text = code == 0x20;
        let announced = if is_text { 28 } else { 20 };
        if length != announced {
            let quantity = "the length of a raw data index";
            return wrong(fields, quantity, u64::from(length), &announced.to_string());
        }
        let bytes =
            if is_text { fields.u64("the bytes of texts")? } else { values.saturating_mul(size) };
        Ok(Self { content, values, bytes })
    }
}

/// The path of an object: `/` for the file, `/'group'`, `/'group'/'channel'`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ObjectPath {
    File,
    Group(String),
    Channel(String, String),
}

impl ObjectPath {
    /// Parses a path; a quote in a name is doubled.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        if text == "/" {
            return Some(Self::File);
        }
        let (group, rest) = name(text)?;
        if rest.is_empty() {
            return Some(Self::Group(group));
        }
        let (channel, rest) = name(rest)?;
        rest.is_empty().then_some(Self::Channel(group, channel))
    }
}

/// The first name of a path, and the rest.
fn name(text: &str) -> Option<(String, &str)> {
    let mut rest = text.strip_prefix("/'")?;
    let mut name = String::new();
    loop {
        let (before, after) = rest.split_once('\'')?;
        name.push_str(before);
        match after.strip_prefix('\'') {
            Some(_) => name.push('\''),
            None => return Some((name, after)),
        }
        rest = &after[1..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_quotes_and_slashes() {
        let channel =
            |group: &str, name: &str| Some(ObjectPath::Channel(group.into(), name.into()));
        assert_eq!(ObjectPath::parse("/"), Some(ObjectPath::File));
        assert_eq!(ObjectPath::parse("/'Hits'"), Some(ObjectPath::Group("Hits".into())));
        assert_eq!(ObjectPath::parse("/'Hits'/'Force'"), channel("Hits", "Force"));
        assert_eq!(ObjectPath::parse("/'Dr. T''s'/'a/b'"), channel("Dr. T's", "a/b"));
        assert_eq!(ObjectPath::parse("/''''/'''a'''''"), channel("'", "'a''"));
        assert_eq!(ObjectPath::parse("/''/''"), channel("", ""));
        for wrong in ["", "Hits", "/Hits", "/'Hits", "/'a'b", "/'a'/'b'/'c'", "//", "/'a'/", "/'''"]
        {
            assert_eq!(ObjectPath::parse(wrong), None, "{wrong}");
        }
    }
}
