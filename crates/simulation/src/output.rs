//! Output folders: a result is written beside its folder and put in place as a whole.
//!
//! ```text
//! out/rig                    results, with .asperity.json: command, document and files of each
//! out/.rig.asperity/lock     held while a run writes to out/rig
//! out/.rig.asperity/new      files of a run that is not finished
//! ```
//!
//! A finished run exchanges the folder for the new one in one step where the operating system can,
//! so that at every moment it holds one complete result. The next run removes what a killed run
//! has left.
//!
//! | module | does |
//! |---|---|
//! | [`file_name`] | names of files that every file system accepts |
//! | `marker` | `.asperity.json`, the record of what wrote the files of a folder |
//! | `work_folder` | the lock, the unfinished files, and what killed runs have left |
//! | `replace` | puts a complete result in place: by exchange, or file by file |

pub mod file_name;
mod marker;
mod replace;
mod work_folder;

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::OutputError;
use marker::FolderMarker;
use work_folder::WorkFolder;

/// Most names of other files in an error.
const MOST_NAMED: usize = 10;

/// Request for an output folder.
#[derive(Debug, Clone, Copy)]
pub struct OutputRequest<'a> {
    /// The folder.
    pub folder: &'a Path,
    /// Command that writes, e.g. `simulate`. Its earlier result is replaced.
    pub command: &'a str,
    /// Document that the result is computed from.
    pub document: &'a Path,
    /// True if results of another document are replaced, too.
    pub replace_other_document: bool,
    /// True if the folder may hold what the command would not write: files that are no results,
    /// which are kept except those that have the name of a new file, and results that cannot be beside
    /// new ones, which are replaced: of another kind (of scenarios, of hits, of decays, of an
    /// identification), and of `simulate` by those of `steady` or the reverse.
    pub overwrite: bool,
}

/// A folder that takes the result of one run.
///
/// Only [`finish`](Self::finish) changes it. A result that is dropped before leaves the folder as it
/// was.
///
/// ```
/// use asperity_simulation::output::{OutputFolder, OutputRequest};
///
/// let parent = tempfile::tempdir()?;
/// let folder = parent.path().join("rig");
/// let output = OutputFolder::claim(&OutputRequest {
///     folder: &folder,
///     command: "simulate",
///     document: "rig.json".as_ref(),
///     replace_other_document: false,
///     overwrite: false,
/// })?;
/// output.write("history.csv", "time_s\n0\n")?;
/// assert!(!folder.exists());
/// output.finish("summary.json", "{}")?;
/// assert!(folder.join("history.csv").exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct OutputFolder {
    /// As requested.
    path: PathBuf,
    /// Absolute and without links.
    place: PathBuf,
    command: String,
    /// Relative to the folder.
    document: String,
    work: WorkFolder,
}

impl OutputFolder {
    /// Locks a folder for one run, and removes what killed runs have left.
    ///
    /// # Errors
    /// [`OutputError`] if another run writes to the folder, if it holds files that are no results or
    /// results of another document or kind, each unless requested, or cannot be written.
    pub fn claim(request: &OutputRequest<'_>) -> Result<Self, OutputError> {
        let path = request.folder.to_owned();
        let fail = |source| OutputError::Io { path: path.clone(), source };
        let is_folder = match fs::metadata(&path) {
            Ok(metadata) if metadata.is_dir() => true,
            Ok(_) => return Err(OutputError::NotAFolder(path)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => false,
            Err(error) => return Err(fail(error)),
        };
        if !is_folder && fs::symlink_metadata(&path).is_ok() {
            return Err(OutputError::NotAFolder(path));
        }
        let (work, place) = WorkFolder::lock(&path, is_folder)?;
        work.recover(&place).map_err(fail)?;
        let document = marker::relative_path(request.document, &place);
        let marker = FolderMarker::read(&place);
        if !request.overwrite {
            let mut others = marker.others(&place).map_err(fail)?;
            others.retain(|name| !marker::is_of_results(&place.join(name)));
            if !others.is_empty() {
                let named = others.iter().take(MOST_NAMED);
                let files = named.map(|name| name.to_string_lossy().into_owned()).collect();
                return Err(OutputError::Occupied { folder: path, files, count: others.len() });
            }
        }
        if !request.overwrite
            && let Some(other) = marker.excluded_command(request.command)
        {
            let command = other.to_owned();
            return Err(OutputError::OtherKind { folder: path, command });
        }
        if !request.replace_other_document && marker.is_of_other_document(&document) {
            let document = place.join(&marker.document);
            let document = document.canonicalize().unwrap_or(document);
            return Err(OutputError::OtherDocument { folder: path, document });
        }
        Ok(Self { path, place, command: request.command.to_owned(), document, work })
    }

    /// The folder, as requested.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file `name` of the earlier result of this command and document; `None` without one.
    pub fn earlier(&self, name: &str) -> Option<PathBuf> {
        let marker = FolderMarker::read(&self.place);
        let is_own = !marker.is_of_other_document(&self.document);
        let files = &marker.results.get(&self.command).filter(|_| is_own)?.files;
        files.iter().any(|file| file == name).then(|| self.place.join(name))
    }

    /// Place of the file `name` until the result is finished.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the folder of unfinished files cannot be created.
    pub fn unfinished(&self, name: &str) -> Result<PathBuf, OutputError> {
        let new = self.work.new_files();
        fs::create_dir_all(&new).map_err(self.fail(name))?;
        Ok(new.join(name))
    }

    /// Writes `contents` as the file `name` of the result.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the operating system refuses.
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<(), OutputError> {
        let place = self.unfinished(name)?;
        write_file(&place, contents.as_ref()).map_err(self.fail(name))
    }

    /// Writes the last file, and puts the result in place of the command's earlier one.
    ///
    /// Results of other commands on the same document stay, unless they have a file of the same
    /// name: then they are removed as a whole.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the operating system refuses. The folder is then as it was.
    pub fn finish(self, last: &str, contents: impl AsRef<[u8]>) -> Result<PathBuf, OutputError> {
        self.write(last, contents)?;
        let fail = |source| OutputError::Io { path: self.path.clone(), source };
        let mut files = replace::file_names(&self.work.new_files()).map_err(fail)?;
        files.sort_by_key(|name| (name == last, name.clone()));
        let earlier = FolderMarker::read(&self.place);
        let marker = earlier.with_result(&self.document, &self.command, &files);
        for command in earlier.results.keys().filter(|name| !marker.results.contains_key(*name)) {
            let folder = self.path.display();
            tracing::warn!("the results of {command} in {folder} are replaced");
        }
        replace::replace(&self.work, &self.place, &earlier, &marker, &files).map_err(fail)?;
        Ok(self.path.clone())
    }

    fn fail(&self, name: &str) -> impl FnOnce(io::Error) -> OutputError + use<> {
        let path = self.path.join(name);
        |source| OutputError::Io { path, source }
    }
}

/// Writes a file to the disk, not to memory alone: a full disk is an error here.
///
/// # Errors
/// Those of the system.
pub fn write_file(path: &Path, contents: &[u8]) -> io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(contents)?;
    file.sync_all()
}

#[cfg(test)]
mod tests;
