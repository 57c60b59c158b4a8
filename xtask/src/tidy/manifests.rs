//! Rules of manifests and the CHANGELOG.

use super::Finding;
use super::repository::Repository;

/// Every crate takes the lints of the workspace.
pub(super) fn workspace_lints(repository: &Repository) -> Vec<Finding> {
    repository
        .texts("/Cargo.toml")
        .filter(|(path, text)| is_member(path) && !takes_workspace_lints(text))
        .map(|(path, _)| Finding::new(path, "add `[lints]` with `workspace = true`"))
        .collect()
}

/// Every package can be published: licences, a README, keywords, categories and a repository.
pub(super) fn publishable(repository: &Repository) -> Vec<Finding> {
    let mut found = Vec::new();
    let published =
        |(path, text): &(&str, &str)| is_member(path) && !text.contains("publish = false");
    for (path, text) in repository.texts("/Cargo.toml").filter(published) {
        let folder = path.trim_end_matches("Cargo.toml");
        for file in ["README.md", "LICENSE-MIT", "LICENSE-APACHE"] {
            if !repository.has(&format!("{folder}{file}")) {
                found.push(Finding::new(format!("{folder}{file}"), "is missing"));
            }
        }
        for key in ["description = ", "repository.workspace = true", "keywords = ", "categories = "]
        {
            if !text.lines().any(|line| line.starts_with(key)) {
                found.push(Finding::new(path, format!("add `{key}`")));
            }
        }
    }
    found
}

/// The CHANGELOG has a heading for `version`.
pub(super) fn changelog(repository: &Repository, version: &str) -> Vec<Finding> {
    let Some(text) = repository.text("CHANGELOG.md") else {
        return vec![Finding::new("CHANGELOG.md", "is missing")];
    };
    let names_version = |line: &str| {
        let heading = line.strip_prefix("## ").unwrap_or_default();
        let word = heading.split_whitespace().next().unwrap_or_default();
        word.trim_start_matches('[').trim_end_matches(']') == version
    };
    if text.lines().any(names_version) {
        return Vec::new();
    }
    vec![Finding::new("CHANGELOG.md", format!("has no entry `## {version}`"))]
}

fn is_member(path: &str) -> bool {
    path.starts_with("xtask/") || (path.starts_with("crates/") && path.matches('/').count() == 2)
}

fn takes_workspace_lints(manifest: &str) -> bool {
    let mut lines = manifest.lines().map(|line| line.replace(' ', ""));
    lines.any(|line| line == "[lints]")
        && lines.take_while(|line| !line.starts_with('[')).any(|line| line == "workspace=true")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crate_without_workspace_lints_is_found() {
        let repository = Repository::of(&[
            ("Cargo.toml", "[workspace]\n"),
            ("crates/law/Cargo.toml", "[package]\n\n[lints]\nworkspace = true\n"),
            ("crates/mesh/Cargo.toml", "[package]\nversion.workspace = true\n"),
            ("xtask/Cargo.toml", "[lints]\n[package.x]\nworkspace = true\n"),
        ]);
        let places: Vec<_> = workspace_lints(&repository).into_iter().map(|f| f.place).collect();
        assert_eq!(places, ["crates/mesh/Cargo.toml", "xtask/Cargo.toml"]);
    }

    #[test]
    fn a_package_that_cannot_be_published_is_found() {
        let whole =
            "description = \"x\"\nrepository.workspace = true\nkeywords = []\ncategories = []\n";
        let files = |folder: &str| {
            ["README.md", "LICENSE-MIT", "LICENSE-APACHE"].map(|file| format!("{folder}{file}"))
        };
        let (law, mesh) = (files("crates/law/"), files("crates/mesh/"));
        let mut texts = vec![
            ("crates/law/Cargo.toml", whole),
            ("crates/mesh/Cargo.toml", "description = \"x\"\nkeywords = []\ncategories = []\n"),
            ("crates/table/Cargo.toml", whole),
            ("xtask/Cargo.toml", "publish = false\n"),
        ];
        texts.extend(law.iter().chain(&mesh).map(|path| (path.as_str(), "")));
        let found = publishable(&Repository::of(&texts));
        let places: Vec<_> = found.iter().map(|finding| finding.place.as_str()).collect();
        assert_eq!(places[0], "crates/mesh/Cargo.toml");
        assert_eq!(places[1..], files("crates/table/"));
    }

    #[test]
    fn a_version_without_entry_is_found() {
        let repository = Repository::of(&[("CHANGELOG.md", "# Changes\n\n## [0.1.0] - someday\n")]);
        assert_eq!(changelog(&repository, "0.1.0"), []);
        let found = changelog(&repository, "0.2.0");
        assert_eq!(found, [Finding::new("CHANGELOG.md", "has no entry `## 0.2.0`")]);
        assert_eq!(changelog(&Repository::of(&[]), "0.1.0").len(), 1);
    }
}
