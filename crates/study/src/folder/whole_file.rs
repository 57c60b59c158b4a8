//! Files that are whole or absent.

use std::collections::hash_map::RandomState;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::hash::{BuildHasher, Hasher};
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
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let folder = path.parent().unwrap_or(Path::new("."));
    // Shards on several machines must not meet in one name.
    let random = RandomState::new().build_hasher().finish();
    let temporary = folder.join(format!("{BEGUN}{random:016x}-{name}"));
    let written = (|| {
        let mut file = BufWriter::new(File::create(&temporary)?);
        write(&mut file)?;
        file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&temporary, path)?;
        // The name itself; a folder cannot be opened everywhere.
        if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
    })();
    if written.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    written
}
