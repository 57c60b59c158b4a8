//! Files of records, which appear whole or not at all.

use std::io::{BufWriter, Write};
use std::path::Path;

use crate::{Abscissa, Channel, Format, MeasureError, Record};

/// What a file is to say beyond its records.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// Title, where the format has room for one and no record gives it.
    pub title: String,
    /// Date as text, for the same.
    pub date: String,
}

/// Writes `records` to the file `path` in `format`: universal (58 or 58b, after
/// datasets 151 and 164), text (CSV) or NPZ.
///
/// A record that continues the one before becomes part of it. Samples go out
/// in the unit that they have; names, units and axes come back from what is
/// written, universal files and NPZ also hold several records.
///
/// # Errors
/// [`MeasureError::NotExpressible`] for what the format cannot hold,
/// [`MeasureError::Unsupported`] for a format that is only read,
/// [`MeasureError::Io`] where the operating system refuses; no file is left
/// behind then, and one that was there before stays as it was.
pub fn write(
    path: &Path,
    records: &[Record],
    format: Format,
    options: &WriteOptions,
) -> Result<(), MeasureError> {
    let file = path.display().to_string();
    let io = |source| MeasureError::Io { file: file.clone(), source };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    for record in records {
        check(record, format)?;
    }
    let joined = join(records);
    let mut temporary = tempfile::Builder::new()
        .prefix(".asperity-")
        .suffix(".tmp")
        .tempfile_in(folder)
        .map_err(io)?;
    let mut out = BufWriter::with_capacity(1 << 16, temporary.as_file_mut());
    match format {
        Format::UniversalText => crate::uff::write(&mut out, &joined, false, options),
        Format::UniversalBinary => crate::uff::write(&mut out, &joined, true, options),
        Format::Text => crate::text::write(&mut out, &joined),
        Format::Npz => crate::npz::write(&mut out, &joined),
        _ => {
            return Err(MeasureError::Unsupported {
                file,
                feature: "this format",
                instead: "it is not written; write UFF, CSV or NPZ",
            });
        }
    }
    .map_err(|error| error.at(&file))?;
    out.flush().map_err(io)?;
    drop(out);
    make_readable(temporary.as_file());
    temporary.persist(path).map_err(|error| io(error.error))?;
    Ok(())
}

/// Temporary files are private to their owner; results are as readable as any new file.
#[cfg(unix)]
fn make_readable(file: &std::fs::File) {
    use std::os::unix::fs::PermissionsExt;
    // Failing this costs nobody but other users their access.
    let _ = file.set_permissions(std::fs::Permissions::from_mode(0o644));
}

#[cfg(not(unix))]
fn make_readable(_: &std::fs::File) {}

/// What can go wrong in a format's writer.
#[derive(Debug)]
pub(crate) enum WriteFault {
    Io(std::io::Error),
    Refused(MeasureError),
}

impl WriteFault {
    fn at(self, file: &str) -> MeasureError {
        match self {
            Self::Io(source) => MeasureError::Io { file: file.to_owned(), source },
            Self::Refused(error) => error,
        }
    }

    /// The format cannot hold the channel.
    pub(crate) fn refused(format: Format, channel: &str, reason: &'static str) -> Self {
        let channel = channel.to_owned();
        Self::Refused(MeasureError::NotExpressible { format, channel, reason })
    }
}

impl From<std::io::Error> for WriteFault {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

/// A record is written as it is read: all channels equally long, with an axis that fits.
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

/// Records with those that continue them.
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

/// The length of channel `index` of joined records.
pub(crate) fn joined_len(parts: &[&Record], index: usize) -> usize {
    parts.iter().map(|part| part.channels[index].samples.len()).sum()
}
