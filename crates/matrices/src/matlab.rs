//! Variables of a MATLAB file of versions 5 to 7.
//!
//! Source: MathWorks, "MAT-File Format" (R2019b), level 5. Real arrays of two dimensions, full or sparse, in
//! either byte order, compressed or not. Other variables are named in errors, and not read.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::DenseMatrix;
use crate::arrays::{Array, Arrays};
use crate::error::{MatricesError, Place};
use crate::number_type::{Endian, NumberType};
use crate::sparse::Entry;

/// Types of elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Array classes.
const SPARSE: u32 = 5;
const FULL: std::ops::RangeInclusive<u32> = 6..=15;

/// Flag of an array with imaginary parts.
const COMPLEX: u32 = 0x0800;

/// The content found in an element, and the content accepted.
type Fault = (String, &'static str);

pub(crate) fn read(file: &str, bytes: &[u8]) -> Result<Arrays, MatricesError> {
    let early = |missing: String| {
        let (file, place) = (file.to_owned(), Place::Byte(bytes.len() as u64));
        MatricesError::EndsEarly { file, place, missing }
    };
    let place = |at: usize| Place::Byte(at as u64);
    let Some((head, mut rest)) = bytes.split_first_chunk::<128>() else {
        return Err(early("the header has 128 bytes".into()));
    };
    if head.starts_with(b"MATLAB 7.3") || head.starts_with(b"\x89HDF") {
        return Err(MatricesError::Unsupported {
            file: file.to_owned(),
            place: place(0),
            feature: "a file of MATLAB 7.3".into(),
            remedy: "save it with the option '-v7'".into(),
        });
    }
    let endian = match &head[124..] {
        [0, 1, b'I', b'M'] => Endian::Little,
        [1, 0, b'M', b'I'] => Endian::Big,
        other => {
            let found = format!("the version and byte order {other:02x?}");
            let expected = "the header of a MATLAB file of versions 5 to 7";
            return Err(MatricesError::malformed(file, place(124), found, expected));
        }
    };
    let mut arrays = Arrays::new(file);
    while !rest.is_empty() {
        let at = bytes.len() - rest.len();
        let wrong =
            |(found, expected): Fault| MatricesError::malformed(file, place(at), found, expected);
        let mut elements = Elements { rest, endian };
        // Compressed elements are not padded.
        let element = elements
            .next(true)
            .map_err(|_| early(format!("the variable at byte {at} is longer")))?;
        match element.kind {
            MATRIX => {
                variable(Elements { rest: element.data, endian }, &mut arrays).map_err(wrong)?;
            }
            COMPRESSED => {
                let unfolded = unfold(element.data, endian).map_err(wrong)?;
                let inner = Elements { rest: &unfolded, endian }.next(true).map_err(wrong)?;
                if inner.kind == MATRIX {
                    variable(Elements { rest: inner.data, endian }, &mut arrays).map_err(wrong)?;
                }
            }
            _ => {}
        }
        rest = elements.rest;
    }
    Ok(arrays)
}

/// The bytes of a compressed element.
fn unfold(data: &[u8], endian: Endian) -> Result<Vec<u8>, Fault> {
    let mut decoder = ZlibDecoder::new(data);
    let wrong = |error: std::io::Error| {
        (format!("a compressed variable: {error}"), "a whole variable, compressed by zlib")
    };
    let mut unfolded = vec![0; 8];
    decoder.read_exact(&mut unfolded).map_err(wrong)?;
    let length = unfolded.last_chunk().copied().map_or(0, |bytes| endian.u32(bytes));
    decoder.take(u64::from(length)).read_to_end(&mut unfolded).map_err(wrong)?;
    Ok(unfolded)
}

/// A data element.
struct Element<'a> {
    kind: u32,
    data: &'a [u8],
}

/// Elements one after the other.
struct Elements<'a> {
    rest: &'a [u8],
    endian: Endian,
}

impl<'a> Elements<'a> {
    /// The next element, with a tag of type and length, or a small one of at most four bytes in one tag.
    fn next(&mut self, unpadded: bool) -> Result<Element<'a>, Fault> {
        let short =
            || ("an element beyond its variable".to_owned(), "as many bytes as its tag says");
        let ([a, b, c, d, tail @ ..], rest) =
            self.rest.split_first_chunk::<8>().ok_or_else(short)?;
        let first = self.endian.u32([*a, *b, *c, *d]);
        if first >> 16 != 0 {
            let (kind, length) = (first & 0xffff, (first >> 16) as usize);
            let start = self.rest.get(4..8).unwrap_or_default();
            let data = start.get(..length);
            self.rest = rest;
            let data = data
                .ok_or_else(|| (format!("a small element of {length} bytes"), "at most 4 bytes"))?;
            return Ok(Element { kind, data });
        }
        let length = self.endian.u32(*tail) as usize;
        let data = rest.get(..length).ok_or_else(short)?;
        let padded = if unpadded { length } else { length.next_multiple_of(8) };
        self.rest = rest.get(padded..).unwrap_or_default();
        Ok(Element { kind: first, data })
    }

    fn words(&mut self) -> Result<Vec<u32>, Fault> {
        let (chunks, _) = self.next(false)?.data.as_chunks::<4>();
        Ok(chunks.iter().map(|bytes| self.endian.u32(*bytes)).collect())
    }

    /// The numbers of an element.
    fn numbers(&mut self) -> Result<Vec<f64>, Fault> {
        let element = self.next(false)?;
        let number = match element.kind {
            1 => NumberType::I8,
            2 => NumberType::U8,
            3 => NumberType::I16,
            4 => NumberType::U16,
            5 => NumberType::I32,
            6 => NumberType::U32,
            7 => NumberType::F32,
            9 => NumberType::F64,
            12 => NumberType::I64,
            13 => NumberType::U64,
            other => {
                let found = format!("numbers of the type {other}");
                return Err((found, "one of the types 1 to 7, 9, 12, 13"));
            }
        };
        Ok(number.decode(self.endian, element.data, number.size()))
    }
}

/// Reads a variable into `arrays`.
fn variable(mut elements: Elements<'_>, arrays: &mut Arrays) -> Result<(), Fault> {
    let flags = elements.words()?.first().copied();
    let flags = flags.ok_or_else(|| ("no array flags".to_owned(), "8 bytes of array flags"))?;
    let dimensions: Vec<usize> = elements.words()?.iter().map(|length| *length as usize).collect();
    let name = String::from_utf8_lossy(elements.next(false)?.data).into_owned();
    let class = flags & 0xff;
    let &[rows, columns] = &dimensions[..] else {
        arrays.leave_out(&name, "has more than two dimensions");
        return Ok(());
    };
    if flags & COMPLEX != 0 {
        arrays.leave_out(&name, "is complex");
    } else if class == SPARSE {
        let array = sparse(&mut elements, &name, rows, columns)?;
        arrays.add(name, array);
    } else if FULL.contains(&class) {
        let values = elements.numbers()?;
        if Some(values.len()) != rows.checked_mul(columns) {
            let found = format!("{} numbers for the {rows} x {columns} of {name}", values.len());
            return Err((found, "one for each element"));
        }
        arrays.add(name, Array::Dense(DenseMatrix::new(rows, columns, values)));
    } else {
        arrays.leave_out(&name, "is not an array of numbers");
    }
    Ok(())
}

/// The entries of a sparse array: rows, starts of columns, values.
fn sparse(
    elements: &mut Elements<'_>,
    name: &str,
    rows: usize,
    columns: usize,
) -> Result<Array, Fault> {
    let row_of = elements.words()?;
    let starts = elements.words()?;
    let values = elements.numbers()?;
    let wrong = |found: &str| {
        (format!("{found} of the sparse {name}"), "a sparse array as MATLAB writes it")
    };
    if starts.len() != columns.saturating_add(1)
        || !starts.is_sorted()
        || starts.first() != Some(&0)
    {
        return Err(wrong("wrong starts of the columns"));
    }
    let count = starts.last().map_or(0, |count| *count as usize);
    let (Some(row_of), Some(values)) = (row_of.get(..count), values.get(..count)) else {
        return Err(wrong("fewer entries than announced"));
    };
    if row_of.iter().any(|row| *row as usize >= rows) {
        return Err(wrong("a row out of range"));
    }
    let mut entries = Vec::with_capacity(count);
    for column in 0..columns {
        let range = starts[column] as usize..starts[column + 1] as usize;
        let in_column = row_of[range.clone()].iter().zip(&values[range]);
        entries.extend(in_column.map(|(&row, &value)| Entry { row, column: column as u32, value }));
    }
    Ok(Array::Sparse { rows, columns, entries })
}
