//! Layout of the channels of an array in a file.

use std::io::Read;

use crate::notice::Notices;
use crate::number::{Endian, NumberType};
use crate::{MeasureError, Notice, SampleAxis, Samples};

/// Layout of the channels of an array in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) channels: u64,
    pub(crate) samples: u64,
    /// True for one channel after the other, false for interleaved channels.
    pub(crate) contiguous: bool,
}

impl Layout {
    /// The layout of an array of `rows` by `columns`, in the order of rows (`row_major`) or columns;
    /// of one channel for a `vector`.
    pub(crate) fn of(
        file: &str,
        array: &str,
        vector: bool,
        (rows, columns): (u64, u64),
        row_major: bool,
        asked: Option<SampleAxis>,
        notices: &mut Notices,
    ) -> Result<Self, MeasureError> {
        if vector {
            let samples = rows.saturating_mul(columns);
            return Ok(Self { channels: 1, samples, contiguous: true });
        }
        let by_length = || {
            if rows == columns && rows > 1 {
                let (file, array) = (file.to_owned(), array.to_owned());
                return Err(MeasureError::SampleAxis { file, array, rows, columns });
            }
            Ok(if rows > columns { SampleAxis::First } else { SampleAxis::Last })
        };
        let axis = asked.map_or_else(by_length, Ok)?;
        if asked.is_none() && rows > 1 && columns > 1 && rows.max(columns) < 16 * rows.min(columns)
        {
            let axis = usize::from(axis == SampleAxis::Last);
            notices.add(Notice::SampleAxisByLength { array: array.to_owned(), axis });
        }
        let (samples, channels) =
            if axis == SampleAxis::First { (rows, columns) } else { (columns, rows) };
        let contiguous = row_major == (axis == SampleAxis::Last);
        Ok(Self { channels, samples, contiguous })
    }

    /// Real or complex samples from `reader`, by channels. The caller has checked the memory needed.
    pub(crate) fn read(
        self,
        (number, endian): (NumberType, Endian),
        complex: bool,
        reader: &mut impl Read,
    ) -> std::io::Result<Vec<Samples>> {
        let (parts, samples) = (if complex { 2 } else { 1 }, self.samples as usize);
        let column = |_| Vec::with_capacity(samples * parts);
        let mut columns: Vec<Vec<f64>> = (0..self.channels).map(column).collect();
        if self.contiguous {
            for column in &mut columns {
                number.read(endian, reader, samples * parts, column)?;
            }
        } else {
            deinterleave((number, endian), reader, samples, parts, &mut columns)?;
        }
        Ok(columns.into_iter().map(|column| Samples::of_parts(column, complex)).collect())
    }
}

/// Reads `samples` interleaved samples of all `columns`, each of `parts` numbers.
pub(crate) fn deinterleave(
    (number, endian): (NumberType, Endian),
    reader: &mut impl Read,
    samples: usize,
    parts: usize,
    columns: &mut [Vec<f64>],
) -> std::io::Result<()> {
    const PIECE: usize = 1024;
    let (count, total) = (columns.len(), samples * parts * columns.len());
    let (mut values, mut done) = (Vec::with_capacity(PIECE), 0);
    while done < total {
        values.clear();
        number.read(endian, reader, PIECE.min(total - done), &mut values)?;
        for value in &values {
            columns[done / parts % count].push(*value);
            done += 1;
        }
    }
    Ok(())
}
