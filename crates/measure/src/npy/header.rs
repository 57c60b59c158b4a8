//! The header of an array: a Python dictionary of three known keys.

use crate::MeasureError;
use crate::number::{Endian, NumberType};

/// The header of an array.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NpyHeader {
    pub(crate) number: NumberType,
    pub(crate) endian: Endian,
    pub(crate) complex: bool,
    pub(crate) fortran: bool,
    pub(crate) shape: Vec<u64>,
}

impl NpyHeader {
    /// Longest header: the three keys take some hundred bytes.
    const LONGEST: u32 = 1 << 14;

    /// Reads the header by `fill`, which fills a buffer; `wrong(quantity, found, expected)` makes
    /// errors.
    pub(crate) fn read(
        mut fill: impl FnMut(&mut [u8]) -> Result<(), MeasureError>,
        wrong: &dyn Fn(&'static str, &str, &'static str) -> MeasureError,
    ) -> Result<Self, MeasureError> {
        let mut start = [0; 8];
        fill(&mut start)?;
        if &start[..6] != b"\x93NUMPY" {
            return Err(wrong("the start of an array", &latin(&start[..6]), "\\x93NUMPY"));
        }
        let width = match start[6] {
            1 => 2,
            2 | 3 => 4,
            other => return Err(wrong("the NPY version", &other.to_string(), "1, 2 or 3")),
        };
        let mut length = [0; 4];
        fill(&mut length[..width])?;
        let length = u32::from_le_bytes(length);
        if length > Self::LONGEST {
            let quantity = "the length of the NPY header";
            return Err(wrong(quantity, &length.to_string(), "at most 16384"));
        }
        let mut text = vec![0; length as usize];
        fill(&mut text)?;
        Self::parse(&latin(&text), wrong)
    }

    fn parse(
        text: &str,
        wrong: &dyn Fn(&'static str, &str, &'static str) -> MeasureError,
    ) -> Result<Self, MeasureError> {
        let value = |key: &str| {
            let after = text.split_once(&format!("'{key}':"))?.1;
            Some(after.trim_start())
        };
        let expected = "a type of numbers such as '<f8'";
        let descr = value("descr").unwrap_or_default();
        let kind =
            descr.strip_prefix('\'').and_then(|rest| rest.split_once('\'')).map(|kind| kind.0);
        let kind = kind.ok_or_else(|| wrong("the type of the array", descr, expected))?;
        let (endian, name) = match kind.split_at_checked(1) {
            Some(("<" | "|", name)) => (Endian::Little, name),
            Some((">", name)) => (Endian::Big, name),
            Some(("=", _)) | None => return Err(wrong("the type of the array", kind, expected)),
            Some(_) => (Endian::Little, kind),
        };
        let (number, complex) = match name {
            "f4" => (NumberType::F32, false),
            "f8" => (NumberType::F64, false),
            "c8" => (NumberType::F32, true),
            "c16" => (NumberType::F64, true),
            "i1" => (NumberType::I8, false),
            "u1" => (NumberType::U8, false),
            "i2" => (NumberType::I16, false),
            "u2" => (NumberType::U16, false),
            "i4" => (NumberType::I32, false),
            "u4" => (NumberType::U32, false),
            "i8" => (NumberType::I64, false),
            "u8" => (NumberType::U64, false),
            _ => return Err(wrong("the type of the array", kind, expected)),
        };
        let order = value("fortran_order").unwrap_or_default();
        let fortran = match (order.starts_with("True"), order.starts_with("False")) {
            (true, _) => true,
            (_, true) => false,
            _ => return Err(wrong("the order of the array", order, "True or False")),
        };
        let shape = value("shape").unwrap_or_default();
        let inside = shape.strip_prefix('(').and_then(|rest| rest.split_once(')'));
        let dimensions = inside.and_then(|(inside, _)| {
            let parts = inside.split(',').map(str::trim).filter(|part| !part.is_empty());
            parts.map(|part| part.parse().ok()).collect::<Option<Vec<u64>>>()
        });
        let shape = dimensions
            .ok_or_else(|| wrong("the shape of the array", shape, "such as (2, 1024)"))?;
        Ok(Self { number, endian, complex, fortran, shape })
    }

    /// The header of an array of little-endian doubles, padded to 64 bytes.
    pub(crate) fn to_bytes(complex: bool, shape: &str) -> Vec<u8> {
        let kind = if complex { "<c16" } else { "<f8" };
        let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
        let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
        text.extend(std::iter::repeat_n(' ', length - 1 - text.len()));
        text.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((length as u16).to_le_bytes());
        bytes.extend(text.as_bytes());
        bytes
    }

    /// Rows and columns; one row for a vector.
    pub(crate) fn plane(&self) -> Option<(u64, u64)> {
        match self.shape[..] {
            [] => Some((1, 1)),
            [length] => Some((1, length)),
            [rows, columns] => Some((rows, columns)),
            _ => None,
        }
    }

    /// Bytes of one element.
    pub(crate) fn element(&self) -> u64 {
        (self.number.size() * (1 + usize::from(self.complex))) as u64
    }
}

fn latin(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| char::from(*byte)).collect()
}
