//! The numbers of dataset 58 as text.

use num_complex::Complex64;

use crate::MeasureError;
use crate::source::{Position, Source};
use crate::uff::binary::Values;
use crate::uff::fields::real;
use crate::uff::index::{Data, FunctionEntry};

/// Position in the printed numbers of a function.
#[derive(Debug)]
pub(crate) struct Printed {
    position: Position,
    /// Values of the last line of the next block.
    pending: Vec<f64>,
    line: Vec<u8>,
    /// Widths of the values of one point, for fields without blanks between them.
    widths: Vec<usize>,
    complex: bool,
    even: bool,
}

/// Widths of E13.5 and E20.12.
const SINGLE: usize = 13;
const DOUBLE: usize = 20;

impl Printed {
    /// The first number of a function; none if its numbers are binary.
    pub(crate) fn of(entry: &FunctionEntry) -> Option<Self> {
        let Data::Printed(position) = entry.data else { return None };
        let header = &entry.header;
        let value = if header.double { DOUBLE } else { SINGLE };
        let mut widths = if header.even { vec![] } else { vec![SINGLE] };
        widths.extend([value].repeat(1 + usize::from(header.complex)));
        let (complex, even) = (header.complex, header.even);
        Some(Self { position, pending: Vec::new(), line: Vec::new(), widths, complex, even })
    }

    /// Appends the next `count` points.
    pub(crate) fn read(
        &mut self,
        source: &mut Source<'_>,
        count: usize,
        values: &mut Values,
    ) -> Result<(), MeasureError> {
        source.resume(self.position)?;
        let per_point = self.widths.len();
        let mut left = count;
        loop {
            let ready = (self.pending.len() / per_point).min(left);
            for point in self.pending[..ready * per_point].chunks_exact(per_point) {
                let ordinate = if self.even { point } else { &point[1..] };
                if !self.even {
                    values.abscissae.push(point[0]);
                }
                if self.complex {
                    values.complex.push(Complex64::new(ordinate[0], ordinate[1]));
                } else {
                    values.real.push(ordinate[0]);
                }
            }
            self.pending.drain(..ready * per_point);
            left -= ready;
            if left == 0 {
                break;
            }
            self.next_line(source, left)?;
        }
        self.position = source.mark();
        Ok(())
    }

    /// Checks that only the closing tag remains.
    pub(crate) fn close(&mut self, source: &mut Source<'_>) -> Result<(), MeasureError> {
        source.resume(self.position)?;
        let place = source.line_place();
        if !self.pending.is_empty() {
            let found = format!("{} values too many", self.pending.len());
            let expected = "as many numbers as announced points";
            return Err(source.malformed(place, "the data", &found, expected));
        }
        loop {
            let more = source.read_line(&mut self.line)?;
            match self.line.trim_ascii() {
                b"" if more => {}
                b"-1" => return Ok(()),
                _ => {
                    let found = String::from_utf8_lossy(&self.line).into_owned();
                    let place = source.line_place();
                    let expected = "`    -1` after the announced points";
                    return Err(source.malformed(place, "the closing tag", &found, expected));
                }
            }
        }
    }

    /// Appends the values of the next line to those pending.
    fn next_line(&mut self, source: &mut Source<'_>, left: usize) -> Result<(), MeasureError> {
        let more = source.read_line(&mut self.line)?;
        let place = source.line_place();
        if !more || self.line.trim_ascii() == b"-1" {
            let expected = format!("numbers for {left} more points");
            return Err(source.malformed(place, "the data", "their end", expected));
        }
        let before = self.pending.len();
        if !apart(&self.line, &mut self.pending) {
            self.pending.truncate(before);
            if !touching(&self.line, &self.widths, before, &mut self.pending) {
                let found = String::from_utf8_lossy(&self.line).into_owned();
                let expected = "numbers in fields of 13 or 20 columns";
                return Err(source.malformed(place, "a line of data", &found, expected));
            }
        }
        Ok(())
    }
}

/// Numbers separated by blanks.
fn apart(line: &[u8], values: &mut Vec<f64>) -> bool {
    let mut tokens = line.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty());
    tokens.all(|token| {
        let number = std::str::from_utf8(token).ok().and_then(real);
        values.extend(number);
        number.is_some()
    })
}

/// Numbers in fields of fixed width, after `before` values of a point on earlier lines.
fn touching(line: &[u8], widths: &[usize], before: usize, values: &mut Vec<f64>) -> bool {
    let mut rest = line.trim_ascii_end();
    for width in widths.iter().cycle().skip(before % widths.len()) {
        if rest.is_empty() {
            break;
        }
        let (field, after) = rest.split_at((*width).min(rest.len()));
        let number = std::str::from_utf8(field.trim_ascii()).ok().and_then(real);
        let Some(number) = number else { return false };
        values.push(number);
        rest = after;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_that_touch_are_cut_by_width() {
        let line = b"-1.47553E-002-1.72957E-002 -1.66101-102";
        let mut values = Vec::new();
        assert!(!apart(line, &mut values), "two numbers in one word are none");
        values.clear();
        assert!(touching(line, &[13], 0, &mut values));
        assert_eq!(values, [-1.47553e-2, -1.72957e-2, -1.66101e-102]);
        values.clear();
        let uneven = b"  1.00000E+00 -1.000000000000E-01  2.00000E+00-1.0000000000000E-01";
        assert!(touching(uneven, &[13, 20], 0, &mut values));
        assert_eq!(values, [1.0, -0.1, 2.0, -0.1]);
    }
}
