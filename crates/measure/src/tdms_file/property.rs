//! Properties of objects: numbers, texts and times.

use std::collections::BTreeMap;
use std::io::{Read, Seek};

use crate::tdms_file::byte_reader::ByteReader;
use crate::tdms_file::data_type::{DataType, Endian};
use crate::tdms_file::{TdmsError, TdmsTime};

/// Properties by name.
pub(crate) type Properties = BTreeMap<String, TdmsProperty>;

/// A property and its position.
#[derive(Debug, Clone, PartialEq)]
pub struct TdmsProperty {
    /// Bytes from the start of the file to its type.
    pub offset: u64,
    /// Its value.
    pub value: TdmsValue,
}

/// Value of a property.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum TdmsValue {
    /// A number of any type.
    Number(f64),
    /// A text.
    Text(String),
    /// A time.
    Time(TdmsTime),
}

impl TdmsProperty {
    /// The number, if it is one.
    pub fn number(&self) -> Option<f64> {
        if let TdmsValue::Number(number) = self.value { Some(number) } else { None }
    }

    /// The text without blanks at its ends, if it is one.
    pub fn text(&self) -> Option<&str> {
        if let TdmsValue::Text(text) = &self.value { Some(text.trim()) } else { None }
    }

    /// The time, if it is one.
    pub fn time(&self) -> Option<TdmsTime> {
        if let TdmsValue::Time(time) = self.value { Some(time) } else { None }
    }

    /// Reads a property with its name; none if it is not kept.
    pub(crate) fn read(
        bytes: &mut ByteReader<impl Read + Seek>,
        keep: fn(&str) -> bool,
    ) -> Result<Option<(String, Self)>, TdmsError> {
        let name = bytes.text("the name of a property")?;
        let (offset, quantity) = (bytes.position(), "a property");
        let code = bytes.u32("the type of a property")?;
        let kept = keep(&name) || is_of_scales(&name);
        let value = match DataType::of_code(code) {
            Some(DataType::Text) if kept => TdmsValue::Text(bytes.text(quantity)?),
            Some(DataType::Text) => {
                let length = bytes.u32(quantity)?;
                bytes.skip(u64::from(length), quantity)?;
                return Ok(None);
            }
            Some(DataType::Time) => TdmsValue::Time(time(bytes)?),
            Some(DataType::Number(number)) => {
                let mut values = Vec::with_capacity(1);
                bytes.numbers((number, bytes.endian), 1, &mut values, quantity)?;
                TdmsValue::Number(values[0])
            }
            Some(other) => {
                bytes.skip(other.size(), quantity)?;
                return Ok(None);
            }
            None => {
                let expected = "a number (1 to 10, 25, 26), a string (32) or a time (68)";
                let (found, quantity) = (code.to_string(), "the type of a property");
                return Err(TdmsError::malformed(offset, quantity, &found, expected));
            }
        };
        Ok(kept.then_some((name, Self { offset, value })))
    }

    /// Bytes of its text.
    pub(crate) fn text_len(&self) -> u64 {
        if let TdmsValue::Text(text) = &self.value { text.len() as u64 } else { 0 }
    }
}

fn is_of_scales(name: &str) -> bool {
    matches!(name, "NI_Scaling_Status" | "NI_Number_Of_Scales") || name.starts_with("NI_Scale[")
}

/// The fraction comes first in little endian, the seconds in big endian.
fn time(bytes: &mut ByteReader<impl Read + Seek>) -> Result<TdmsTime, TdmsError> {
    let first = bytes.u64("a time")?;
    let second = bytes.u64("a time")?;
    let (seconds, fraction) = match bytes.endian {
        Endian::Little => (second, first),
        Endian::Big => (first, second),
    };
    Ok(TdmsTime { seconds: seconds.cast_signed(), fraction })
}
