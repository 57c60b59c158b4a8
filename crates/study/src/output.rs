//! The output folder: claimed before work starts, written file by file, each whole.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::OutputError;

/// File whose presence marks a folder as an earlier output of this command.
const MARKS: [&str; 6] = [
    "summary.json",
    "sweep.json",
    "modes.json",
    "law.json",
    "analysis.json",
    "identification.json",
];

/// A folder that takes results.
///
/// Nothing is created before the first file is written, so a failed run leaves
/// no trace. Each file is written beside its place under a temporary name and
/// renamed, so that a reader never sees half of it.
#[derive(Debug, Clone)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Claims the folder at `path`: it must not exist, or be empty, or hold an
    /// earlier output of this command, unless `overwrite`.
    ///
    /// # Errors
    /// [`OutputError`] when it holds other files, is a file, or cannot be read.
    pub fn claim(path: impl Into<PathBuf>, overwrite: bool) -> Result<Self, OutputError> {
        let path = path.into();
        let metadata = match std::fs::metadata(&path) {
            Ok(metadata) => metadata,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Self { path }),
            Err(source) => return Err(OutputError::Io { path, source }),
        };
        if !metadata.is_dir() {
            return Err(OutputError::NotAFolder(path));
        }
        let earlier_output = MARKS.iter().any(|mark| path.join(mark).is_file());
        if !overwrite && !earlier_output {
            let io = |source| OutputError::Io { path: path.clone(), source };
            let entry = std::fs::read_dir(&path).map_err(io)?.next();
            if let Some(entry) = entry.transpose().map_err(io)? {
                let example = entry.file_name().to_string_lossy().into_owned();
                return Err(OutputError::Occupied { folder: path, example });
            }
        }
        Ok(Self { path })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes `contents` to the file `name`, whole or not at all.
    ///
    /// # Errors
    /// [`OutputError::Io`] when the operating system refuses.
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<PathBuf, OutputError> {
        let place = self.path.join(name);
        let fail = |path: &Path| {
            let path = path.to_owned();
            move |source| OutputError::Io { path, source }
        };
        std::fs::create_dir_all(&self.path).map_err(fail(&self.path))?;
        let mut file = tempfile::Builder::new()
            .prefix(".asperity-")
            .suffix(".tmp")
            .tempfile_in(&self.path)
            .map_err(fail(&self.path))?;
        file.write_all(contents.as_ref()).map_err(fail(file.path()))?;
        make_readable(file.as_file());
        file.persist(&place).map_err(|error| fail(&place)(error.error))?;
        Ok(place)
    }
}

/// Temporary files are private to their owner; results are as readable as any new file.
#[cfg(unix)]
fn make_readable(file: &std::fs::File) {
    use std::os::unix::fs::PermissionsExt;
    // A failure leaves the file readable for its owner.
    let _ = file.set_permissions(std::fs::Permissions::from_mode(0o644));
}

#[cfg(not(unix))]
fn make_readable(_: &std::fs::File) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_of_other_files_needs_overwrite() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        assert!(OutputFolder::claim(&path, false).is_ok());
        assert!(!path.exists(), "claiming creates nothing");
        std::fs::create_dir(&path).unwrap();
        assert!(OutputFolder::claim(&path, false).is_ok());
        std::fs::write(path.join("thesis.tex"), "x").unwrap();
        let refused = OutputFolder::claim(&path, false).unwrap_err();
        assert!(refused.to_string().contains("thesis.tex"));
        assert!(OutputFolder::claim(&path, true).is_ok());
        assert!(OutputFolder::claim(path.join("thesis.tex"), true).is_err());
    }

    #[test]
    fn an_earlier_output_is_written_over_and_no_temporary_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/out");
        let output = OutputFolder::claim(&path, false).unwrap();
        output.write("summary.json", "1").unwrap();
        let again = OutputFolder::claim(&path, false).unwrap();
        again.write("summary.json", "2").unwrap();
        assert_eq!(std::fs::read_to_string(path.join("summary.json")).unwrap(), "2");
        assert_eq!(std::fs::read_dir(&path).unwrap().count(), 1);
    }
}
