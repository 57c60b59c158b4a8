//! NumPy arrays in a zip archive (`.npz`).
//!
//! Arrays are decompressed whole, one after the other, since a zip archive cannot be
//! read in blocks of several arrays at once. The memory needed is limited by the size of the file.

mod write;

use std::io::Read;

use zip::ZipArchive;

use crate::arrays::{Array, Layout, records};
use crate::decoding::{Budget, DecodedRecords};
use crate::notice::Notices;
use crate::npy::NpyHeader;
use crate::source::Source;
use crate::{FilePosition, Format, MeasureError, ReadOptions};

pub(crate) use write::write;

/// Reads every array of the archive.
pub(crate) fn open(
    source: Source<'_>,
    options: &ReadOptions,
    notices: &mut Notices,
) -> Result<DecodedRecords, MeasureError> {
    let mut budget = Budget::new(&source, options);
    let file = source.name().to_owned();
    let length = source.len();
    let wrong = |place, quantity, found: &str, expected: &str| {
        MeasureError::malformed(&file, place, quantity, crate::error::excerpt(found), expected)
    };
    let start = FilePosition::Offset(0);
    let mut archive = ZipArchive::new(source)
        .map_err(|error| wrong(start, "the archive", &error.to_string(), "a zip archive"))?;
    // An entry takes 76 bytes in the archive at least.
    if archive.len() as u64 > length / 76 {
        let found = archive.len().to_string();
        let expected = "at most one for 76 bytes of the file";
        return Err(wrong(start, "the number of arrays", &found, expected));
    }
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        let mut entry = archive
            .by_index(index)
            .map_err(|error| wrong(start, "an entry", &error.to_string(), "an array"))?;
        let place = FilePosition::Offset(entry.data_start().unwrap_or(0));
        let name = entry.name().map(std::borrow::Cow::into_owned);
        let name = name.map_err(|error| {
            wrong(start, "an entry's name", &error.to_string(), "UTF-8 or code page 437")
        })?;
        let Some(name) = name.strip_suffix(".npy").map(str::to_owned) else {
            notices.left_out(name, "it is not an array of NumPy");
            continue;
        };
        let wrong_here =
            |quantity, found: &str, expected: &'static str| wrong(place, quantity, found, expected);
        let read = |error: std::io::Error| {
            wrong(place, "an array", &error.to_string(), "as many bytes as its header announces")
        };
        let header = NpyHeader::read(|buffer| entry.read_exact(buffer).map_err(read), &wrong_here);
        let header = match header {
            Ok(header) => header,
            Err(MeasureError::Malformed { quantity: "the type of the array", .. }) => {
                notices.left_out(name, "its elements are not numbers");
                continue;
            }
            Err(error) => return Err(error),
        };
        let Some(plane) = header.plane().filter(|(rows, columns)| *rows > 0 && *columns > 0) else {
            notices.left_out(name, "it has more than two dimensions, or no elements");
            continue;
        };
        let elements = plane.0.saturating_mul(plane.1);
        let parts = 1 + u64::from(header.complex);
        // Complex numbers are paired after reading, which takes twice their size.
        let bytes = elements.saturating_mul(8 * parts * parts);
        budget.take(bytes, place, "the samples of the arrays")?;
        let (vector, row_major) = (header.shape.len() < 2, !header.fortran);
        let asked = options.sample_axis;
        let layout = Layout::of(&file, &name, vector, plane, row_major, asked, notices)?;
        budget.take(layout.channels.saturating_mul(512), place, "the channels of the arrays")?;
        let types = (header.number, header.endian);
        let columns = layout.read(types, header.complex, &mut entry).map_err(read)?;
        arrays.push(Array { name, columns, epsilon: header.number.epsilon() });
    }
    Ok(DecodedRecords::new(Format::Npz, records(&file, arrays, ':', options, notices)?))
}
