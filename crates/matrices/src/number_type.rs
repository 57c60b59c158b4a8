//! Binary numbers of every width and byte order.

/// Order of the bytes of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Endian {
    Little,
    Big,
}

impl Endian {
    pub(crate) fn u32(self, bytes: [u8; 4]) -> u32 {
        match self {
            Self::Little => u32::from_le_bytes(bytes),
            Self::Big => u32::from_be_bytes(bytes),
        }
    }
}

/// Kind and width of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NumberType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl NumberType {
    /// Bytes of one number.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The numbers at the start of every `stride` bytes.
    pub(crate) fn decode(self, endian: Endian, bytes: &[u8], stride: usize) -> Vec<f64> {
        macro_rules! numbers {
            ($type:ty, $to:expr) => {{
                let one = |item: &[u8]| {
                    let first = item.first_chunk().copied().unwrap_or_default();
                    match endian {
                        Endian::Little => $to(<$type>::from_le_bytes(first)),
                        Endian::Big => $to(<$type>::from_be_bytes(first)),
                    }
                };
                bytes.chunks(stride).filter(|item| item.len() >= self.size()).map(one).collect()
            }};
        }
        match self {
            Self::I8 => numbers!(i8, f64::from),
            Self::U8 => numbers!(u8, f64::from),
            Self::I16 => numbers!(i16, f64::from),
            Self::U16 => numbers!(u16, f64::from),
            Self::I32 => numbers!(i32, f64::from),
            Self::U32 => numbers!(u32, f64::from),
            Self::I64 => numbers!(i64, |value| value as f64),
            Self::U64 => numbers!(u64, |value| value as f64),
            Self::F32 => numbers!(f32, f64::from),
            Self::F64 => numbers!(f64, |value| value),
        }
    }
}
