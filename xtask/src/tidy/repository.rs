//! The files of the repository, in memory.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

/// Files whose text the rules look at.
const TEXT: [&str; 3] = [".rs", ".md", ".toml"];

/// Every file by its path from the root, with `/` between folders, and the
/// text of those in [`TEXT`].
#[derive(Debug, Default)]
pub(super) struct Repository {
    files: BTreeMap<String, Option<String>>,
}

impl Repository {
    /// Reads the repository at `root`, without what its `.gitignore` names
    /// there and without the folder of git.
    pub(super) fn read(root: &Path) -> Result<Self> {
        let ignored = fs::read_to_string(root.join(".gitignore")).unwrap_or_default();
        let mut skipped: Vec<&str> =
            ignored.lines().filter_map(|line| line.trim().strip_prefix('/')).collect();
        skipped.push(".git");
        let mut repository = Self::default();
        repository.walk(root, "", &skipped)?;
        Ok(repository)
    }

    /// A repository of these paths and texts.
    #[cfg(test)]
    pub(super) fn of(files: &[(&str, &str)]) -> Self {
        let entry = |&(path, text): &(&str, &str)| (path.to_owned(), Some(text.to_owned()));
        Self { files: files.iter().map(entry).collect() }
    }

    fn walk(&mut self, folder: &Path, prefix: &str, skipped: &[&str]) -> Result<()> {
        let cannot_read = || format!("cannot read {}", folder.display());
        for entry in fs::read_dir(folder).with_context(cannot_read)? {
            let entry = entry.with_context(cannot_read)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = format!("{prefix}{name}");
            if skipped.iter().any(|skip| skip.trim_end_matches('/') == path) {
                continue;
            }
            if entry.file_type().with_context(cannot_read)?.is_dir() {
                self.walk(&entry.path(), &format!("{path}/"), skipped)?;
                continue;
            }
            let is_text = TEXT.iter().any(|suffix| name.ends_with(suffix));
            let text = is_text.then(|| fs::read_to_string(entry.path())).transpose();
            let text = text.with_context(|| format!("cannot read {path}"))?;
            self.files.insert(path, text);
        }
        Ok(())
    }

    /// Paths of all files.
    pub(super) fn paths(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// The text of a file, if it is there and is read.
    pub(super) fn text(&self, path: &str) -> Option<&str> {
        self.files.get(path)?.as_deref()
    }

    /// Paths and texts of the files that end in `suffix`.
    pub(super) fn texts<'a>(
        &'a self,
        suffix: &'a str,
    ) -> impl Iterator<Item = (&'a str, &'a str)> + 'a {
        self.files
            .iter()
            .filter(move |(path, _)| path.ends_with(suffix))
            .filter_map(|(path, text)| Some((path.as_str(), text.as_deref()?)))
    }

    /// Path, number from 1 and text of every line of the Rust sources.
    pub(super) fn source_lines(&self) -> impl Iterator<Item = (&str, usize, &str)> {
        self.texts(".rs").flat_map(|(path, text)| {
            (1..).zip(text.lines()).map(move |(number, line)| (path, number, line))
        })
    }

    /// True if `path` is a file, or a folder with files.
    pub(super) fn has(&self, path: &str) -> bool {
        let path = path.trim_end_matches('/');
        let inside = format!("{path}/");
        path.is_empty()
            || self.files.contains_key(path)
            || self.files.keys().any(|file| file.starts_with(&inside))
    }
}

/// True for a source file of a crate.
pub(super) fn is_crate_source(path: &str) -> bool {
    path.starts_with("crates/") && path.contains("/src/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_and_folders_exist() {
        let repository =
            Repository::of(&[("crates/law/src/lib.rs", ""), ("crates/lawless.md", "")]);
        for path in ["crates", "crates/law", "crates/law/", "crates/law/src/lib.rs", ""] {
            assert!(repository.has(path), "{path}");
        }
        for path in ["crates/la", "crates/law/src/lib", "docs"] {
            assert!(!repository.has(path), "{path}");
        }
    }
}
