//! Types of values, by their codes in the file.

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Endian {
    Little,
    Big,
}

/// Type of the values of a channel or of a property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DataType {
    Void,
    Number(NumberType),
    Text,
    Boolean,
    Time,
    Complex32,
    Complex64,
}

impl DataType {
    /// The type of a code; none for other codes, such as codes of numbers of more than 8 bytes.
    pub(crate) fn of_code(code: u32) -> Option<Self> {
        Some(match code {
            0 => Self::Void,
            1..=10 => Self::Number(NumberType(code)),
            // With a unit in the properties.
            0x19 | 0x1a => Self::Number(NumberType(code - 16)),
            0x20 => Self::Text,
            0x21 => Self::Boolean,
            0x44 => Self::Time,
            0x08_000c => Self::Complex32,
            0x10_000d => Self::Complex64,
            _ => return None,
        })
    }

    /// Bytes of one value; zero for texts, whose length is in the file.
    pub(crate) fn size(self) -> u64 {
        match self {
            Self::Number(number) => number.size(),
            Self::Void | Self::Text => 0,
            Self::Boolean => 1,
            Self::Complex32 => 8,
            Self::Time | Self::Complex64 => 16,
        }
    }

    /// The content of a channel without numbers.
    pub(crate) fn other_content(self) -> Option<&'static str> {
        Some(match self {
            Self::Number(_) => return None,
            Self::Void => "it has no values",
            Self::Text => "its values are texts",
            Self::Boolean => "its values are truth values",
            Self::Time => "its values are times of day",
            Self::Complex32 | Self::Complex64 => "its values are complex numbers",
        })
    }
}

/// A type of numbers of one to eight bytes, by its code: signed integers 1 to 4, unsigned integers
/// 5 to 8, floating point 9 and 10.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct NumberType(u32);

impl NumberType {
    /// Bytes of one number.
    pub(crate) fn size(self) -> u64 {
        match self.0 {
            1 | 5 => 1,
            2 | 6 => 2,
            3 | 7 | 9 => 4,
            _ => 8,
        }
    }

    /// Appends the numbers in `bytes`, whose length is a multiple of the size.
    pub(crate) fn decode(self, endian: Endian, bytes: &[u8], values: &mut Vec<f64>) {
        macro_rules! numbers {
            ($type:ty, $to:expr) => {{
                let (chunks, _) = bytes.as_chunks();
                match endian {
                    Endian::Little => {
                        values.extend(chunks.iter().map(|c| $to(<$type>::from_le_bytes(*c))));
                    }
                    Endian::Big => {
                        values.extend(chunks.iter().map(|c| $to(<$type>::from_be_bytes(*c))));
                    }
                }
            }};
        }
        match self.0 {
            1 => numbers!(i8, f64::from),
            2 => numbers!(i16, f64::from),
            3 => numbers!(i32, f64::from),
            4 => numbers!(i64, |value| value as f64),
            5 => numbers!(u8, f64::from),
            6 => numbers!(u16, f64::from),
            7 => numbers!(u32, f64::from),
            8 => numbers!(u64, |value| value as f64),
            9 => numbers!(f32, f64::from),
            _ => numbers!(f64, f64::from),
        }
    }
}
