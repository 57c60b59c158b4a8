//! Rules of documents: links and paths lead to something that exists.

use std::collections::BTreeSet;

use super::Finding;
use super::markdown::{Piece, links, pieces};
use super::repository::Repository;

/// Folder of the book's pages.
const BOOK: &str = "docs/src/";

/// A code span that starts with one of these is a path from the root.
const FOLDERS: [&str; 6] = ["crates/", "xtask/", "docs/", "fixtures/", ".ci/", ".github/"];

/// Every relative link of a document leads to a file or folder.
pub(super) fn broken_links(repository: &Repository) -> Vec<Finding> {
    let mut found = Vec::new();
    for (path, text) in repository.texts(".md") {
        for (line, target) in links(text) {
            let file = target.split('#').next().unwrap_or_default();
            if file.is_empty() || file.contains("://") || file.starts_with("mailto:") {
                continue;
            }
            match resolve(path, file) {
                Some(full) if repository.has(&full) => {}
                _ => found.push(Finding::at(path, line, format!("the link to {target} is broken"))),
            }
        }
    }
    found
}

/// Every page of the book is in its summary.
pub(super) fn pages_outside_the_book(repository: &Repository) -> Vec<Finding> {
    let summary = format!("{BOOK}SUMMARY.md");
    let text = repository.text(&summary).unwrap_or_default();
    let listed: BTreeSet<String> =
        links(text).iter().filter_map(|(_, target)| resolve(&summary, target)).collect();
    repository
        .texts(".md")
        .map(|(path, _)| path)
        .filter(|path| path.starts_with(BOOK) && *path != summary && !listed.contains(*path))
        .map(|path| Finding::new(path, format!("is not in {summary}")))
        .collect()
}

/// Every path of the workspace named between backticks exists.
pub(super) fn missing_paths(repository: &Repository) -> Vec<Finding> {
    let mut found = Vec::new();
    for (path, text) in repository.texts(".md") {
        for (line, piece) in pieces(text) {
            let Piece::Span(span) = piece else { continue };
            let pattern = span.contains(['*', '<', '{', ' ', '…']) || span.contains("NN");
            let is_path = FOLDERS.iter().any(|room| span.starts_with(room)) && !pattern;
            if is_path && !repository.has(span) {
                found.push(Finding::at(path, line, format!("`{span}` does not exist")));
            }
        }
    }
    found
}

/// The path from the root that `target` means in the document `path`; none if
/// it leads out of the repository.
fn resolve(path: &str, target: &str) -> Option<String> {
    let mut parts: Vec<&str> = path.split('/').collect();
    parts.pop();
    for part in target.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            name => parts.push(name),
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_link_is_found() {
        let page =
            "[up](../../README.md#top) [web](https://example.org/x) [here](#x)\n[no](law.md)";
        let repository = Repository::of(&[("docs/src/a.md", page), ("README.md", "[b](docs/src)")]);
        let found = broken_links(&repository);
        assert_eq!(found, [Finding::at("docs/src/a.md", 2, "the link to law.md is broken")]);
        let outside = Repository::of(&[("README.md", "[x](../secret.md)")]);
        assert_eq!(broken_links(&outside).len(), 1);
    }

    #[test]
    fn a_page_outside_the_summary_is_found() {
        let repository = Repository::of(&[
            ("docs/src/SUMMARY.md", "- [A](a.md)\n  - [B](how-to/b.md)\n"),
            ("docs/src/a.md", ""),
            ("docs/src/how-to/b.md", ""),
            ("docs/src/how-to/c.md", ""),
        ]);
        let found = pages_outside_the_book(&repository);
        assert_eq!(found[0].place, "docs/src/how-to/c.md");
        assert_eq!(found.len(), 1);
    }

    #[test]
    fn a_path_that_does_not_exist_is_found() {
        let text = "`crates/law`, `crates/*/src`, `crates/<name>` and `crates/lost/`";
        let repository = Repository::of(&[("a.md", text), ("crates/law/src/lib.rs", "")]);
        let found = missing_paths(&repository);
        assert_eq!(found, [Finding::at("a.md", 1, "`crates/lost/` does not exist")]);
    }
}
