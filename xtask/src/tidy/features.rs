//! One build for all: `cargo xtask` and the Python package are compiled with the features that the
//! tests of the whole workspace are compiled with, so that no package is compiled twice.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context, Result, ensure};

use super::Finding;
use crate::workspace::cargo;

/// File that asks for the features.
const ALIGNED: &str = "xtask/features/Cargo.toml";

/// The packages that the tests of the workspace compile, as arguments of `cargo tree`.
const WHOLE: &str = "--workspace --all-features --edges all";

/// The packages of the other builds, as arguments of `cargo tree`.
const PARTS: [&str; 2] = [
    "--package xtask --edges normal,build",
    "--package asperity-python --features shared-build --edges normal,build",
];

/// Sets of features, by package and version: that of a program, and that of macros.
type FeatureSets = BTreeMap<String, BTreeSet<String>>;

/// Packages with their features in the whole build and in its parts.
pub(super) struct Compiled {
    whole: FeatureSets,
    parts: Vec<FeatureSets>,
}

impl Compiled {
    /// Reads the packages of this machine's builds from Cargo.
    pub(super) fn read() -> Result<Self> {
        Ok(Self { whole: tree(WHOLE)?, parts: PARTS.into_iter().map(tree).collect::<Result<_>>()? })
    }
}

fn tree(arguments: &str) -> Result<FeatureSets> {
    let mut command = cargo(&["tree", "--prefix", "none", "--format", "{p}|{f}"]);
    let output = command.args(arguments.split(' ')).output().context("cannot run cargo tree")?;
    ensure!(output.status.success(), "cargo tree {arguments} failed");
    Ok(feature_sets(&String::from_utf8_lossy(&output.stdout)))
}

/// The sets of features in lines such as `serde v1.0.200 (*)|default,std`.
fn feature_sets(lines: &str) -> FeatureSets {
    let mut all = FeatureSets::new();
    for line in lines.lines().filter(|line| line.contains('|')) {
        let (package, features) = line.split_once('|').unwrap_or_default();
        // A path, or a mark, follows name and version; a mark may follow the features.
        let name = package.split(' ').take(2).collect::<Vec<_>>().join(" ");
        let features = features.split(' ').next().unwrap_or_default().to_owned();
        all.entry(name).or_default().insert(features);
    }
    all
}

/// Packages that a part compiles with features of its own.
pub(super) fn compiled_twice(compiled: &Compiled) -> Vec<Finding> {
    let mut found = BTreeSet::new();
    for (package, sets) in compiled.parts.iter().flatten() {
        let Some(whole) = compiled.whole.get(package) else { continue };
        for set in sets.difference(whole) {
            let expected = whole.iter().map(|set| format!("\"{set}\"")).collect::<Vec<_>>();
            let expected = expected.join(" or ");
            found.insert(Finding::new(
                ALIGNED,
                format!(
                    "{package} has the features \"{set}\"; in the whole build it has {expected}"
                ),
            ));
        }
    }
    found.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_package_with_other_features_is_named() {
        let whole = feature_sets("serde v1.0.2|default,std\nsyn v3.0.1 (proc-macro)|full\n");
        let part = "serde v1.0.2 (*)|std (*)\nsyn v3.0.1|full\nother v1.0.0 (/here)|\n";
        let compiled = Compiled { whole, parts: vec![feature_sets(part)] };
        let found = compiled_twice(&compiled);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].message.starts_with("serde v1.0.2 has the features \"std\""), "{found:?}");
        assert!(found[0].message.ends_with("it has \"default,std\""), "{found:?}");
    }
}
