//! Conversion of measurement files.

use std::io::ErrorKind;
use std::path::Path;

use asperity_measure::{
    Format, MeasureError, Measurement, MeasurementSource, Notice, ReadOptions, WriteOptions, read,
    write,
};

use crate::error::AnalysisError;
use crate::frf_record::parts;
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

/// Options of [`convert`].
#[derive(Debug, Clone, Default)]
pub struct ConvertOptions {
    /// Properties that the file does not give.
    pub reading: ReadOptions,
    /// Format of the output; by default the format of its extension.
    pub format: Option<Format>,
    /// Converts all channels to SI units.
    pub in_si: bool,
    /// Replaces an existing file, which is an error otherwise.
    pub replace: bool,
}

/// Converts the file `from` to the file `to`, in another format or other units.
///
/// The whole file is held in memory, so that at most [`MAX_CONVERTED_BYTES`] are accepted.
///
/// # Errors
/// [`AnalysisError`] for a file that cannot be read, an unknown unit to convert, a format that
/// cannot be written or cannot represent the records, an existing file that is not to be replaced,
/// and for the input as output.
///
/// ```
/// use asperity_experiment::{ConvertOptions, convert};
///
/// let folder = tempfile::tempdir()?;
/// let (csv, uff) = (folder.path().join("hit.csv"), folder.path().join("hit.uff"));
/// std::fs::write(&csv, "time_s,hammer (N),top (mm/s)\n0,0,0\n0.001,5,1\n0.002,0,2\n")?;
/// let conversion = convert(&csv, &uff, &ConvertOptions { in_si: true, ..Default::default() })?;
/// assert_eq!(conversion.records, 1);
/// assert!(convert(&csv, &uff, &ConvertOptions::default()).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn convert(
    from: &Path,
    to: &Path,
    options: &ConvertOptions,
) -> Result<Conversion, AnalysisError> {
    let extension = to.extension().map(|text| text.to_string_lossy().into_owned());
    let of_name = || extension.as_deref().and_then(Format::of_extension);
    let to_format = options.format.or_else(of_name).ok_or_else(|| {
        let found = to.display().to_string();
        let expected = "a name that ends in .uff, .unv, .csv, .txt or .npz, or a format";
        AnalysisError::Setting { name: "the output file", found, expected }
    })?;
    // Before the work; the writer sees a file that appears meanwhile.
    if let (Ok(input), Ok(output)) = (from.canonicalize(), to.canonicalize()) {
        if input == output {
            return Err(AnalysisError::SameFile { path: to.to_owned() });
        }
        if output.is_file() && !options.replace {
            return Err(MeasureError::Exists { file: to.display().to_string() }.into());
        }
    }
    check_size(&[MeasurementSource::File(from.to_owned())], MAX_CONVERTED_BYTES)?;
    let measured = read(from, &options.reading).map_err(|error| measure_error(error, from))?;
    let Measurement { format, mut records, notices } = measured;
    if options.in_si {
        for channel in records.iter_mut().flat_map(|record| &mut record.channels) {
            if channel.unit.known().is_none() {
                return Err(AnalysisError::unit(from, channel));
            }
            channel.to_si()?;
        }
    }
    if to_format == Format::Text {
        for record in &mut records {
            record.channels =
                std::mem::take(&mut record.channels).into_iter().flat_map(parts).collect();
        }
    }
    let writing = WriteOptions { replace: options.replace, ..WriteOptions::default() };
    write(to, &records, to_format, &writing).map_err(|error| match error {
        MeasureError::Io { source, .. } if source.kind() != ErrorKind::InvalidInput => {
            AnalysisError::Write { path: to.to_owned(), source }
        }
        other => other.into(),
    })?;
    Ok(Conversion { from: format, to: to_format, records: records.len(), notices })
}
