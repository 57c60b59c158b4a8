//! Properties of objects, with numbers, texts and times.

use std::collections::BTreeMap;
use std::fmt;

use crate::number::{Endian, NumberType};
use crate::tdms::segment::Fields;
use crate::{FilePosition, MeasureError};

/// The properties of an object that are kept, by name.
pub(crate) type Properties = BTreeMap<String, Property>;

/// A property and its position.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Property {
    pub(crate) place: FilePosition,
    pub(crate) value: PropertyValue,
}

/// Value of a property.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum PropertyValue {
    Number(f64),
    Text(String),
    Time(Timestamp),
}

impl Property {
    /// The number of a numeric property.
    pub(crate) fn number(&self) -> Option<f64> {
        if let PropertyValue::Number(number) = self.value { Some(number) } else { None }
    }

    /// The text of a text property.
    pub(crate) fn text(&self) -> Option<&str> {
        if let PropertyValue::Text(text) = &self.value { Some(text.trim()) } else { None }
    }

    /// Reads one property; none if it is not used.
    pub(crate) fn read(
        fields: &mut Fields<'_, '_>,
    ) -> Result<Option<(String, Self)>, MeasureError> {
        let name = fields.text("the name of a property")?;
        let place = fields.source.place();
        let kind = fields.u32("the type of a property")?;
        let quantity = "a property";
        let value = match kind {
            0x20 if is_kept(&name) => Some(PropertyValue::Text(fields.text(quantity)?)),
            0x20 => {
                let length = fields.u32(quantity)?;
                fields.skip(u64::from(length), quantity)?;
                None
            }
            0x44 => Some(PropertyValue::Time(time(fields)?)),
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
                values.first().copied().map(PropertyValue::Number)
            }
        };
        let kept = value.filter(|_| is_kept(&name));
        Ok(kept.map(|value| (name, Self { place, value })))
    }
}

/// The number type of a TDMS code; none for other types.
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

/// True for a property used by records or scales.
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

/// Days from 1 March of the year 0, in the calendar carried back, to 1 January 1904.
const DAYS_TO_1904: i64 = 695_361;

/// A time in UTC: seconds since 1904 and fractions of 2^-64 s.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Timestamp {
    /// Whole seconds since the start of 1904.
    pub(crate) seconds: i64,
    /// Fraction, in 2^-64 s.
    pub(crate) fraction: u64,
}

impl Timestamp {
    /// Seconds since `other`.
    pub(crate) fn since(self, other: Self) -> f64 {
        let fraction = |time: Self| time.fraction as f64 * 2f64.powi(-64);
        (i128::from(self.seconds) - i128::from(other.seconds)) as f64
            + (fraction(self) - fraction(other))
    }
}

impl fmt::Display for Timestamp {
    /// ISO 8601, to the microsecond; empty for years without four digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Years begin in March, so that the leap day is their last.
        let (days, second) = (self.seconds.div_euclid(86_400), self.seconds.rem_euclid(86_400));
        let days = days.saturating_add(DAYS_TO_1904);
        if !(0..3_652_000).contains(&days) {
            return Ok(());
        }
        let (cycle, day) = (days / 146_097, days % 146_097);
        let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
        let day_of_year = day - (365 * year + year / 4 - year / 100);
        let month = (5 * day_of_year + 2) / 153;
        let day_of_month = day_of_year - (153 * month + 2) / 5 + 1;
        let year = 400 * cycle + year + i64::from(month >= 10);
        let month = if month < 10 { month + 3 } else { month - 9 };
        let (hour, minute) = (second / 3600, second / 60 % 60);
        let micros = (u128::from(self.fraction) * 1_000_000) >> 64;
        write!(
            f,
            "{year:04}-{month:02}-{day_of_month:02}T{hour:02}:{minute:02}:{:02}",
            second % 60
        )?;
        write!(f, ".{micros:06}Z")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(seconds: i64, fraction: u64) -> String {
        Timestamp { seconds, fraction }.to_string()
    }

    #[test]
    fn days_of_the_calendar() {
        assert_eq!(written(0, 0), "1904-01-01T00:00:00.000000Z");
        // 1970 is 66 years of which 17 are leap years later.
        assert_eq!(written(2_082_844_800, 1 << 63), "1970-01-01T00:00:00.500000Z");
        // 1 795 273 957 is the output of `date -u -d 2026-11-21T15:12:37 +%s`.
        assert_eq!(written(1_795_273_957 + 2_082_844_800, 0), "2026-11-21T15:12:37.000000Z");
        // The last day of February of a leap year, and the day after.
        assert_eq!(written(951_782_400 + 2_082_844_800, 0), "2000-02-29T00:00:00.000000Z");
        assert_eq!(written(951_868_800 + 2_082_844_800, 0), "2000-03-01T00:00:00.000000Z");
        assert_eq!(written(-1, u64::MAX), "1903-12-31T23:59:59.999999Z");
        for nonsense in [i64::MIN, i64::MAX, -(1 << 50), 1 << 50] {
            assert_eq!(written(nonsense, 0), "");
        }
    }

    #[test]
    fn the_time_between_two() {
        let (one, other) = (
            Timestamp { seconds: 5, fraction: 1 << 62 },
            Timestamp { seconds: 3, fraction: 1 << 63 },
        );
        assert_eq!(one.since(other), 1.75);
        let far = Timestamp { seconds: i64::MIN, fraction: 0 };
        assert!(one.since(far) > 9e18);
    }
}
