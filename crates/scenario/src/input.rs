//! Opening a file named by the user: a plain file, no larger than expected.

use std::fs::File;
use std::io;
use std::path::Path;

use thiserror::Error;

/// A file that cannot be opened, or that is not what is expected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum InputError {
    /// There is no such file.
    #[error("there is no such file")]
    NotFound,
    /// It is a directory.
    #[error("it is a directory; a file is expected")]
    Directory,
    /// It is neither a file nor a directory, e.g. a pipe.
    #[error("it is not a regular file")]
    NotRegular,
    /// Reading it is not permitted.
    #[error("reading it is not permitted")]
    NotPermitted,
    /// It is larger than any sensible input.
    #[error("it holds {bytes} bytes; at most {most} are accepted")]
    TooLarge {
        /// Its size in bytes.
        bytes: u64,
        /// Most bytes accepted.
        most: u64,
    },
    /// The operating system reports another failure.
    #[error("it cannot be read: {kind}")]
    Unreadable {
        /// What the operating system reports.
        kind: io::ErrorKind,
    },
}

impl From<io::Error> for InputError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound => Self::NotFound,
            io::ErrorKind::IsADirectory => Self::Directory,
            io::ErrorKind::PermissionDenied => Self::NotPermitted,
            kind => Self::Unreadable { kind },
        }
    }
}

/// Opens a regular file of at most `most` bytes, judging by its metadata before
/// anything is read.
///
/// # Errors
/// [`InputError`] says why the file cannot be used.
pub fn open(path: &Path, most: u64) -> Result<File, InputError> {
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(InputError::Directory);
    }
    if !metadata.is_file() {
        return Err(InputError::NotRegular);
    }
    if metadata.len() > most {
        let bytes = metadata.len();
        return Err(InputError::TooLarge { bytes, most });
    }
    Ok(File::open(path)?)
}
