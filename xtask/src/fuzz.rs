//! `cargo xtask fuzz`: every fuzz target for a time, one after the other.
//!
//! The targets of `fuzz/` are built by the stable compiler with the flags of cargo-fuzz, coverage
//! and `AddressSanitizer`. Each starts from its kept corpus in `fuzz/corpus/` and from fixtures; new
//! inputs go to `target/fuzz/corpus/`, failing ones to `target/fuzz/artifacts/`.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use crate::workspace::cargo;

/// Flags of the compiler: coverage counters, comparisons, `AddressSanitizer`, all checks.
const FLAGS: &str = "--cfg fuzzing -Cpasses=sancov-module \
     -Cllvm-args=-sanitizer-coverage-level=4 \
     -Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
     -Cllvm-args=-sanitizer-coverage-pc-table \
     -Cllvm-args=-sanitizer-coverage-trace-compares \
     -Zsanitizer=address -Cdebug-assertions -Coverflow-checks";

/// Target, longest input, and fixtures that it starts from: a folder, the extension of its files,
/// and the bytes at their start that the target puts there itself.
type Target = (&'static str, usize, Option<(&'static str, &'static str, usize)>);

const MEASURED: &str = "fixtures/reference/measure";

const TARGETS: [Target; 17] = [
    ("scenario", 4096, Some(("fixtures/scenarios", "json", 0))),
    ("set", 256, None),
    ("vary", 256, None),
    ("problem", 8192, Some(("fixtures/problems", "json", 0))),
    ("load_samples", 4096, Some(("fixtures/scenarios", "csv", 0))),
    ("law", 128, None),
    ("step", 256, None),
    ("universal", 1 << 16, Some((MEASURED, "uff", 15))),
    ("text", 1 << 16, Some(("fixtures/scenarios", "csv", 0))),
    ("npy", 1 << 16, Some((MEASURED, "npy", 6))),
    ("npz", 1 << 16, Some((MEASURED, "npz", 4))),
    ("mat", 1 << 16, Some((MEASURED, "mat", 128))),
    ("wav", 1 << 16, None),
    ("tdms", 1 << 16, Some((MEASURED, "tdms", 4))),
    ("hdf5", 1 << 16, Some((MEASURED, "h5", 8))),
    ("matrices", 1 << 14, None),
    ("deck", 1 << 14, None),
];

/// Options of `cargo xtask fuzz`.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Time for each target in s.
    #[arg(long, value_name = "N", default_value_t = 60)]
    seconds: u64,
    /// Targets; all when none is named.
    #[arg(value_name = "TARGET")]
    targets: Vec<String>,
}

/// Runs the targets; true if none finds a fault.
pub(crate) fn run(arguments: &Arguments) -> Result<bool> {
    let known: Vec<&str> = TARGETS.iter().map(|target| target.0).collect();
    if let Some(unknown) = arguments.targets.iter().find(|name| !known.contains(&name.as_str())) {
        bail!("there is no target \"{unknown}\"; accepted: {}", known.join(", "));
    }
    let root = std::path::absolute(crate::workspace::workspace_root())?;
    let programs = build(&root)?;
    let mut failed = Vec::new();
    for target in &TARGETS {
        let (name, longest, seeds) = *target;
        let wanted = &arguments.targets;
        if !wanted.is_empty() && !wanted.iter().any(|one| one == name) {
            continue;
        }
        let folder = root.join("target/fuzz");
        let (corpus, artifacts) = (folder.join("corpus").join(name), folder.join("artifacts"));
        for folder in [&corpus, &artifacts] {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("creating {}", folder.display()))?;
        }
        if let Some(seeds) = seeds {
            copy_seeds(&root, seeds, &corpus)?;
        }
        println!("fuzz: {name}, {} s", arguments.seconds);
        let kept = root.join("fuzz/corpus").join(name);
        // Documents name files: they are looked for in a folder without any.
        let status = Command::new(programs.join(name))
            .current_dir(&artifacts)
            .arg(&corpus)
            .args(kept.is_dir().then_some(kept))
            .arg(format!("-max_total_time={}", arguments.seconds))
            .arg(format!("-max_len={longest}"))
            .arg(format!("-artifact_prefix={}/{name}-", artifacts.display()))
            .args(["-rss_limit_mb=2048", "-timeout=30", "-verbosity=0", "-print_final_stats=1"])
            .status()
            .with_context(|| format!("the target {name} cannot be started"))?;
        if !status.success() {
            failed.push(name);
        }
    }
    if !failed.is_empty() {
        println!("fuzz: FAILED: {}; inputs in target/fuzz/artifacts", failed.join(", "));
    }
    Ok(failed.is_empty())
}

/// Builds all targets and returns the folder of the programs.
fn build(root: &Path) -> Result<PathBuf> {
    let package = root.join("fuzz");
    // The versions that the workspace is tested with.
    let lock = package.join("Cargo.lock");
    if !lock.exists() {
        std::fs::copy(root.join("Cargo.lock"), &lock).context("copying Cargo.lock")?;
    }
    let host = host()?;
    let folder = root.join("target/fuzz");
    // Naming the target triple keeps the flags away from build scripts.
    let status = cargo(&["build", "--release", "--target", &host, "--target-dir"])
        .arg(&folder)
        .arg("--manifest-path")
        .arg(package.join("Cargo.toml"))
        .env("RUSTC_BOOTSTRAP", "1")
        .env("RUSTFLAGS", FLAGS)
        .status()
        .context("cargo build cannot be started")?;
    ensure!(status.success(), "the targets were not built");
    Ok(folder.join(host).join("release"))
}

/// Target triple of this machine.
fn host() -> Result<String> {
    let output = Command::new("rustc").arg("-vV").output().context("rustc cannot be started")?;
    let text = String::from_utf8_lossy(&output.stdout);
    let line = text.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(line.context("rustc names no host")?.to_owned())
}

/// Copies fixtures to the corpus, without the bytes that the target puts before its input.
fn copy_seeds(root: &Path, seeds: (&str, &str, usize), corpus: &Path) -> Result<()> {
    let (folder, extension, mark) = seeds;
    let folder = root.join(folder);
    let entries =
        std::fs::read_dir(&folder).with_context(|| format!("reading {}", folder.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|found| found == extension)
            && let Some(name) = path.file_name()
        {
            let bytes =
                std::fs::read(&path).with_context(|| format!("reading {}", path.display()))?;
            let rest = bytes.get(mark..).unwrap_or_default();
            std::fs::write(corpus.join(name), rest)
                .with_context(|| format!("writing into {}", corpus.display()))?;
        }
    }
    Ok(())
}
