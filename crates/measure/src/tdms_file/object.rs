//! The file, its groups and channels, their paths and the description of their samples.

use std::io::{Read, Seek};

use crate::tdms_file::byte_reader::ByteReader;
use crate::tdms_file::data_type::DataType;
use crate::tdms_file::extent::Extent;
use crate::tdms_file::property::Properties;
use crate::tdms_file::{TdmsError, TdmsProperty};

/// An object of the file: the file itself, a group or a channel.
#[derive(Debug, Default)]
pub struct TdmsObject {
    pub(crate) path: TdmsPath,
    pub(crate) properties: Properties,
    /// The latest description of its samples.
    pub(crate) index: Option<RawIndex>,
    /// Number of its list of objects, and its index there.
    pub(crate) list: u64,
    pub(crate) place: usize,
    /// Positions of its samples.
    pub(crate) extents: Vec<Extent>,
    pub(crate) samples: u64,
    pub(crate) other_content: Option<&'static str>,
}

impl TdmsObject {
    /// Its path.
    pub fn path(&self) -> &TdmsPath {
        &self.path
    }

    /// The latest value of a property.
    pub fn property(&self, name: &str) -> Option<&TdmsProperty> {
        self.properties.get(name)
    }

    /// The latest value of each property, by name.
    pub fn properties(&self) -> impl Iterator<Item = (&str, &TdmsProperty)> {
        self.properties.iter().map(|(name, property)| (name.as_str(), property))
    }

    /// Number of samples, of numbers only.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Description of values that are not numbers and are not read, such as `its values are texts`.
    pub fn other_content(&self) -> Option<&'static str> {
        self.other_content
    }
}

/// Description of the samples of a channel in a chunk.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RawIndex {
    pub(crate) kind: DataType,
    pub(crate) values: u64,
    /// Bytes of all values.
    pub(crate) bytes: u64,
}

impl RawIndex {
    /// Reads the description that follows its `length`.
    pub(crate) fn read(
        bytes: &mut ByteReader<impl Read + Seek>,
        length: u32,
    ) -> Result<Self, TdmsError> {
        let offset = bytes.position();
        let wrong = |quantity, found: u32, expected: &str| {
            Err(TdmsError::malformed(offset, quantity, &found.to_string(), expected))
        };
        // Descriptions of the driver have other lengths.
        if matches!(length, 0x1269 | 0x126a) {
            return Err(TdmsError::RawDaqmx);
        }
        let code = bytes.u32("the type of a channel")?;
        if code == u32::MAX {
            return Err(TdmsError::RawDaqmx);
        }
        let dimension = bytes.u32("the dimension of a channel")?;
        if dimension != 1 {
            return wrong("the dimension of a channel", dimension, "1");
        }
        let values = bytes.u64("the number of samples")?;
        let kind = DataType::of_code(code).filter(|kind| *kind != DataType::Void || values == 0);
        let Some(kind) = kind else {
            let expected = "a number of 1 to 8 bytes (1 to 10, 25, 26)";
            return wrong("the type of a channel", code, expected);
        };
        let announced = if kind == DataType::Text { 28 } else { 20 };
        if length != announced {
            return wrong("the length of a raw data index", length, &announced.to_string());
        }
        let bytes = match kind {
            DataType::Text => bytes.u64("the bytes of texts")?,
            _ => values.saturating_mul(kind.size()),
        };
        Ok(Self { kind, values, bytes })
    }
}

/// The path of an object: `/` for the file, `/'group'`, `/'group'/'channel'`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum TdmsPath {
    /// The file.
    #[default]
    File,
    /// A group, by its name.
    Group(String),
    /// A channel, by the names of its group and of itself.
    Channel(String, String),
}

impl TdmsPath {
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
        let channel = |group: &str, name: &str| Some(TdmsPath::Channel(group.into(), name.into()));
        assert_eq!(TdmsPath::parse("/"), Some(TdmsPath::File));
        assert_eq!(TdmsPath::parse("/'Hits'"), Some(TdmsPath::Group("Hits".into())));
        assert_eq!(TdmsPath::parse("/'Hits'/'Force'"), channel("Hits", "Force"));
        assert_eq!(TdmsPath::parse("/'Dr. T''s'/'a/b'"), channel("Dr. T's", "a/b"));
        assert_eq!(TdmsPath::parse("/''''/'''a'''''"), channel("'", "'a''"));
        assert_eq!(TdmsPath::parse("/''/''"), channel("", ""));
        for wrong in ["", "Hits", "/Hits", "/'Hits", "/'a'b", "/'a'/'b'/'c'", "//", "/'a'/", "/'''"]
        {
            assert_eq!(TdmsPath::parse(wrong), None, "{wrong}");
        }
    }
}
