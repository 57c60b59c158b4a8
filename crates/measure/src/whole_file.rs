//! Files that appear complete or not at all.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::Path;

use crate::MeasureError;

/// End of the names of unfinished files.
const SUFFIX: &str = ".tmp";

/// Writes the file `path` by `contents`, as a whole or not at all.
///
/// - `replace`: true if an existing file is replaced.
///
/// # Errors
/// [`MeasureError::Exists`] for an existing file that is not to be replaced, [`MeasureError::Io`] for
/// errors of the operating system, and those of `contents`. An existing file is then unchanged, and
/// no new file remains.
pub fn write_whole(
    path: &Path,
    replace: bool,
    contents: impl FnOnce(&mut BufWriter<&mut File>) -> Result<(), MeasureError>,
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
    if place.exists() && !replace {
        return Err(MeasureError::Exists { file });
    }
    let folder = match place.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    let prefix = format!(".{name}.asperity-");
    remove_leftovers(folder, &prefix);
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
    contents(&mut out)?;
    out.flush().map_err(io)?;
    drop(out);
    temporary.as_file().sync_all().map_err(io)?;
    if replace {
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
