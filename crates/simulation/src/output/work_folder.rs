//! The folder beside an output folder that a run writes to, and its lock.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use same_file::Handle;

use super::marker::{FolderMarker, INNER_FOLDER, LOCK, MARKER};
use crate::error::OutputError;

/// Attempts to lock a file that other runs remove at the same time.
const MOST_ATTEMPTS: usize = 1000;

/// A locked folder for unfinished files. Dropped, it disappears.
#[derive(Debug)]
pub(super) struct WorkFolder {
    path: PathBuf,
    /// Locked until it is closed, be it by the end of the process.
    lock: Option<File>,
    /// Folders created for it, innermost last.
    created: Vec<PathBuf>,
}

impl WorkFolder {
    /// Locks the work folder of the output folder at `path`, and resolves the path.
    ///
    /// It is `.NAME.asperity` beside `NAME`, or inside where nothing can be created beside it.
    pub(super) fn lock(path: &Path, is_folder: bool) -> Result<(Self, PathBuf), OutputError> {
        let fail = |source| OutputError::Io { path: path.to_owned(), source };
        let mut created = Vec::new();
        let place = if is_folder {
            path.canonicalize().map_err(fail)?
        } else {
            let absolute = std::path::absolute(path).map_err(fail)?;
            let (Some(parent), Some(name)) = (absolute.parent(), absolute.file_name()) else {
                return Err(fail(io::ErrorKind::InvalidInput.into()));
            };
            let missing = parent.ancestors().take_while(|folder| !folder.exists());
            created = missing.map(Path::to_owned).collect();
            created.reverse();
            fs::create_dir_all(parent)
                .and_then(|()| parent.canonicalize())
                .map_err(fail)?
                .join(name)
        };
        let beside = place.parent().zip(place.file_name()).map(|(parent, name)| {
            let mut hidden = OsString::from(".");
            hidden.push(name);
            hidden.push(".asperity");
            parent.join(hidden)
        });
        let mut work = Self { path: beside.unwrap_or_default(), lock: None, created };
        let busy = || OutputError::Busy { folder: path.to_owned() };
        match work.try_lock() {
            Ok(true) => Ok((work, place)),
            Ok(false) => Err(busy()),
            Err(error) if is_folder && may_be_possible_inside(&error) => {
                work.path = place.join(INNER_FOLDER);
                if work.try_lock().map_err(fail)? { Ok((work, place)) } else { Err(busy()) }
            }
            Err(error) => Err(fail(error)),
        }
    }

    /// Locks the file `lock`; false if another run has it.
    fn try_lock(&mut self) -> io::Result<bool> {
        let path = self.path.join(LOCK);
        for _ in 0..MOST_ATTEMPTS {
            match fs::create_dir(&self.path) {
                Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
                _ => {}
            }
            // A run that ends removes file and folder.
            let existed = path.exists();
            let mut options = OpenOptions::new();
            options.write(true).create_new(!existed);
            let file = match options.open(&path) {
                Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                opened => opened?,
            };
            match file.try_lock() {
                Err(TryLockError::WouldBlock) => return Ok(false),
                // Without locks, a file that exists may be that of another run, or of a killed one.
                Err(TryLockError::Error(error)) if existed => {
                    let folder = self.path.display();
                    let remedy = format!("{error}; delete {folder} if no other run writes to it");
                    return Err(io::Error::new(error.kind(), remedy));
                }
                _ => {}
            }
            let locked = Handle::from_file(file.try_clone()?)?;
            if Handle::from_path(&path).is_ok_and(|current| current == locked) {
                self.lock = Some(file);
                return Ok(true);
            }
        }
        Err(io::ErrorKind::TimedOut.into())
    }

    /// True if it is inside the output folder.
    pub(super) fn is_inside(&self, place: &Path) -> bool {
        self.path.starts_with(place)
    }

    /// Folder of unfinished files.
    pub(super) fn new_files(&self) -> PathBuf {
        self.path.join("new")
    }

    /// The complete result, before it is exchanged for the output folder; then the earlier one.
    pub(super) fn exchanged(&self) -> PathBuf {
        self.path.join("exchanged")
    }

    /// The earlier result, where it cannot be exchanged in one step.
    pub(super) fn old_files(&self) -> PathBuf {
        self.path.join("old")
    }

    /// Completes or undoes what killed runs began.
    pub(super) fn recover(&self, place: &Path) -> io::Result<()> {
        let old = self.old_files();
        if old.exists() && !place.exists() {
            fs::rename(&old, place)?;
        }
        remove_folder(&self.new_files())?;
        remove_earlier(&self.exchanged(), place)?;
        remove_earlier(&old, place)?;
        let inner = place.join(INNER_FOLDER);
        if self.is_inside(place) { Ok(()) } else { remove_folder(&inner) }
    }
}

impl Drop for WorkFolder {
    fn drop(&mut self) {
        // The next run removes what remains.
        if let Some(lock) = self.lock.take() {
            let _ = remove_folder(&self.new_files());
            // Removed while it is locked: after that it may be the lock of another run.
            let _ = fs::remove_file(self.path.join(LOCK));
            drop(lock);
            let _ = fs::remove_dir(&self.path);
        }
        for folder in self.created.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Removes a folder with its files, if there is one.
pub(super) fn remove_folder(folder: &Path) -> io::Result<()> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Removes an earlier result that is no longer at `place`, if there is one. Files that are no
/// results return to `place`.
pub(super) fn remove_earlier(folder: &Path, place: &Path) -> io::Result<()> {
    if !folder.exists() {
        return Ok(());
    }
    let (marker, present) = (FolderMarker::read(folder), FolderMarker::read(place));
    for name in marker.others(folder)? {
        if present.knows(&name.to_string_lossy()) {
            remove_entry(&folder.join(&name))?;
        } else if fs::symlink_metadata(place.join(&name)).is_err() {
            fs::create_dir_all(place)?;
            fs::rename(folder.join(&name), place.join(&name))?;
        }
    }
    // The marker is last: without it a file would be taken for one that is no result.
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        if name != MARKER && marker.knows(&name.to_string_lossy()) {
            remove_entry(&entry.path())?;
        }
    }
    let _ = fs::remove_file(folder.join(MARKER));
    fs::remove_dir(folder)
}

fn remove_entry(path: &Path) -> io::Result<()> {
    if fs::symlink_metadata(path)?.is_dir() {
        fs::remove_dir_all(path)
    } else {
        fs::remove_file(path)
    }
}

/// True for errors of creating a folder beside another that may not occur inside it.
fn may_be_possible_inside(error: &io::Error) -> bool {
    use io::ErrorKind::{InvalidFilename, NotFound, PermissionDenied, ReadOnlyFilesystem};
    matches!(error.kind(), PermissionDenied | ReadOnlyFilesystem | InvalidFilename | NotFound)
}
