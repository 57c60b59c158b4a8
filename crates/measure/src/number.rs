//! Binary numbers of every width and byte order, as `f64`.

use std::io::Read;

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

    /// Relative rounding of one number; zero for whole numbers.
    pub(crate) fn epsilon(self) -> f64 {
        match self {
            Self::F32 => f64::from(f32::EPSILON),
            Self::F64 => f64::EPSILON,
            _ => 0.0,
        }
    }

    /// Appends the numbers in `bytes`, whose length is a multiple of the size.
    pub(crate) fn decode(self, endian: Endian, bytes: &[u8], values: &mut Vec<f64>) {
        macro_rules! numbers {
            ($type:ty, $to:expr) => {{
                let (chunks, _) = bytes.as_chunks::<{ size_of::<$type>() }>();
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

    /// Appends `count` numbers from `reader`, in pieces.
    pub(crate) fn read(
        self,
        endian: Endian,
        reader: &mut impl Read,
        count: usize,
        values: &mut Vec<f64>,
    ) -> std::io::Result<()> {
        let mut piece = [0; 1 << 13];
        let per_piece = piece.len() / self.size();
        let mut left = count;
        while left > 0 {
            let now = left.min(per_piece);
            let bytes = &mut piece[..now * self.size()];
            reader.read_exact(bytes)?;
            self.decode(endian, bytes, values);
            left -= now;
        }
        Ok(())
    }
}
