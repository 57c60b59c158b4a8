//! `.asperity.json`: command, document and files of the results in a folder.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

/// Name of the file.
pub(super) const MARKER: &str = ".asperity.json";

/// Name of the work folder inside an output folder, for folders that cannot be exchanged.
pub(super) const INNER_FOLDER: &str = ".asperity";

/// Name of the locked file in a work folder.
pub(super) const LOCK: &str = "lock";

const SCHEMA: &str = "asperity/folder/1";

/// Files that file managers and network file systems put into every folder.
const OF_SYSTEM: [&str; 4] = [".DS_Store", ".directory", "Thumbs.db", "desktop.ini"];

/// Results in a folder; empty for a folder without any.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct FolderMarker {
    schema: String,
    /// Document of all results, relative to the folder.
    pub(super) document: String,
    /// By command.
    pub(super) results: BTreeMap<String, ResultFiles>,
}

/// Result of one command.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct ResultFiles {
    /// Version of asperity.
    version: String,
    /// Names of the files, the summary last.
    pub(super) files: Vec<String>,
}

/// Kind of the results of a command, by one that has them: those of a scenario share a folder.
fn kind(command: &str) -> &str {
    match command {
        "analyse" | "decay" | "identify" => command,
        _ => "simulate",
    }
}

/// True for two commands of which one would replace files of the other: those of another kind, and
/// two with a `summary.json`.
fn excludes(command: &str, other: &str) -> bool {
    let has_summary = |command: &str| matches!(command, "simulate" | "steady");
    kind(command) != kind(other) || command != other && has_summary(command) && has_summary(other)
}

impl FolderMarker {
    /// The marker of a folder; empty if there is none that can be read.
    pub(super) fn read(folder: &Path) -> Self {
        let text = fs::read(folder.join(MARKER)).unwrap_or_default();
        let mut marker: Self = serde_json::from_slice(&text).unwrap_or_default();
        if marker.schema != SCHEMA {
            return Self::default();
        }
        // Files are removed by these names.
        for result in marker.results.values_mut() {
            result.files.retain(|name| {
                let mut parts = Path::new(name).components();
                matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None))
            });
        }
        marker
    }

    /// Its text.
    pub(super) fn to_json(&self) -> io::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Files of all results.
    pub(super) fn files(&self) -> impl DoubleEndedIterator<Item = &String> {
        self.results.values().flat_map(|result| &result.files)
    }

    /// A command whose results in the folder cannot be beside those of `command`.
    pub(super) fn excluded_command(&self, command: &str) -> Option<&str> {
        self.results.keys().map(String::as_str).find(|other| excludes(command, other))
    }

    /// True if the folder has results, and of another document.
    pub(super) fn is_of_other_document(&self, document: &str) -> bool {
        !self.results.is_empty() && self.document != document
    }

    /// The marker with the result of `command`. It replaces results of other documents, and results
    /// with a file of the same name.
    pub(super) fn with_result(&self, document: &str, command: &str, files: &[String]) -> Self {
        let mut results = self.results.clone();
        results.retain(|_, other| {
            self.document == document && !other.files.iter().any(|name| files.contains(name))
        });
        let version = env!("CARGO_PKG_VERSION").to_owned();
        results.insert(command.to_owned(), ResultFiles { version, files: files.to_vec() });
        Self { schema: SCHEMA.to_owned(), document: document.to_owned(), results }
    }

    /// The marker of a folder while the results of this one are replaced by those of `next`.
    pub(super) fn during(&self, next: &Self) -> Self {
        let mut both = next.clone();
        for (command, result) in &self.results {
            both.results.entry(command.clone()).or_default().files.extend_from_slice(&result.files);
        }
        both
    }

    /// True if a result, or the system, has this file.
    pub(super) fn knows(&self, name: &str) -> bool {
        name == MARKER
            || OF_SYSTEM.contains(&name)
            || name.starts_with("._")
            || name.starts_with(".nfs")
            || self.files().any(|file| file == name)
    }

    /// Names of the files in the folder that are no results, sorted; none without a folder.
    pub(super) fn others(&self, folder: &Path) -> io::Result<Vec<OsString>> {
        let entries = match fs::read_dir(folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            entries => entries?,
        };
        let mut names = Vec::new();
        for entry in entries {
            let name = entry?.file_name();
            if !self.knows(&name.to_string_lossy()) && name != INNER_FOLDER {
                names.push(name);
            }
        }
        names.sort();
        Ok(names)
    }
}

/// True if a folder inside another is itself an output folder, or one of unfinished files.
pub(super) fn is_of_results(folder: &Path) -> bool {
    folder.join(MARKER).is_file() || folder.join(LOCK).is_file()
}

/// The path of a document relative to a folder, so that both can be moved together.
pub(super) fn relative_path(document: &Path, folder: &Path) -> String {
    let document = document.canonicalize().unwrap_or_else(|_| document.to_owned());
    let (to, from) = (document.components(), folder.components());
    let common = to.clone().zip(from.clone()).take_while(|(a, b)| a == b).count();
    let up = from.skip(common).map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(to.skip(common)).collect();
    path.to_string_lossy().into_owned()
}
