//! Measurement files of a folder that are complete.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::error::AnalysisError;
use crate::input_files::measurements_in;

/// Looks with the same state after which a file is complete, and after which its writer has ended.
const COMPLETE: u32 = 2;
const LEFT: u32 = 9;

/// A folder to which measurement files are added.
///
/// A file is complete when two [looks](Self::look) in a row find the same size and time of change; one
/// that changes later is new again.
#[derive(Debug)]
pub struct WatchedFolder {
    path: PathBuf,
    files: HashMap<PathBuf, SeenFile>,
    /// Files that the last look did not find any more.
    gone: Vec<PathBuf>,
}

#[derive(Debug)]
struct SeenFile {
    state: (u64, Option<SystemTime>),
    /// Looks that found this state.
    looks: u32,
    accepted: bool,
}

/// A file that did not change from one look to the next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CompleteFile {
    /// The file.
    pub path: PathBuf,
    /// True if it has been left for so long that its writer has ended.
    pub is_left: bool,
}

impl WatchedFolder {
    /// A folder, none of whose files is known yet.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), files: HashMap::new(), gone: Vec::new() }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The complete files that are not [accepted](Self::accept), in natural order: each when it is
    /// first found complete, and once more when its writer has ended.
    ///
    /// # Errors
    /// [`AnalysisError::Measure`] for a folder that cannot be read.
    pub fn look(&mut self) -> Result<Vec<CompleteFile>, AnalysisError> {
        let mut found = Vec::new();
        let mut there = HashSet::new();
        for path in measurements_in(&self.path)? {
            // One that has just been removed or renamed.
            let Ok(metadata) = std::fs::metadata(&path) else { continue };
            there.insert(path.clone());
            let state = (metadata.len(), metadata.modified().ok());
            let fresh = || SeenFile { state, looks: 0, accepted: false };
            let seen = self.files.entry(path.clone()).or_insert_with(fresh);
            if seen.state != state {
                *seen = fresh();
            }
            if seen.accepted {
                continue;
            }
            seen.looks = seen.looks.saturating_add(1);
            if seen.looks == COMPLETE || seen.looks == LEFT {
                found.push(CompleteFile { path, is_left: seen.looks == LEFT });
            }
        }
        let gone = self.files.extract_if(|path, _| !there.contains(path));
        self.gone.extend(gone.map(|(path, _)| path));
        Ok(found)
    }

    /// Files that looks have found before and that are there no more: deleted or renamed.
    pub fn take_gone(&mut self) -> Vec<PathBuf> {
        std::mem::take(&mut self.gone)
    }

    /// Takes a file as read: it is not returned again unless it changes.
    pub fn accept(&mut self, path: &Path) {
        if let Some(seen) = self.files.get_mut(path) {
            seen.accepted = true;
        }
    }

    /// True if every file is accepted, or its writer has ended.
    pub fn is_settled(&self) -> bool {
        self.files.values().all(|seen| seen.accepted || seen.looks >= LEFT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each state is returned when it is found again, and once more when its writer has ended; a file
    /// that grows is new.
    #[test]
    fn a_file_is_complete_when_it_does_not_change() {
        let folder = tempfile::tempdir().unwrap();
        let mut watched = WatchedFolder::new(folder.path());
        assert!(watched.look().unwrap().is_empty() && watched.is_settled());
        let path = folder.path().join("a.uff");
        std::fs::write(&path, "1").unwrap();
        std::fs::write(folder.path().join("notes.md"), "1").unwrap();
        let mut looks = |count: usize| -> Vec<CompleteFile> {
            (0..count).flat_map(|_| watched.look().unwrap()).collect()
        };
        assert!(looks(1).is_empty());
        let complete = |is_left| CompleteFile { path: path.clone(), is_left };
        assert_eq!(looks(1), [complete(false)]);
        std::fs::write(&path, "12").unwrap();
        assert_eq!(looks(2), [complete(false)]);
        assert_eq!(looks(20), [complete(true)]);
        assert!(watched.is_settled());
        std::fs::write(&path, "123").unwrap();
        assert!(watched.look().unwrap().is_empty() && !watched.is_settled());
        watched.accept(&path);
        assert!(watched.is_settled());
        assert!((0..20).all(|_| watched.look().unwrap().is_empty()));
        let renamed = folder.path().join("b.uff");
        std::fs::rename(&path, &renamed).unwrap();
        let found: Vec<CompleteFile> = (0..2).flat_map(|_| watched.look().unwrap()).collect();
        assert_eq!(found, [CompleteFile { path: renamed, is_left: false }]);
        assert_eq!((watched.take_gone(), watched.take_gone()), (vec![path], vec![]));
    }
}
