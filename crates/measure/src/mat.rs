//! MATLAB files of versions 5 to 7.
//!
//! Source: MathWorks, "MAT-File Format" (R2019b), level 5. Numeric arrays,
//! real or complex, in either byte order, compressed or not, and the fields of
//! structures one level deep, named `structure.field`. Other variables are left out with a notice.
//!
//! | module | contents |
//! |---|---|
//! | `element` | tags, lengths and padding |
//! | `matrix` | numeric arrays and structures |

mod element;
mod matrix;

use flate2::read::ZlibDecoder;
use std::io::Read;

use crate::arrays::{Array, records};
use crate::decoding::{Budget, DecodedRecords};
use crate::notice::Notices;
use crate::number::Endian;
use crate::source::Source;
use crate::{FilePosition, Format, MeasureError, ReadOptions};

use element::{ElementFault, Elements, Tag};
use matrix::{MATRIX, MatContext};

/// Type of a compressed element, at the outermost level.
const COMPRESSED: u32 = 15;

/// Reads every numeric array of the file.
pub(crate) fn open(
    mut source: Source<'_>,
    options: &ReadOptions,
    notices: &mut Notices,
) -> Result<DecodedRecords, MeasureError> {
    let file = source.name().to_owned();
    let mut budget = Budget::new(&source, options);
    let mut header = [0; 128];
    source.read_exact(&mut header, "the MAT header")?;
    let endian = if &header[126..] == b"IM" { Endian::Little } else { Endian::Big };
    let version = match endian {
        Endian::Little => u16::from_le_bytes([header[124], header[125]]),
        Endian::Big => u16::from_be_bytes([header[124], header[125]]),
    };
    if version != 0x0100 {
        let place = FilePosition::Offset(124);
        return Err(source.malformed(place, "the MAT version", &version.to_string(), "256"));
    }
    let mut arrays: Vec<Array> = Vec::new();
    while source.remaining() > 0 {
        let place = source.place();
        let mut bytes = [0; 8];
        source.read_exact(&mut bytes, "an element's tag")?;
        let tag = Tag::parse(bytes, endian);
        let Some(tag) = tag.filter(|tag| !tag.is_small()) else {
            let found = format!("{bytes:02x?}");
            return Err(source.malformed(place, "an element's tag", &found, "type and length"));
        };
        let length = u64::from(tag.length);
        source.need(length, "an element")?;
        let end = source.position() + length;
        let mut context = MatContext { options, notices, budget: &mut budget, file: &file, place };
        let found: Result<Vec<Array>, ElementFault> = match tag.kind {
            MATRIX => {
                let mut elements = Elements::new((&mut source).take(length), endian, length);
                matrix::read(&mut elements, &mut context)
            }
            COMPRESSED => {
                let unfolded = ZlibDecoder::new((&mut source).take(length));
                let mut elements = Elements::new(unfolded, endian, u64::MAX);
                elements.tag().and_then(|inner| {
                    if inner.kind != MATRIX {
                        return Ok(Vec::new());
                    }
                    elements.left = u64::from(inner.length);
                    matrix::read(&mut elements, &mut context)
                })
            }
            _ => Ok(Vec::new()),
        };
        arrays.extend(found.map_err(|fault| fault.at(&file, place))?);
        source.seek_to(end)?;
    }
    Ok(DecodedRecords::new(Format::Mat, records(&file, arrays, '.', options, notices)?))
}
