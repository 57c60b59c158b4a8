//! The rule of arrows: which crate may use which.
//!
//! The table in ARCHITECTURE.md is the rule itself. It is read here and held
//! against the dependencies that cargo knows, so that document and code
//! cannot drift apart. A row for a crate that does not exist yet is a
//! permission not yet used.

use std::collections::{BTreeMap, BTreeSet};

use cargo_metadata::{DependencyKind, Metadata};

use super::Finding;
use super::repository::Repository;

/// The document that holds the table.
const DOCUMENT: &str = "ARCHITECTURE.md";

/// The header of the table.
const HEADER: [&str; 2] = ["crate", "may use"];

/// Prefix of our crates' names, left out in the table.
const PREFIX: &str = "asperity-";

/// A crate of the workspace and those of ours that it depends on.
#[derive(Debug, Clone)]
pub(super) struct Crate {
    name: String,
    uses: BTreeSet<String>,
    uses_in_tests: BTreeSet<String>,
}

/// The row of one crate.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Row {
    /// Number of the row, from the top.
    number: usize,
    may_use: BTreeSet<String>,
}

/// The crates of the workspace, by their short names.
pub(super) fn crates(metadata: &Metadata) -> Vec<Crate> {
    let packages = metadata.workspace_packages();
    let ours: BTreeSet<&str> = packages.iter().map(|package| package.name.as_str()).collect();
    packages
        .iter()
        .map(|package| {
            let uses = |tests: bool| {
                let dependencies = package.dependencies.iter();
                dependencies
                    .filter(|used| (used.kind == DependencyKind::Development) == tests)
                    .filter(|used| ours.contains(used.name.as_str()))
                    .map(|used| short(&used.name))
                    .collect()
            };
            Crate { name: short(&package.name), uses: uses(false), uses_in_tests: uses(true) }
        })
        .collect()
}

/// Every dependency among `crates` is allowed by the table: a normal one
/// where the table says so, one of tests on any crate of a row further up.
pub(super) fn check(repository: &Repository, crates: &[Crate]) -> Vec<Finding> {
    let text = repository.text(DOCUMENT).unwrap_or_default();
    let Some(table) = table(text) else {
        let message = format!("needs a table with the header `| {} | {} |`", HEADER[0], HEADER[1]);
        return vec![Finding::new(DOCUMENT, message)];
    };
    let mut found = Vec::new();
    for Crate { name, uses, uses_in_tests } in crates {
        let Some(row) = table.get(name) else {
            found.push(Finding::new(DOCUMENT, format!("the table has no row for `{name}`")));
            continue;
        };
        for used in uses.difference(&row.may_use) {
            let allowed: Vec<_> = row.may_use.iter().map(String::as_str).collect();
            let allowed = if allowed.is_empty() { "nothing".into() } else { allowed.join(", ") };
            let message = format!("`{name}` uses `{used}`; {DOCUMENT} allows it {allowed}");
            found.push(Finding::new(manifest(name), message));
        }
        for used in uses_in_tests {
            let below = table.get(used).is_some_and(|other| other.number < row.number);
            if !below {
                let message = format!(
                    "the tests of `{name}` use `{used}`, which is not above `{name}` in the table of {DOCUMENT}"
                );
                found.push(Finding::new(manifest(name), message));
            }
        }
    }
    found
}

fn short(name: &str) -> String {
    name.strip_prefix(PREFIX).unwrap_or(name).to_owned()
}

fn manifest(name: &str) -> String {
    if name == "xtask" { "xtask/Cargo.toml".into() } else { format!("crates/{name}/Cargo.toml") }
}

/// The table of arrows in a Markdown text.
fn table(text: &str) -> Option<BTreeMap<String, Row>> {
    let mut lines = text.lines();
    lines.find(|line| cells(line).is_some_and(|cells| cells == HEADER))?;
    let rows = lines.skip(1).map_while(cells).enumerate();
    let mut table = BTreeMap::new();
    for (number, row) in rows {
        let [crates, uses] = row[..] else { continue };
        let may_use: BTreeSet<String> = match uses {
            "nothing of ours" => BTreeSet::new(),
            "all above" => table.keys().cloned().collect(),
            listed => names(listed),
        };
        for name in names(crates) {
            table.insert(name, Row { number, may_use: may_use.clone() });
        }
    }
    Some(table)
}

/// The cells of a table's row; none for another line.
fn cells(line: &str) -> Option<Vec<&str>> {
    let inner = line.trim().strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(str::trim).collect())
}

/// Names in a list such as ``law, `mesh` (and what they re-export)``.
fn names(list: &str) -> BTreeSet<String> {
    let list = list.split('(').next().unwrap_or_default();
    let name = |word: &str| short(word.trim().trim_matches('`'));
    list.split(',').map(name).filter(|name| !name.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARCHITECTURE: &str = "# Architecture\n\n\
        | crate | may use |\n|---|---|\n\
        | law, signal | nothing of ours |\n\
        | `mesh` | law |\n\
        | study | all above |\n\
        | figure | nothing of ours |\n\
        | cli, xtask | study, figure (and what study re-exports) |\n\nText.\n";

    fn set(names: &[&str]) -> BTreeSet<String> {
        names.iter().map(|&name| name.to_owned()).collect()
    }

    fn one(name: &str, uses: &[&str], uses_in_tests: &[&str]) -> Crate {
        Crate { name: name.into(), uses: set(uses), uses_in_tests: set(uses_in_tests) }
    }

    fn messages(crates: &[Crate]) -> Vec<String> {
        let repository = Repository::of(&[(DOCUMENT, ARCHITECTURE)]);
        check(&repository, crates).iter().map(Finding::to_string).collect()
    }

    #[test]
    fn the_workspace_is_read() {
        let metadata = cargo_metadata::MetadataCommand::new().no_deps().exec().unwrap();
        let crates = crates(&metadata);
        let mesh = crates.iter().find(|found| found.name == "mesh").unwrap();
        assert_eq!(mesh.uses, set(&["law"]));
        assert!(crates.iter().any(|found| found.name == "xtask"));
    }

    #[test]
    fn the_table_is_read() {
        let table = table(ARCHITECTURE).unwrap();
        assert_eq!(table["study"].may_use, set(&["law", "signal", "mesh"]));
        assert_eq!(table["xtask"], Row { number: 4, may_use: set(&["study", "figure"]) });
        assert_eq!(table["signal"].may_use, set(&[]));
    }

    #[test]
    fn allowed_arrows_pass() {
        let crates = [
            one("law", &[], &[]),
            one("mesh", &["law"], &["signal"]),
            one("cli", &["figure", "study"], &["law"]),
        ];
        assert_eq!(messages(&crates), [""; 0]);
    }

    #[test]
    fn an_arrow_outside_the_table_is_found() {
        assert_eq!(
            messages(&[one("mesh", &["law", "signal"], &[])]),
            ["crates/mesh/Cargo.toml: `mesh` uses `signal`; ARCHITECTURE.md allows it law"]
        );
    }

    #[test]
    fn an_upward_arrow_of_tests_is_found() {
        assert_eq!(messages(&[one("law", &[], &["mesh"])]).len(), 1);
        assert_eq!(messages(&[one("law", &[], &["signal"])]).len(), 1, "the same row");
    }

    #[test]
    fn a_crate_without_a_row_and_a_missing_table_are_found() {
        assert_eq!(messages(&[one("harmonic", &[], &[])]).len(), 1);
        assert_eq!(check(&Repository::of(&[(DOCUMENT, "# None\n")]), &[]).len(), 1);
    }
}
