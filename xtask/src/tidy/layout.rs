//! Rules of file names, file lengths and the root folder.

use std::collections::BTreeSet;

use super::Finding;
use super::repository::Repository;

/// Most lines of a source file.
const MOST_LINES: usize = 400;

/// Names that say nothing of what a file holds.
const VAGUE: [&str; 3] = ["utils.rs", "common.rs", "helpers.rs"];

/// Everything that may lie at the root.
const ROOT: [&str; 21] = [
    ".cargo",
    ".ci",
    ".gitattributes",
    ".github",
    ".gitignore",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CITATION.cff",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "clippy.toml",
    "crates",
    "docs",
    "fixtures",
    "fuzz",
    "rust-toolchain.toml",
    "rustfmt.toml",
    "xtask",
];

/// No source file is longer than 400 lines.
pub(super) fn long_files(repository: &Repository) -> Vec<Finding> {
    repository
        .texts(".rs")
        .map(|(path, text)| (path, text.lines().count()))
        .filter(|&(_, lines)| lines > MOST_LINES)
        .map(|(path, lines)| {
            Finding::new(path, format!("{lines} lines; split it, at most {MOST_LINES}"))
        })
        .collect()
}

/// A module with submodules is `name.rs` beside `name/`, not `name/mod.rs`.
pub(super) fn mod_files(repository: &Repository) -> Vec<Finding> {
    let in_sources = |path: &&str| {
        path.starts_with("xtask/src/") || (path.starts_with("crates/") && path.contains("/src/"))
    };
    repository
        .paths()
        .filter(in_sources)
        .filter_map(|path| Some((path, path.strip_suffix("/mod.rs")?)))
        .map(|(path, folder)| Finding::new(path, format!("call it {folder}.rs")))
        .collect()
}

/// No file is called after nothing.
pub(super) fn vague_names(repository: &Repository) -> Vec<Finding> {
    repository
        .paths()
        .filter(|path| VAGUE.contains(&file_name(path)))
        .map(|path| Finding::new(path, "name the file for the one idea it holds"))
        .collect()
}

/// Nothing lies at the root that has no business there.
pub(super) fn stray_entries(repository: &Repository) -> Vec<Finding> {
    let entries: BTreeSet<&str> =
        repository.paths().filter_map(|path| path.split('/').next()).collect();
    entries
        .into_iter()
        .filter(|entry| !ROOT.contains(entry))
        .map(|entry| Finding::new(entry, "does not belong at the root"))
        .collect()
}

fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_file_is_found() {
        let (at_limit, beyond) = ("//\n".repeat(MOST_LINES), "//\n".repeat(MOST_LINES + 1));
        let repository = Repository::of(&[("a.rs", &at_limit), ("b.rs", &beyond)]);
        let found = long_files(&repository);
        assert_eq!(found, [Finding::new("b.rs", "401 lines; split it, at most 400")]);
    }

    #[test]
    fn a_mod_file_is_found_in_sources_only() {
        let repository = Repository::of(&[
            ("crates/law/src/power/mod.rs", ""),
            ("crates/law/tests/support/mod.rs", ""),
            ("xtask/src/tidy.rs", ""),
        ]);
        let found = mod_files(&repository);
        let expected = "call it crates/law/src/power.rs";
        assert_eq!(found, [Finding::new("crates/law/src/power/mod.rs", expected)]);
    }

    #[test]
    fn vague_names_are_found() {
        let repository =
            Repository::of(&[("crates/law/src/utils.rs", ""), ("crates/law/src/power.rs", "")]);
        assert_eq!(vague_names(&repository).len(), 1);
    }

    #[test]
    fn stray_files_and_folders_are_found() {
        let repository = Repository::of(&[
            ("notes.txt", ""),
            ("scratch/a.rs", ""),
            ("crates/law/src/lib.rs", ""),
        ]);
        let places: Vec<_> = stray_entries(&repository).into_iter().map(|f| f.place).collect();
        assert_eq!(places, ["notes.txt", "scratch"]);
    }
}
