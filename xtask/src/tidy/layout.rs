//! Rules of file names, file lengths and the root folder.

use std::collections::BTreeSet;

use super::Finding;
use super::repository::{Repository, is_crate_source};

/// Most lines of a source file.
const MOST_LINES: usize = 600;

/// Fewest lines of a source file of a crate, unless it is listed in [`SHORT`].
const FEWEST_LINES: usize = 40;

/// Shorter files, each with its reason.
const SHORT: [(&str, &str); 10] = [
    ("crates/asperity/src/prelude.rs", "a list of names"),
    ("crates/cli/src/command/completions.rs", "one command a file"),
    ("crates/cli/src/command/man.rs", "one command a file"),
    ("crates/cli/src/command/schema.rs", "one command a file"),
    ("crates/plot/src/frf_file.rs", "one figure a file"),
    ("crates/dynamics/src/finite_difference/ledger.rs", "energy of the grid"),
    ("crates/harmonic/src/vector_instructions.rs", "used by sums and factorisation"),
    ("crates/law/src/domain.rs", "used by all laws"),
    ("crates/law/src/draw.rs", "used by the samples of all laws"),
    ("crates/scenario/src/validate/damping.rs", "one condition a file"),
];

/// Names that do not say which idea a file holds.
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

/// No source file is longer than 600 lines.
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

/// No module of a crate is shorter than 40 lines without a reason, and every reason is needed. A
/// module with submodules may be short.
pub(super) fn short_files(repository: &Repository) -> Vec<Finding> {
    let short: Vec<(&str, usize)> = repository
        .texts(".rs")
        .filter(|(path, _)| is_crate_source(path))
        .filter(|(path, _)| !["lib.rs", "main.rs"].contains(&file_name(path)))
        .filter(|(path, _)| !repository.has(path.trim_end_matches(".rs")))
        .map(|(path, text)| (path, text.lines().count()))
        .filter(|&(_, lines)| lines < FEWEST_LINES)
        .collect();
    let listed = |path: &str| SHORT.iter().any(|(known, _)| *known == path);
    let unlisted = short.iter().filter(|(path, _)| !listed(path)).map(|(path, lines)| {
        Finding::new(*path, format!("{lines} lines; merge it, or state a reason in tidy's layout"))
    });
    let is_short = |path: &str| short.iter().any(|(found, _)| *found == path);
    let obsolete = SHORT
        .iter()
        .filter(|(path, _)| !is_short(path))
        .map(|(path, _)| Finding::new(*path, "is listed as short in tidy's layout, and is not"));
    unlisted.chain(obsolete).collect()
}

/// A module with submodules is `name.rs` beside `name/`, not `name/mod.rs`.
pub(super) fn mod_files(repository: &Repository) -> Vec<Finding> {
    let in_sources = |path: &&str| path.starts_with("xtask/src/") || is_crate_source(path);
    repository
        .paths()
        .filter(in_sources)
        .filter_map(|path| Some((path, path.strip_suffix("/mod.rs")?)))
        .map(|(path, folder)| Finding::new(path, format!("call it {folder}.rs")))
        .collect()
}

/// No file has a name of [`VAGUE`].
pub(super) fn vague_names(repository: &Repository) -> Vec<Finding> {
    repository
        .paths()
        .filter(|path| VAGUE.contains(&file_name(path)))
        .map(|path| Finding::new(path, "name the file for the one idea it holds"))
        .collect()
}

/// The root folder holds only the entries of [`ROOT`].
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
        assert_eq!(found, [Finding::new("b.rs", "601 lines; split it, at most 600")]);
    }

    #[test]
    fn a_short_module_is_found() {
        let repository = Repository::of(&[
            ("crates/law/src/lib.rs", ""),
            ("crates/law/src/power.rs", "//\n"),
            ("crates/law/src/pchip.rs", "//\n"),
            ("crates/law/src/pchip/slope.rs", &"//\n".repeat(FEWEST_LINES)),
            ("crates/law/src/table.rs", &"//\n".repeat(FEWEST_LINES)),
        ]);
        let found = short_files(&repository);
        assert_eq!(found.iter().filter(|f| f.message.contains("merge it")).count(), 1);
        assert_eq!(found.iter().filter(|f| f.message.contains("listed")).count(), SHORT.len());
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
