//! Writing of records to complete files.

use std::fs::OpenOptions;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;

use crate::{Abscissa, Channel, Format, MeasureError, Record, WriteOptions};

/// End of the names of unfinished files.
const SUFFIX: &str = ".tmp";

/// Writes `records` to the file `path` in `format`: universal (58 or 58b, after
/// datasets 151 and 164), text (CSV) or NPZ.
///
/// A record that continues the one before becomes part of it. Samples are written
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
    let io = |source| MeasureError::Io { file: file.clone(), source };
    // The file behind a link is replaced, not the link.
    let place = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    if place.exists() && !place.is_file() {
        return Err(io(std::io::Error::new(
            ErrorKind::InvalidInput,
            "only a regular file can be replaced",
        )));
    }
    if place.exists() && !options.replace {
        return Err(MeasureError::Exists { file });
    }
    let folder = match place.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    let prefix = format!(".{name}.asperity-");
    remove_leftovers(folder, &prefix);
    for record in records {
        check(record, format)?;
    }
    let joined = join(records);
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Those of a new file; temporary files are private to their owner.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut temporary = builder.tempfile_in(folder).map_err(io)?;
    // The lock ends with the process; a file system without locks keeps the leftovers of killed ones.
    let _ = temporary.as_file().try_lock();
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
                instead: "write UFF, CSV or NPZ",
            });
        }
    }
    .map_err(|error| error.at(&file))?;
    out.flush().map_err(io)?;
    drop(out);
    temporary.as_file().sync_all().map_err(io)?;
    if options.replace {
        temporary.persist(&place).map_err(|error| io(error.error))?;
        return Ok(());
    }
    temporary.persist_noclobber(&place).map_err(|error| match error.error.kind() {
        ErrorKind::AlreadyExists => MeasureError::Exists { file: file.clone() },
        _ => io(error.error),
    })?;
    Ok(())
}

/// Removes unfinished files that killed runs have left: those that no run has locked.
fn remove_leftovers(folder: &Path, prefix: &str) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with(prefix) && name.ends_with(SUFFIX) {
            let opened = OpenOptions::new().write(true).open(entry.path());
            if opened.is_ok_and(|file| file.try_lock().is_ok()) {
                // One that remains is hidden, and takes space only.
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
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
