//! Files of one format to files of another.

use std::path::Path;

use asperity_measure::{
    ChannelUnit, Format, Measurement, Notice, ReadOptions, WriteOptions, read, write,
};

use crate::error::AnalysisError;
use crate::options::wrong;

/// What [`convert`] did.
#[derive(Debug, Clone, PartialEq)]
pub struct Conversion {
    /// Format read.
    pub from: Format,
    /// Format written.
    pub to: Format,
    /// Records written.
    pub records: usize,
    /// What the reader took upon itself.
    pub notices: Vec<Notice>,
}

/// The format that `name` says: `uff`, `uff-ascii`, `csv` or `npz`.
///
/// # Errors
/// [`AnalysisError::Option`] for anything else.
pub fn written_format(option: &'static str, name: &str) -> Result<Format, AnalysisError> {
    match name {
        "uff" => Ok(Format::UniversalBinary),
        "uff-ascii" => Ok(Format::UniversalText),
        "csv" => Ok(Format::Text),
        "npz" => Ok(Format::Npz),
        _ => Err(wrong(option, name, "uff, uff-ascii, csv, npz")),
    }
}

/// Reads `from` and writes it to `to`, in `format` or the one of its extension;
/// `in_si` converts all channels to SI first.
///
/// The whole file is held in memory.
///
/// # Errors
/// [`AnalysisError`] where it cannot be read, a unit to convert is not known,
/// or the format cannot be written or cannot hold it.
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
        wrong("OUT", &found, "a name that ends in .uff, .unv, .csv, .txt or .npz, or --to FORMAT")
    })?;
    let measured = read(from, options).map_err(|error| crate::stream::named(error, from))?;
    let Measurement { format, mut records, notices } = measured;
    if in_si {
        for channel in records.iter_mut().flat_map(|record| &mut record.channels) {
            if !matches!(channel.unit, ChannelUnit::Known(_)) {
                return Err(AnalysisError::Unit {
                    file: from.to_owned(),
                    channel: channel.name.clone(),
                    text: channel.unit.text().to_owned(),
                });
            }
            channel.to_si()?;
        }
    }
    write(to, &records, to_format, &WriteOptions::default())?;
    Ok(Conversion { from: format, to: to_format, records: records.len(), notices })
}
