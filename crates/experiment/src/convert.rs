//! Conversion of measurement files.

use std::io::ErrorKind;
use std::path::Path;

use asperity_measure::{
    Format, MeasureError, Measurement, Notice, ReadOptions, WriteOptions, read, write,
};

use crate::error::AnalysisError;
use crate::input_size::{MAX_CONVERTED_BYTES, check_size};
use crate::stream::measure_error;

/// Result of [`convert`].
#[derive(Debug, Clone, PartialEq)]
pub struct Conversion {
    /// Format of the input.
    pub from: Format,
    /// Format of the output.
    pub to: Format,
    /// Number of records.
    pub records: usize,
    /// Assumptions of the reader.
    pub notices: Vec<Notice>,
}

/// Converts a file to another format: `format`, or that of the extension of `to`.
///
/// With `in_si` all channels are converted to SI units. The whole file is held in memory, so
/// that at most [`MAX_CONVERTED_BYTES`] are accepted.
///
/// # Errors
/// [`AnalysisError`] for a file that cannot be read, an unknown unit to convert, and a format that
/// cannot be written or cannot represent the records.
///
/// ```
/// use asperity_experiment::convert;
/// use asperity_measure::ReadOptions;
///
/// let folder = tempfile::tempdir()?;
/// let (csv, uff) = (folder.path().join("hit.csv"), folder.path().join("hit.uff"));
/// std::fs::write(&csv, "time_s,hammer (N),top (mm/s)\n0,0,0\n0.001,5,1\n0.002,0,2\n")?;
/// let conversion = convert(&csv, &uff, None, true, &ReadOptions::default())?;
/// assert_eq!(conversion.records, 1);
/// assert!(uff.exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn convert(
    from: &Path,
    to: &Path,
    format: Option<Format>,
    in_si: bool,
    options: &ReadOptions,
) -> Result<Conversion, AnalysisError> {
    let extension = to.extension().map(|text| text.to_string_lossy().into_owned());
    let of_name = || extension.as_deref().and_then(Format::of_extension);
    let to_format = format.or_else(of_name).ok_or_else(|| {
        let found = to.display().to_string();
        let expected = "a name that ends in .uff, .unv, .csv, .txt or .npz, or a format";
        AnalysisError::Setting { name: "the output file", found, expected }
    })?;
    check_size(&[from], MAX_CONVERTED_BYTES)?;
    let measured = read(from, options).map_err(|error| measure_error(error, from))?;
    let Measurement { format, mut records, notices } = measured;
    if in_si {
        for channel in records.iter_mut().flat_map(|record| &mut record.channels) {
            if channel.unit.known().is_none() {
                return Err(AnalysisError::unit(from, channel));
            }
            channel.to_si()?;
        }
    }
    write(to, &records, to_format, &WriteOptions::default()).map_err(|error| match error {
        MeasureError::Io { source, .. } if source.kind() != ErrorKind::InvalidInput => {
            AnalysisError::Write { path: to.to_owned(), source }
        }
        other => other.into(),
    })?;
    Ok(Conversion { from: format, to: to_format, records: records.len(), notices })
}
