//! Rules of declarations: one name has one meaning, and a doc comment starts with its subject.

use std::collections::BTreeMap;

use super::Finding;
use super::repository::{Repository, is_crate_source};

/// Words that a doc comment does not start with.
const OPENERS: [&str; 8] = ["What", "Which", "Why", "Whether", "How", "Where", "Who", "That"];

/// Keywords that declare a type.
const TYPES: [&str; 5] = ["struct ", "enum ", "trait ", "type ", "union "];

/// No two public types of the workspace share a name.
pub(super) fn repeated_types(repository: &Repository) -> Vec<Finding> {
    let mut places: BTreeMap<&str, Vec<(&str, usize)>> = BTreeMap::new();
    for (path, number, line) in repository.source_lines() {
        let name = line.trim_start().strip_prefix("pub ").and_then(type_name);
        if let Some(name) = name.filter(|_| is_crate_source(path)) {
            places.entry(name).or_default().push((path, number));
        }
    }
    let mut found = Vec::new();
    for (name, places) in places {
        let Some(((first, line), others)) = places.split_first() else { continue };
        for (path, number) in others {
            let message = format!("`{name}` is also a public type of {first}:{line}; rename one");
            found.push(Finding::at(path, *number, message));
        }
    }
    found
}

/// The name that a declaration such as `struct Name<T> {` introduces.
fn type_name(declaration: &str) -> Option<&str> {
    let rest = TYPES.iter().find_map(|keyword| declaration.strip_prefix(keyword))?;
    rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()
}

/// No doc comment, and no cell of a table in one, starts with a question word.
pub(super) fn openers(repository: &Repository) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut previous = None;
    for (path, number, line) in repository.source_lines() {
        let comment = line.trim_start().split_at_checked(3);
        let comment = comment.filter(|(mark, _)| ["///", "//!"].contains(mark));
        let mark = comment.map(|(mark, _)| mark);
        let opener = comment.map(|(_, prose)| prose.trim()).and_then(|prose| {
            if let Some(row) = prose.strip_prefix('|') {
                row.split('|').find_map(|cell| opener(&capitalised(cell.trim())))
            } else {
                opener(prose).filter(|_| mark != previous)
            }
        });
        found.extend(opener.map(|word| {
            let message = format!("starts with \"{word}\": start with the subject");
            Finding::at(path, number, message)
        }));
        previous = mark;
    }
    found
}

/// The word of [`OPENERS`] that `text` starts with.
fn opener(text: &str) -> Option<&'static str> {
    let word = text.split(|c: char| !c.is_alphabetic()).next().unwrap_or_default();
    OPENERS.into_iter().find(|opener| *opener == word)
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_public_type_is_found() {
        let repository = Repository::of(&[
            ("crates/law/src/table.rs", "pub struct Table<T> {\npub(crate) struct Row;\n"),
            ("crates/mesh/src/table.rs", "struct Row;\n    pub enum Table {\npub fn table()\n"),
            ("crates/mesh/tests/table.rs", "pub struct Table;\n"),
        ]);
        let message = "`Table` is also a public type of crates/law/src/table.rs:1; rename one";
        assert_eq!(
            repeated_types(&repository),
            [Finding::at("crates/mesh/src/table.rs", 2, message)]
        );
    }

    #[test]
    fn a_doc_comment_that_opens_with_a_question_word_is_found() {
        let text = "//! | a | what |\n//! | b | Whatever |\n/// Whether.\n/// What follows.\n\n\
            /// Whole.\n//// What\n// Why\n    /// Why not.\n";
        let found = openers(&Repository::of(&[("a.rs", text)]));
        let places: Vec<_> = found.iter().map(|finding| finding.place.as_str()).collect();
        assert_eq!(places, ["a.rs:1", "a.rs:3", "a.rs:9"]);
    }
}
