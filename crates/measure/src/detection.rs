//! Detection of the format of a file by its content.

use crate::number::Endian;
use crate::source::Source;
use crate::{Format, MeasureError};

impl Format {
    /// The format of the content of a file, whatever its name.
    ///
    /// # Errors
    /// [`MeasureError::UnknownFormat`], or [`MeasureError::Unsupported`] for
    /// a known format that cannot be read.
    pub(crate) fn of_content(source: &mut Source<'_>) -> Result<Self, MeasureError> {
        let mut start = [0; 4096];
        let length = source.peek(&mut start)?;
        let start = &start[..length];
        let unsupported = |feature, instead| {
            Err(MeasureError::Unsupported { file: source.name().to_owned(), feature, instead })
        };
        if start.starts_with(b"\x93NUMPY") {
            return Ok(Self::Npy);
        }
        if start.starts_with(b"PK\x03\x04") || start.starts_with(b"PK\x05\x06") {
            return Ok(Self::Npz);
        }
        if start.starts_with(b"RIFF") && start.get(8..12) == Some(b"WAVE") {
            return Ok(Self::Wav);
        }
        if start.starts_with(b"RF64") || start.starts_with(b"RIFX") {
            return unsupported("a WAVE file of more than 4 GiB or big endian", "save it as RIFF");
        }
        if start.starts_with(b"TDSm") {
            return Ok(Self::Tdms);
        }
        if start.starts_with(b"TDSh") {
            return unsupported("the index of a TDMS file", "give the `.tdms` file beside it");
        }
        if start.starts_with(b"\x89HDF\r\n\x1a\n") || start.starts_with(b"MATLAB 7.3") {
            return Ok(Self::Hdf5);
        }
        if matches!(start.get(126..128), Some(b"IM" | b"MI")) {
            return Ok(Self::Mat);
        }
        if is_mat_4(start) {
            return unsupported("MATLAB version 4", "save it with `save -v7`");
        }
        if is_universal(start) {
            return Ok(Self::UniversalText);
        }
        if !start.is_empty() && !start.contains(&0) {
            return Ok(Self::Text);
        }
        let file = source.name().to_owned();
        Err(MeasureError::UnknownFormat { file, expected: Self::READABLE })
    }
}

/// True for a line of -1 and one with the number of a dataset.
fn is_universal(start: &[u8]) -> bool {
    let lines = start.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let mut lines = lines.skip_while(|line| line.is_empty());
    if lines.next() != Some(b"-1") {
        return false;
    }
    let number = lines.next().unwrap_or_default();
    let digits = number.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let ends = number.get(digits).is_none_or(|byte| byte.is_ascii_whitespace() || *byte == b'b');
    (1..=5).contains(&digits) && ends
}

/// True for a MAT version 4 matrix: type, rows, columns, complexity and length of a name.
fn is_mat_4(start: &[u8]) -> bool {
    let Some(head) = start.first_chunk::<20>() else { return false };
    let (words, _) = head.as_chunks::<4>();
    [Endian::Little, Endian::Big].into_iter().any(|endian| {
        let word = |index: usize| endian.u32(words[index]);
        let kind = word(0);
        kind / 1000 == u32::from(endian == Endian::Big)
            && kind % 1000 < 100
            && kind % 100 / 10 <= 5
            && kind % 10 <= 2
            && (1..1 << 30).contains(&word(1))
            && (1..1 << 30).contains(&word(2))
            && word(3) <= 1
            && (2..=64).contains(&word(4))
    })
}
