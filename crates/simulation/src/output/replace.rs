//! Replacement of earlier results by a new one.

use std::fs::{self, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use super::marker::{FolderMarker, INNER_FOLDER, MARKER};
use super::work_folder::{WorkFolder, remove_earlier, remove_folder};
use super::write_file;

/// Puts the new files in place of those of `earlier`, with `marker` as the folder's marker.
///
/// The folder is exchanged as a whole. Where that is not possible, its files are replaced one by
/// one: in the working directory, whose shell would be left in a removed folder; in a folder with
/// other files, which are not touched; in a mount point.
pub(super) fn replace(
    work: &WorkFolder,
    place: &Path,
    earlier: &FolderMarker,
    marker: &FolderMarker,
    files: &[String],
) -> io::Result<()> {
    let new = work.new_files();
    if let Ok(metadata) = fs::metadata(place) {
        let is_working_directory = || {
            let current = std::env::current_dir().and_then(|folder| folder.canonicalize());
            current.is_ok_and(|folder| folder == place)
        };
        if work.is_inside(place) || !earlier.others(place)?.is_empty() || is_working_directory() {
            return replace_files(&new, place, earlier, marker, files);
        }
        // Results of other commands.
        for name in marker.files().filter(|name| !files.contains(name)) {
            let (from, to) = (place.join(name), new.join(name));
            match fs::hard_link(&from, &to).or_else(|_| fs::copy(&from, &to).map(drop)) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
        fs::set_permissions(&new, metadata.permissions())?;
    }
    write_file(&new.join(MARKER), marker.to_json()?.as_bytes())?;
    sync_folder(&new)?;
    let exchanged = work.exchanged();
    fs::rename(&new, &exchanged)?;
    if exchange(&exchanged, place, &work.old_files()).is_err() {
        fs::rename(&exchanged, &new)?;
        return replace_files(&new, place, earlier, marker, files);
    }
    if let Some(parent) = place.parent() {
        sync_folder(parent)?;
    }
    for earlier in [exchanged, work.old_files()] {
        if let Err(error) = remove_earlier(&earlier, place) {
            // The result is in place. The next run tries again.
            tracing::warn!("{} cannot be removed: {error}", earlier.display());
        }
    }
    Ok(())
}

/// Names of the files in a folder.
pub(super) fn file_names(folder: &Path) -> io::Result<Vec<String>> {
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    fs::read_dir(folder)?.map(|entry| entry.map(name)).collect()
}

/// Exchanges the folders `new` and `place`, in one step where possible. Otherwise `place` becomes
/// `old` for a moment; a run killed in it leaves both complete, and the next one returns `old`.
fn exchange(new: &Path, place: &Path, old: &Path) -> io::Result<()> {
    #[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
    {
        use rustix::fs::{CWD, RenameFlags, renameat_with};
        if renameat_with(CWD, new, CWD, place, RenameFlags::EXCHANGE).is_ok() {
            return Ok(());
        }
    }
    match fs::rename(place, old) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    fs::rename(new, place).inspect_err(|_| {
        // A failure leaves it to the next run.
        let _ = fs::rename(old, place);
    })
}

/// Replaces the files of `earlier` one by one: the summary goes first and comes last, and no new file
/// appears beside an old one.
fn replace_files(
    new: &Path,
    place: &Path,
    earlier: &FolderMarker,
    marker: &FolderMarker,
    files: &[String],
) -> io::Result<()> {
    if let Some(name) = files.iter().find(|name| place.join(name).is_dir()) {
        return Err(io::Error::new(
            io::ErrorKind::IsADirectory,
            format!("\"{name}\" in it is a folder"),
        ));
    }
    let inner = Inner::create(place)?;
    for name in files {
        let (from, to) = (new.join(name), inner.0.join(name));
        if fs::rename(&from, &to).is_err() {
            fs::copy(&from, &to)?;
            OpenOptions::new().append(true).open(&to)?.sync_all()?;
        }
    }
    let put_marker = |marker: &FolderMarker| {
        let unfinished = inner.0.join(MARKER);
        write_file(&unfinished, marker.to_json()?.as_bytes())?;
        fs::rename(unfinished, place.join(MARKER))
    };
    put_marker(&earlier.during(marker))?;
    let kept: Vec<&String> = marker.files().filter(|name| !files.contains(name)).collect();
    let replaced = earlier.files().chain(files).rev().filter(|name| !kept.contains(name));
    for name in replaced {
        match fs::remove_file(place.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    for name in files {
        fs::rename(inner.0.join(name), place.join(name))?;
    }
    put_marker(marker)?;
    drop(inner);
    sync_folder(place)
}

/// A folder inside an output folder, removed when dropped.
struct Inner(PathBuf);

impl Inner {
    fn create(place: &Path) -> io::Result<Self> {
        let inner = place.join(INNER_FOLDER).join("complete");
        remove_folder(&inner)?;
        fs::create_dir_all(&inner)?;
        Ok(Self(inner))
    }
}

impl Drop for Inner {
    fn drop(&mut self) {
        // The next run removes what remains.
        let _ = remove_folder(&self.0);
        let _ = self.0.parent().map(fs::remove_dir);
    }
}

/// Writes the names in a folder to the disk.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    fs::File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}
