//! The numbers of dataset 58b.
//!
//! Their length is the number of points times their size: the data may contain the bytes of a
//! closing tag, and some writers of complex data give a wrong byte count. The closing tag must
//! follow.

use num_complex::Complex64;

use crate::notice::Notices;
use crate::number::{Endian, NumberType};
use crate::source::Source;
use crate::uff::fields::integer;
use crate::uff::header::FunctionHeader;
use crate::{FilePosition, MeasureError, Notice};

/// The numbers of some points of a function.
pub(crate) struct Values {
    pub(crate) abscissae: Vec<f64>,
    pub(crate) real: Vec<f64>,
    pub(crate) complex: Vec<Complex64>,
}

impl Values {
    /// Space for `count` points, a number the caller has checked.
    pub(crate) fn for_points(count: usize, even: bool, complex: bool) -> Self {
        Self {
            abscissae: Vec::with_capacity(if even { 0 } else { count }),
            real: Vec::with_capacity(if complex { 0 } else { count }),
            complex: Vec::with_capacity(if complex { count } else { 0 }),
        }
    }
}

/// Position and type of binary numbers.
#[derive(Debug)]
pub(crate) struct Payload {
    offset: u64,
    endian: Endian,
    value: NumberType,
    abscissa: Option<NumberType>,
    complex: bool,
}

impl Payload {
    /// Relative rounding of the abscissae of an uneven function.
    pub(crate) fn abscissa_epsilon(&self) -> f64 {
        self.abscissa.map_or(0.0, NumberType::epsilon)
    }

    /// The payload of the fields after `58b` in the line at `place`; reads up to the closing tag.
    pub(crate) fn locate(
        source: &mut Source<'_>,
        place: FilePosition,
        fields: &str,
        header: &FunctionHeader,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        let fields: Vec<&str> = fields.split_ascii_whitespace().collect();
        let field = |index: usize| fields.get(index).copied().unwrap_or_default();
        let wrong =
            |quantity, index, expected| source.malformed(place, quantity, field(index), expected);
        let endian = match field(0) {
            "1" => Endian::Little,
            "2" => Endian::Big,
            _ => return Err(wrong("the byte order", 0, "1 (little endian) or 2 (big endian)")),
        };
        if !matches!(field(1), "2" | "0" | "") {
            return Err(wrong("the floating-point format", 1, "2 (IEEE 754)"));
        }
        if !matches!(field(2), "11" | "0" | "") {
            return Err(wrong("the number of header lines", 2, "11"));
        }
        let announced = integer(field(3)).and_then(|count| u64::try_from(count).ok());
        let announced = announced.ok_or_else(|| wrong("the byte count", 3, "a count"))?;

        let value = if header.double { NumberType::F64 } else { NumberType::F32 };
        // Abscissae of uneven double data may be single or double.
        let abscissae = match (header.even, header.double) {
            (true, _) => vec![None],
            (false, false) => vec![Some(NumberType::F32)],
            (false, true) => vec![Some(NumberType::F64), Some(NumberType::F32)],
        };
        let offset = source.position();
        let candidates = abscissae.into_iter().map(|abscissa| {
            let complex = header.complex;
            Self { offset, endian, value, abscissa, complex }
        });
        let mut first_need = None;
        for payload in candidates {
            let taken = header.points.saturating_mul(payload.point_size());
            first_need.get_or_insert(taken);
            if taken > source.len() - offset {
                continue;
            }
            // Padding up to the announced end is skipped.
            for end in [taken, announced.max(taken)] {
                if end <= source.len() - offset && after_tag(source, offset + end)? {
                    if announced != 0 && announced != taken {
                        let place = FilePosition::Offset(offset);
                        notices.add(Notice::ByteCount { place, announced, taken });
                    }
                    return Ok(payload);
                }
            }
        }
        let taken = first_need.unwrap_or(0);
        source.seek_to(offset)?;
        source.need(taken, "the numbers of the announced points")?;
        let expected = format!(
            "`    -1` after {} points in {taken} bytes ({announced} announced)",
            header.points
        );
        let mut found = [0; 8];
        source.seek_to(offset + taken)?;
        let length = source.peek(&mut found)?;
        let found = String::from_utf8_lossy(&found[..length]).into_owned();
        let place = FilePosition::Offset(offset + taken);
        Err(source.malformed(place, "the closing tag", &found, expected))
    }

    fn point_size(&self) -> u64 {
        let value = self.value.size() * (1 + usize::from(self.complex));
        (value + self.abscissa.map_or(0, NumberType::size)) as u64
    }

    /// Appends `count` points from point `from`.
    pub(crate) fn read(
        &self,
        source: &mut Source<'_>,
        from: u64,
        count: usize,
        values: &mut Values,
    ) -> Result<(), MeasureError> {
        source.seek_to(self.offset + from * self.point_size())?;
        if self.abscissa.is_none() && !self.complex {
            source.need((count * self.value.size()) as u64, "the numbers")?;
            let read = self.value.read(self.endian, source, count, &mut values.real);
            return read.map_err(|error| source.io(error));
        }
        let size = self.point_size() as usize;
        let mut piece = [0; 1 << 13];
        let per_piece = piece.len() / size;
        let (mut left, mut parts) = (count, Vec::with_capacity(2));
        while left > 0 {
            let now = left.min(per_piece);
            let bytes = &mut piece[..now * size];
            source.read_exact(bytes, "the numbers")?;
            for point in bytes.chunks_exact(size) {
                let mut ordinate = point;
                if let Some(abscissa) = self.abscissa {
                    let (head, rest) = point.split_at(abscissa.size());
                    abscissa.decode(self.endian, head, &mut values.abscissae);
                    ordinate = rest;
                }
                if self.complex {
                    parts.clear();
                    self.value.decode(self.endian, ordinate, &mut parts);
                    values.complex.push(Complex64::new(parts[0], parts[1]));
                } else {
                    self.value.decode(self.endian, ordinate, &mut values.real);
                }
            }
            left -= now;
        }
        Ok(())
    }
}

/// True for a closing tag at `position`, possibly after an end of line; the source is then after it.
fn after_tag(source: &mut Source<'_>, position: u64) -> Result<bool, MeasureError> {
    source.seek_to(position)?;
    let mut around = [0; 16];
    let length = source.peek(&mut around)?;
    let around = &around[..length];
    let blanks = around.iter().take_while(|byte| b"\r\n ".contains(byte)).count();
    let Some(rest) = around[blanks..].strip_prefix(b"-1") else { return Ok(false) };
    let ends = rest.first().is_none_or(u8::is_ascii_whitespace);
    if ends {
        source.seek_to(position + blanks as u64 + 2)?;
    }
    Ok(ends)
}
