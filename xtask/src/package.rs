//! Packages of the workspace, each checked from its own archive.
//!
//! `cargo package` builds every package by itself, with the features that it alone needs, and so
//! compiles most dependencies several times. Here the archives are unpacked into one workspace,
//! in which each package stands for the published one, and checked together: a file or feature
//! that an archive lacks is found all the same.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use flate2::read::GzDecoder;

use crate::workspace::{cargo, workspace_root};

/// Packs all packages and checks libraries, commands and examples from the archives; true if all
/// compile.
pub(crate) fn run() -> Result<bool> {
    Ok(pack()? && check()?)
}

/// Folders of the archives and of the workspace of their contents.
fn folders() -> Result<[PathBuf; 2]> {
    let packages = std::path::absolute(workspace_root().join("target/packages"))?;
    Ok([packages.join("package"), packages.join("workspace")])
}

/// Packs all packages into archives, apart from what cargo builds meanwhile; true if it succeeds.
pub(crate) fn pack() -> Result<bool> {
    let [archives, unpacked] = folders()?;
    for folder in [&archives, &unpacked] {
        if folder.exists() {
            fs::remove_dir_all(folder).with_context(|| folder.display().to_string())?;
        }
    }
    // Uncommitted changes are packed too.
    let pack = "package --workspace --exclude xtask --exclude asperity-python --allow-dirty \
                --no-verify --quiet";
    let packed = cargo(&pack.split(' ').collect::<Vec<_>>())
        .env("CARGO_TARGET_DIR", archives.parent().context("no folder of archives")?)
        .status()
        .context("cannot run cargo package")?;
    Ok(packed.success())
}

/// Checks libraries, commands and examples from the archives; true if all compile.
pub(crate) fn check() -> Result<bool> {
    let [archives, unpacked] = folders()?;
    for entry in fs::read_dir(&archives)? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "crate") {
            let mut archive = tar::Archive::new(GzDecoder::new(File::open(&path)?));
            // All files of archives have one time, by which a change since the last run would not be seen.
            archive.set_preserve_mtime(false);
            archive.unpack(&unpacked).with_context(|| path.display().to_string())?;
        }
    }
    let root = fs::read_to_string(workspace_root().join("Cargo.toml"))?;
    fs::write(unpacked.join("Cargo.toml"), manifest(&unpacked, profiles(&root))?)?;
    fs::copy(workspace_root().join("Cargo.lock"), unpacked.join("Cargo.lock"))?;
    let check = "check --workspace --all-features --lib --bins --examples";
    let checked = cargo(&check.split(' ').collect::<Vec<_>>())
        .current_dir(&unpacked)
        .env("CARGO_TARGET_DIR", std::path::absolute(workspace_root().join("target"))?)
        .status()
        .context("cannot run cargo check")?;
    Ok(checked.success())
}

/// The profiles at the end of the manifest `root`: with others all dependencies would be compiled again.
fn profiles(root: &str) -> &str {
    root.find("[profile.").map_or("", |start| &root[start..])
}

/// Manifest of a workspace of the unpacked packages, each of which replaces the published one, with
/// these `profiles`.
fn manifest(unpacked: &Path, profiles: &str) -> Result<String> {
    let version = concat!("-", env!("CARGO_PKG_VERSION"));
    let mut patches = Vec::new();
    for entry in fs::read_dir(unpacked)? {
        let folder = entry?.file_name().into_string().unwrap_or_default();
        if let Some(name) = folder.strip_suffix(version) {
            patches.push(format!("{name} = {{ path = \"{folder}\" }}\n"));
        }
    }
    let workspace = "[workspace]\nmembers = [\"*\"]\nresolver = \"3\"\n\n[patch.crates-io]\n";
    Ok(workspace.to_owned() + &patches.concat() + "\n" + profiles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unpacked_packages_replace_the_published_ones() {
        let folder = tempfile::tempdir().unwrap();
        let name = format!("asperity-law-{}", env!("CARGO_PKG_VERSION"));
        fs::create_dir(folder.path().join(&name)).unwrap();
        fs::create_dir(folder.path().join("another")).unwrap();
        let root = "[workspace]\n\n[profile.dev]\nopt-level = 1\n";
        let text = manifest(folder.path(), profiles(root)).unwrap();
        let patch = text.split_once("[patch.crates-io]\n").unwrap().1;
        let profile = "\n[profile.dev]\nopt-level = 1\n";
        assert_eq!(patch, format!("asperity-law = {{ path = \"{name}\" }}\n{profile}"));
    }
}
