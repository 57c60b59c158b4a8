//! Writing of records to complete files.

use std::path::Path;

use crate::whole_file::write_whole;
use crate::{Abscissa, Channel, Format, MeasureError, Record, WriteOptions};

/// Writes `records` to the file `path` in `format`: universal (58 or 58b, after
/// datasets 151 and 164), text (CSV) or NPZ.
///
/// A record that continues the previous record becomes part of it. Samples are written
/// in their unit; names, units and axes can be read back. Universal files and NPZ also hold several
/// records.
///
/// # Errors
/// [`MeasureError::NotExpressible`] for channels that the format cannot represent,
/// [`MeasureError::Unsupported`] for a format that is only read, [`MeasureError::Exists`] for an
/// existing file that is not to be [replaced](WriteOptions::replace),
/// [`MeasureError::Io`] for errors of the operating system. An existing file is then unchanged, and
/// no new file remains.
///
/// ```no_run
/// use asperity_measure::{Format, ReadOptions, WriteOptions, read, write};
///
/// let measured = read("hits.tdms".as_ref(), &ReadOptions::default())?;
/// let options = WriteOptions::default();
/// write("hits.uff".as_ref(), &measured.records, Format::UniversalBinary, &options)?;
/// # Ok::<(), asperity_measure::MeasureError>(())
/// ```
pub fn write(
    path: &Path,
    records: &[Record],
    format: Format,
    options: &WriteOptions,
) -> Result<(), MeasureError> {
    let file = path.display().to_string();
    for record in records {
        check(record, format)?;
    }
    let joined = join(records);
    write_whole(path, options.replace, |out| {
        match format {
            Format::UniversalText => crate::uff::write(out, &joined, false, options),
            Format::UniversalBinary => crate::uff::write(out, &joined, true, options),
            Format::Text => crate::text::write(out, &joined),
            Format::Npz => crate::npz::write(out, &joined),
            _ => {
                return Err(MeasureError::Unsupported {
                    file: file.clone(),
                    feature: "this format",
                    instead: "write UFF, CSV or NPZ",
                });
            }
        }
        .map_err(|error| error.at(&file))
    })
}

/// Rejects records with channels of different lengths or invalid axes.
fn check(record: &Record, format: Format) -> Result<(), MeasureError> {
    let refuse = |channel: &Channel, reason| {
        Err(MeasureError::NotExpressible { format, channel: channel.name.clone(), reason })
    };
    for channel in &record.channels {
        let length = channel.samples.len();
        if length == 0 {
            return refuse(channel, "it has no samples");
        }
        match &channel.abscissa {
            Abscissa::Uneven { values, .. } if values.len() != length => {
                return refuse(channel, "its axis is not as long as its samples");
            }
            Abscissa::Even { start, step, .. }
                if !(start.is_finite() && step.is_finite() && *step > 0.0) =>
            {
                return refuse(channel, "its step is not positive and finite");
            }
            _ => {}
        }
    }
    Ok(())
}

/// Groups records with those that continue them.
fn join(records: &[Record]) -> Vec<Vec<&Record>> {
    let mut joined: Vec<Vec<&Record>> = Vec::new();
    for record in records.iter().filter(|record| !record.channels.is_empty()) {
        match joined.last_mut() {
            Some(parts) if record.continues && parts[0].channels.len() == record.channels.len() => {
                parts.push(record);
            }
            _ => joined.push(vec![record]),
        }
    }
    joined
}
