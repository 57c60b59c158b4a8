//! Arrays of a NumPy archive.
//!
//! Source: NumPy Enhancement Proposal 1. Real arrays of at most two dimensions, and structured arrays with
//! the fields `node` and `direction`, as SDynPy writes them.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use crate::DenseMatrix;
use crate::arrays::{Array, Arrays};
use crate::error::{MatricesError, Place, excerpt};
use crate::number_type::{Endian, NumberType};

/// Most arrays of an archive.
const MOST_ARRAYS: usize = 1000;

/// Start of an archive.
pub(crate) const MARK: &[u8] = b"PK";

pub(crate) fn read(file: &str, bytes: Vec<u8>) -> Result<Arrays, MatricesError> {
    let wrong = |place: Place, found: String, expected: &str| {
        MatricesError::malformed(file, place, found, expected)
    };
    let start = Place::Byte(0);
    let mut archive = ZipArchive::new(Cursor::new(bytes))
        .map_err(|error| wrong(start.clone(), error.to_string(), "an archive of NumPy (.npz)"))?;
    if archive.len() > MOST_ARRAYS {
        let found = format!("{} arrays", archive.len());
        return Err(wrong(start, found, "at most 1000"));
    }
    let mut arrays = Arrays::new(file);
    for index in 0..archive.len() {
        let mut entry = archive
            .by_index(index)
            .map_err(|error| wrong(start.clone(), error.to_string(), "whole arrays"))?;
        let name = entry.name().map(std::borrow::Cow::into_owned);
        let name = name.map_err(|error| wrong(start.clone(), error.to_string(), "a name"))?;
        let name = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
        let mut bytes = Vec::new();
        let read = entry.read_to_end(&mut bytes);
        let place = Place::Array(name.clone());
        read.map_err(|error| wrong(place.clone(), error.to_string(), "a whole array"))?;
        match array(&bytes) {
            Ok(Some(array)) => arrays.add(name, array),
            Ok(None) => arrays.leave_out(&name, "is not a real array of at most two dimensions"),
            Err((found, expected)) => return Err(wrong(place, found, expected)),
        }
    }
    Ok(arrays)
}

/// An array of numbers; none if it is of another kind.
fn array(bytes: &[u8]) -> Result<Option<Array>, (String, &'static str)> {
    let Some((header, data)) = split(bytes) else {
        return Err((excerpt(&bytes[..bytes.len().min(10)]), "an array of NumPy, versions 1 to 3"));
    };
    let header = String::from_utf8_lossy(header);
    let value = |key: &str| {
        header.split_once(&format!("'{key}':")).map_or("", |(_, after)| after.trim_start())
    };
    let inside = value("shape").strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let shape: Option<Vec<usize>> = inside.and_then(|(inside, _)| {
        let lengths = inside.split(',').map(str::trim).filter(|part| !part.is_empty());
        lengths.map(|length| length.parse().ok()).collect()
    });
    let shape = shape.ok_or_else(|| (excerpt(header.as_bytes()), "a shape such as (2, 3)"))?;
    let (rows, columns) = match shape[..] {
        [] => (1, 1),
        [length] => (length, 1),
        [rows, columns] => (rows, columns),
        _ => return Ok(None),
    };
    let Some(fields) = fields(value("descr")) else { return Ok(None) };
    let stride: usize = fields.iter().map(|(_, number, _)| number.size()).sum();
    let needed = rows.checked_mul(columns).and_then(|count| count.checked_mul(stride));
    if needed != Some(data.len()) {
        let found = format!("{} bytes for the shape {shape:?}", data.len());
        return Err((found, "as many as the shape needs"));
    }
    if let [(_, number, endian)] = fields[..] {
        let values = number.decode(endian, data, stride);
        let dense = if value("fortran_order").starts_with("True") {
            DenseMatrix::new(rows, columns, values)
        } else {
            DenseMatrix::new(columns, rows, values).transposed()
        };
        return Ok(Some(Array::Dense(dense)));
    }
    let mut offset = 0;
    let mut parts = [None, None];
    for (name, number, endian) in fields {
        let part = match name {
            "node" => &mut parts[0],
            "direction" => &mut parts[1],
            _ => return Ok(None),
        };
        *part = Some(number.decode(endian, data.get(offset..).unwrap_or_default(), stride));
        offset += number.size();
    }
    let [Some(mut values), Some(directions)] = parts else { return Ok(None) };
    values.extend(directions);
    Ok(Some(Array::Dense(DenseMatrix::new(rows * columns, 2, values))))
}

/// Header and data of an array.
fn split(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let rest = bytes.strip_prefix(b"\x93NUMPY")?;
    let (version, rest) = rest.split_first_chunk::<2>()?;
    let (length, rest) = match version[0] {
        1 => {
            let (length, rest) = rest.split_first_chunk::<2>()?;
            (u32::from(u16::from_le_bytes(*length)), rest)
        }
        2 | 3 => {
            let (length, rest) = rest.split_first_chunk::<4>()?;
            (u32::from_le_bytes(*length), rest)
        }
        _ => return None,
    };
    rest.split_at_checked(length as usize)
}

/// Names, types and byte orders of `'<f8'` or of `[('node', '<u8'), ('direction', 'i1')]`.
fn fields(descr: &str) -> Option<Vec<(&str, NumberType, Endian)>> {
    if let Some(rest) = descr.strip_prefix('\'') {
        return Some(vec![number_type(rest.split_once('\'')?.0).map(|(n, e)| ("", n, e))?]);
    }
    let inside = descr.strip_prefix('[')?.split_once(']')?.0;
    let texts: Vec<&str> = inside.split('\'').skip(1).step_by(2).collect();
    let (pairs, rest) = texts.as_chunks::<2>();
    if !rest.is_empty() || pairs.len() != inside.matches('(').count() {
        return None;
    }
    pairs.iter().map(|[name, kind]| number_type(kind).map(|(n, e)| (*name, n, e))).collect()
}

fn number_type(kind: &str) -> Option<(NumberType, Endian)> {
    let (endian, name) = match kind.split_at_checked(1)? {
        ("<" | "|", name) => (Endian::Little, name),
        (">", name) => (Endian::Big, name),
        _ => (Endian::Little, kind),
    };
    let number = match name {
        "f4" => NumberType::F32,
        "f8" => NumberType::F64,
        "i1" => NumberType::I8,
        "u1" => NumberType::U8,
        "i2" => NumberType::I16,
        "u2" => NumberType::U16,
        "i4" => NumberType::I32,
        "u4" => NumberType::U32,
        "i8" => NumberType::I64,
        "u8" => NumberType::U64,
        _ => return None,
    };
    Some((number, endian))
}
