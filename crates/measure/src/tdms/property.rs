//! Properties of objects: a name, a type, a value.

use std::collections::BTreeMap;

use crate::number::{Endian, NumberType};
use crate::tdms::fields::Fields;
use crate::tdms::timestamp::Timestamp;
use crate::{FilePosition, MeasureError};

/// The properties of an object that are kept, by name.
pub(crate) type Properties = BTreeMap<String, Property>;

/// A property and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Property {
    pub(crate) place: FilePosition,
    pub(crate) value: Value,
}

/// What a property says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Number(f64),
    Text(String),
    Time(Timestamp),
}

impl Property {
    /// The number that the property is.
    pub(crate) fn number(&self) -> Option<f64> {
        if let Value::Number(number) = self.value { Some(number) } else { None }
    }

    /// The text that the property is.
    pub(crate) fn text(&self) -> Option<&str> {
        if let Value::Text(text) = &self.value { Some(text.trim()) } else { None }
    }

    /// Reads one property; none if nothing here asks for it.
    pub(crate) fn read(
        fields: &mut Fields<'_, '_>,
    ) -> Result<Option<(String, Self)>, MeasureError> {
        let name = fields.text("the name of a property")?;
        let place = fields.source.place();
        let kind = fields.u32("the type of a property")?;
        let quantity = "a property";
        let value = match kind {
            0x20 if is_kept(&name) => Some(Value::Text(fields.text(quantity)?)),
            0x20 => {
                let length = fields.u32(quantity)?;
                fields.skip(u64::from(length), quantity)?;
                None
            }
            0x44 => Some(Value::Time(time(fields)?)),
            0x21 => {
                fields.skip(1, quantity)?;
                None
            }
            0x08_000c => {
                fields.skip(8, quantity)?;
                None
            }
            0x10_000d => {
                fields.skip(16, quantity)?;
                None
            }
            0 => None,
            _ => {
                let Some(number) = number_type(kind) else {
                    let expected = "a number (1 to 10, 25, 26), a string (32) or a time (68)";
                    let found = kind.to_string();
                    let quantity = "the type of a property";
                    return Err(fields.source.malformed(place, quantity, &found, expected));
                };
                let (mut bytes, mut values) = ([0; 8], Vec::with_capacity(1));
                let bytes = &mut bytes[..number.size()];
                fields.source.read_exact(bytes, quantity)?;
                number.decode(fields.endian, bytes, &mut values);
                values.first().copied().map(Value::Number)
            }
        };
        let kept = value.filter(|_| is_kept(&name));
        Ok(kept.map(|value| (name, Self { place, value })))
    }
}

/// The type of numbers with a code of TDMS; none for what is no number.
pub(crate) fn number_type(code: u32) -> Option<NumberType> {
    Some(match code {
        1 => NumberType::I8,
        2 => NumberType::I16,
        3 => NumberType::I32,
        4 => NumberType::I64,
        5 => NumberType::U8,
        6 => NumberType::U16,
        7 => NumberType::U32,
        8 => NumberType::U64,
        9 | 0x19 => NumberType::F32,
        10 | 0x1a => NumberType::F64,
        _ => return None,
    })
}

/// The fraction comes first in little endian, the seconds in big endian.
fn time(fields: &mut Fields<'_, '_>) -> Result<Timestamp, MeasureError> {
    let first = fields.u64("a time")?;
    let second = fields.u64("a time")?;
    let (seconds, fraction) = match fields.endian {
        Endian::Little => (second, first),
        Endian::Big => (first, second),
    };
    Ok(Timestamp { seconds: seconds.cast_signed(), fraction })
}

/// Whether the readers of records and scales ask for a property.
fn is_kept(name: &str) -> bool {
    const NAMES: [&str; 10] = [
        "wf_increment",
        "wf_start_offset",
        "wf_start_time",
        "wf_xunit_string",
        "wf_xname",
        "unit_string",
        "NI_UnitDescription",
        "NI_Scaling_Status",
        "NI_Number_Of_Scales",
        "description",
    ];
    NAMES.contains(&name) || name.starts_with("NI_Scale[")
}
