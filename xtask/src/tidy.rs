//! `cargo xtask tidy`: the rules of the repository, as code.
//!
//! | module | rules |
//! |---|---|
//! | `arrows` | crates depend only as the table in ARCHITECTURE.md allows |
//! | `layout` | file names, file lengths, nothing stray at the root |
//! | `sources` | no skipped tests, no unfinished code |
//! | `declarations` | unique names of public types, doc comments that start with their subject |
//! | `manifests` | lints and metadata of every package, a CHANGELOG entry for the version |
//! | `features` | one build of the workspace serves `cargo xtask` and the Python package too |
//! | `links` | links resolve, every page is in the book, paths exist |
//! | `commands` | commands and options named in the documents exist |
//!
//! A rule is a function from a [`Repository`] in memory to its findings; its test gives it a
//! repository that breaks the rule.

mod arrows;
mod commands;
mod declarations;
mod features;
mod layout;
mod links;
mod manifests;
mod markdown;
mod repository;
mod sources;

use std::fmt;

use anyhow::{Context, Result};
use cargo_metadata::MetadataCommand;

use commands::Program;
use repository::Repository;

/// A broken rule, where, and what to do about it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Finding {
    /// A path, with a line where that helps.
    place: String,
    message: String,
}

impl Finding {
    fn new(place: impl Into<String>, message: impl Into<String>) -> Self {
        Self { place: place.into(), message: message.into() }
    }

    fn at(path: &str, line: usize, message: impl Into<String>) -> Self {
        Self::new(format!("{path}:{line}"), message)
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

/// Applies every rule and prints the findings; true if there are none.
/// `tasks` is the command line of xtask.
pub(crate) fn run(tasks: &clap::Command) -> Result<bool> {
    let metadata = MetadataCommand::new().no_deps().exec().context("cannot read cargo metadata")?;
    let repository = Repository::read(metadata.workspace_root.as_std_path())?;
    let programs = [Program::built("asperity")?, Program::of_clap("cargo xtask", tasks)];
    let crates = arrows::crates(&metadata);

    let mut findings = arrows::check(&repository, &crates);
    findings.extend(layout::long_files(&repository));
    findings.extend(layout::short_files(&repository));
    findings.extend(layout::mod_files(&repository));
    findings.extend(layout::vague_names(&repository));
    findings.extend(layout::stray_entries(&repository));
    findings.extend(sources::unfinished(&repository));
    findings.extend(declarations::repeated_types(&repository));
    findings.extend(declarations::openers(&repository));
    findings.extend(manifests::workspace_lints(&repository));
    findings.extend(manifests::publishable(&repository));
    findings.extend(manifests::changelog(&repository, &version(&metadata)));
    findings.extend(features::compiled_twice(&features::Compiled::read()?));
    findings.extend(links::broken_links(&repository));
    findings.extend(links::pages_outside_the_book(&repository));
    findings.extend(links::missing_paths(&repository));
    findings.extend(commands::unknown(&repository, &programs));
    findings.sort();
    for finding in &findings {
        println!("{finding}");
    }
    match findings.len() {
        0 => println!("tidy: {} files keep the rules", repository.paths().count()),
        count => println!("tidy: {count} findings"),
    }
    Ok(findings.is_empty())
}

/// The version that the workspace's crates share.
fn version(metadata: &cargo_metadata::Metadata) -> String {
    let package = metadata.packages.iter().find(|package| package.name.as_str() == "xtask");
    package.map(|package| package.version.to_string()).unwrap_or_default()
}
