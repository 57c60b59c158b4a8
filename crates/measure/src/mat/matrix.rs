//! Numeric arrays, and the fields of structures one level deep.

use std::io::Read;

use num_complex::Complex64;

use crate::arrays::{Array, Layout};
use crate::decoding::Budget;
use crate::mat::element::{ElementFault, Elements, Tag};
use crate::notice::Notices;
use crate::number::{Endian, NumberType};
use crate::{FilePosition, ReadOptions, Samples};

/// Options, limits and position of an array.
pub(crate) struct MatContext<'a> {
    pub(crate) options: &'a ReadOptions,
    pub(crate) notices: &'a mut Notices,
    pub(crate) budget: &'a mut Budget,
    pub(crate) file: &'a str,
    pub(crate) place: FilePosition,
}

/// Type of an element that holds a matrix.
pub(crate) const MATRIX: u32 = 14;

/// Array classes.
const STRUCTURE: u8 = 2;
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;
const COMPLEX: u32 = 0x0800;

/// Longest name of a variable or field; MATLAB allows 63.
const LONGEST_NAME: u32 = 1 << 10;

/// Reads a matrix element after its tag; the numeric fields of a structure.
pub(crate) fn read<R: Read>(
    elements: &mut Elements<R>,
    context: &mut MatContext<'_>,
) -> Result<Vec<Array>, ElementFault> {
    let head = MatrixHead::read(elements)?;
    if NUMERIC.contains(&head.class) {
        let found = numeric(elements, &head, head.name.clone(), context)?;
        return Ok(found.into_iter().collect());
    }
    if head.class == STRUCTURE && head.elements() == 1 {
        return structure(elements, &head, context);
    }
    context.notices.left_out(head.name, "it is not an array of numbers");
    Ok(Vec::new())
}

/// The head of a matrix.
struct MatrixHead {
    class: u8,
    complex: bool,
    dimensions: Vec<u64>,
    name: String,
}

impl MatrixHead {
    fn read<R: Read>(elements: &mut Elements<R>) -> Result<Self, ElementFault> {
        let endian = elements.endian;
        let tag = elements.tag()?;
        let flags = elements.bytes(tag, 8)?;
        let flags = words(&flags, endian).first().copied();
        let flags =
            flags.ok_or_else(|| ElementFault::unexpected("the array flags", "empty", "8 bytes"))?;
        let tag = elements.tag()?;
        let dimensions = elements.bytes(tag, 128)?;
        let dimensions: Vec<u64> = words(&dimensions, endian).into_iter().map(u64::from).collect();
        if dimensions.len() < 2 {
            let found = format!("{dimensions:?}");
            return Err(ElementFault::unexpected("the dimensions", found, "at least two"));
        }
        let tag = elements.tag()?;
        let name = elements.bytes(tag, LONGEST_NAME)?;
        Ok(Self {
            class: (flags & 0xff) as u8,
            complex: flags & COMPLEX != 0,
            dimensions,
            name: String::from_utf8_lossy(&name).into_owned(),
        })
    }

    fn elements(&self) -> u64 {
        self.dimensions.iter().fold(1, |product, length| product.saturating_mul(*length))
    }

    /// Rows and columns; none for more dimensions.
    fn plane(&self) -> Option<(u64, u64)> {
        let beyond = self.dimensions.get(2..).unwrap_or_default();
        let [rows, columns, ..] = self.dimensions[..] else { return None };
        beyond.iter().all(|length| *length == 1).then_some((rows, columns))
    }
}

fn words(bytes: &[u8], endian: Endian) -> Vec<u32> {
    let (chunks, _) = bytes.as_chunks::<4>();
    chunks.iter().map(|bytes| endian.u32(*bytes)).collect()
}

/// The numbers of an array after its head; none if it is left out, without reading its data.
fn numeric<R: Read>(
    elements: &mut Elements<R>,
    head: &MatrixHead,
    name: String,
    context: &mut MatContext<'_>,
) -> Result<Option<Array>, ElementFault> {
    let plane = head.plane().filter(|_| head.elements() > 0);
    let Some((rows, columns)) = plane else {
        context.notices.left_out(name, "it has more than two dimensions, or no elements");
        return Ok(None);
    };
    let (vector, asked) = (rows == 1 || columns == 1, context.options.sample_axis);
    let plane = (rows, columns);
    let layout = Layout::of(context.file, &name, vector, plane, false, asked, context.notices)?;
    let bytes = head.elements().saturating_mul(if head.complex { 16 } else { 8 });
    let bytes = bytes.saturating_add(layout.channels.saturating_mul(512));
    context.budget.take(bytes, context.place, "the samples of the arrays")?;
    let (number, tag) = part(elements, head)?;
    let types = (number, elements.endian);
    let mut columns = if head.complex {
        let room = layout.samples as usize;
        let zeros = vec![Complex64::ZERO; room];
        let mut columns = vec![zeros; layout.channels as usize];
        elements.with_data(tag, |data| parts(layout, types, data, &mut columns, false))?;
        let (number, tag) = part(elements, head)?;
        let types = (number, types.1);
        elements.with_data(tag, |data| parts(layout, types, data, &mut columns, true))?;
        columns.into_iter().map(Samples::Complex).collect()
    } else {
        elements.with_data(tag, |mut data| layout.read(types, false, &mut data))?
    };
    columns.shrink_to_fit();
    // Floating-point numbers may be stored as integers, with exact steps.
    Ok(Some(Array { name, columns, epsilon: number.epsilon() }))
}

/// The tag of the real or the imaginary part, as long as the array.
fn part<R: Read>(
    elements: &mut Elements<R>,
    head: &MatrixHead,
) -> Result<(NumberType, Tag), ElementFault> {
    let tag = elements.tag()?;
    let number = match tag.kind {
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
            let expected = "1 to 7, 9, 12, 13";
            return Err(ElementFault::unexpected("the type of numbers", other, expected));
        }
    };
    let needed = head.elements().saturating_mul(number.size() as u64);
    if needed != u64::from(tag.length) {
        let found = format!("{} bytes for {} elements", tag.length, head.elements());
        let expected = "the length of its dimensions";
        return Err(ElementFault::unexpected("the length of an array", found, expected));
    }
    Ok((number, tag))
}

/// Fills the real or imaginary parts of `columns`.
fn parts(
    layout: Layout,
    (number, endian): (NumberType, Endian),
    mut data: &mut dyn Read,
    columns: &mut [Vec<Complex64>],
    imaginary: bool,
) -> std::io::Result<()> {
    const PIECE: usize = 1024;
    let (samples, channels) = (layout.samples as usize, columns.len());
    let total = samples * channels;
    let (mut values, mut done) = (Vec::with_capacity(PIECE), 0);
    while done < total {
        values.clear();
        number.read(endian, &mut data, PIECE.min(total - done), &mut values)?;
        for value in &values {
            let (channel, sample) = if layout.contiguous {
                (done / samples, done % samples)
            } else {
                (done % channels, done / channels)
            };
            let point = &mut columns[channel][sample];
            *(if imaginary { &mut point.im } else { &mut point.re }) = *value;
            done += 1;
        }
    }
    Ok(())
}

/// The numeric fields of a structure after its head.
fn structure<R: Read>(
    elements: &mut Elements<R>,
    head: &MatrixHead,
    context: &mut MatContext<'_>,
) -> Result<Vec<Array>, ElementFault> {
    const MOST_NAMES: u32 = 1 << 16;
    let tag = elements.tag()?;
    let length = elements.bytes(tag, 4)?;
    let length = words(&length, elements.endian).first().copied().unwrap_or(0);
    if length == 0 || length > LONGEST_NAME {
        return Err(ElementFault::unexpected("the length of field names", length, "1 to 1024"));
    }
    let tag = elements.tag()?;
    let names = elements.bytes(tag, MOST_NAMES)?;
    let mut found = Vec::new();
    for name in names.chunks_exact(length as usize) {
        let end = name.iter().position(|byte| *byte == 0).unwrap_or(name.len());
        let name = format!("{}.{}", head.name, String::from_utf8_lossy(&name[..end]));
        let tag = elements.tag()?;
        if tag.kind != MATRIX {
            return Err(ElementFault::unexpected("a field's type", tag.kind, "14, a matrix"));
        }
        if tag.length == 0 {
            continue;
        }
        // The unused rest of a field is skipped.
        let after = elements.left.saturating_sub(u64::from(tag.length));
        let field = MatrixHead::read(elements)?;
        if NUMERIC.contains(&field.class) {
            found.extend(numeric(elements, &field, name, context)?);
        } else {
            context.notices.left_out(name, "it is not an array of numbers");
        }
        elements.skip_to(after)?;
    }
    Ok(found)
}
