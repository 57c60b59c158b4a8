//! Opening of an input file: a regular file of limited size.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use thiserror::Error;

/// Error of an input file that cannot be opened or is not acceptable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum InputError {
    /// File that does not exist.
    #[error("there is no such file")]
    NotFound,
    /// Directory.
    #[error("it is a directory; a file is expected")]
    Directory,
    /// Neither a file nor a directory, e.g. a pipe.
    #[error("it is not a regular file")]
    NotRegular,
    /// Missing permission to read.
    #[error("reading it is not permitted")]
    NotPermitted,
    /// Size above the limit.
    #[error("it holds {bytes} bytes; at most {max} are accepted")]
    TooLarge {
        /// Size in bytes.
        bytes: u64,
        /// Largest accepted size in bytes.
        max: u64,
    },
    /// Any other failure that the operating system reports.
    #[error("it cannot be read: {0}")]
    Unreadable(io::ErrorKind),
}

impl From<io::Error> for InputError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound => Self::NotFound,
            io::ErrorKind::IsADirectory => Self::Directory,
            io::ErrorKind::PermissionDenied => Self::NotPermitted,
            kind => Self::Unreadable(kind),
        }
    }
}

/// Reads a text from a file that [`open_input`] accepts.
///
/// # Errors
/// [`InputError`] as of [`open_input`], and for a text that is not UTF-8.
pub fn read_text(path: &Path, max_bytes: u64) -> Result<String, InputError> {
    let mut text = String::new();
    open_input(path, max_bytes)?.take(max_bytes).read_to_string(&mut text)?;
    Ok(text)
}

/// Opens a regular file of at most `max_bytes`, checked by its metadata before anything is read.
///
/// # Errors
/// [`InputError`] for a file that does not exist, is not regular, is too large or cannot be read.
///
/// ```
/// use asperity_scenario::{InputError, open_input};
///
/// assert_eq!(open_input("no-such-file".as_ref(), 1024).unwrap_err(), InputError::NotFound);
/// ```
pub fn open_input(path: &Path, max_bytes: u64) -> Result<File, InputError> {
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(InputError::Directory);
    }
    if !metadata.is_file() {
        return Err(InputError::NotRegular);
    }
    if metadata.len() > max_bytes {
        return Err(InputError::TooLarge { bytes: metadata.len(), max: max_bytes });
    }
    Ok(File::open(path)?)
}
