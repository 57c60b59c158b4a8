//! Files that are whole or absent.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

/// First characters of the name of a file that is being written.
const BEGUN: &str = ".new-";

/// True for the name of a file that is being written, or was when its writer was killed.
pub(super) fn is_temporary(name: &OsStr) -> bool {
    name.to_str().is_some_and(|name| name.starts_with(BEGUN))
}

/// Writes a file under another name, brings it to the disk and renames it: it is whole or absent.
pub(super) fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    // Shards on several machines do not meet in one name: the file must be new.
    builder.prefix(BEGUN);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Those of a new file; temporary files are private to their owner.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut temporary = builder.tempfile_in(folder)?;
    let mut file = BufWriter::new(temporary.as_file_mut());
    write(&mut file)?;
    file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
    temporary.persist(path).map_err(|error| error.error)?;
    // The name itself; a folder cannot be opened everywhere.
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
