//! `cargo xtask bench`: the speed of the kernels, of rows of studies, of a sweep, of steady responses and of large
//! structures of matrices, as tables.

mod reductions;

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde_json::Value;

use crate::workspace::{cargo, workspace_root};

/// Runs of the sweep that is timed.
const RUNS: usize = 100_000;

/// The scenario of the sweep.
const SCENARIO: &str = "fixtures/scenarios/nouira2020-modified.json";

/// Force amplitudes of steady responses that are timed \[N\]: one, for the start-up, and all.
const AMPLITUDES: [&str; 2] =
    ["0.5", "0.5,0.51,0.52,0.53,0.54,0.55,0.56,0.57,0.58,0.59,0.6,0.61,0.62"];

/// Runs the kernel benchmarks, then a sweep and steady responses from the command line to their CSV.
///
/// Numbers hold for this machine, as busy as it is; the ratios hold elsewhere.
pub(crate) fn run() -> Result<bool> {
    for (package, bench) in [
        ("asperity-dynamics", "modal"),
        ("asperity-dynamics", "loss_of_contact"),
        ("asperity-dynamics", "finite_difference"),
        ("asperity-harmonic", "continuation"),
        ("asperity-simulation", "rows"),
    ] {
        let passed = cargo(&["bench", "--package", package, "--bench", bench])
            .status()
            .context("cargo bench cannot be started")?;
        ensure!(passed.success(), "the benchmark \"{bench}\" failed");
        println!();
    }
    let built = cargo(&["build", "--release", "--package", "asperity-cli"]).status();
    ensure!(built.context("cargo build cannot be started")?.success(), "the command was not built");
    let folder = tempfile::tempdir().context("no temporary folder")?;
    let vary = format!("/excitation/peak_n=9:32:{RUNS}");
    let started = Instant::now();
    let swept = cargo(&["run", "--release", "--quiet", "--package", "asperity-cli", "--"])
        .args(["sweep", SCENARIO, "--set", "/method=modal", "--vary", &vary])
        .args(["--quiet", "--out"])
        .arg(folder.path())
        .status()
        .context("the sweep cannot be started")?;
    let seconds = started.elapsed().as_secs_f64();
    ensure!(swept.success(), "the sweep failed");
    println!("| sweep, all cores | hits | s | hits/s |");
    println!("|---|---|---|---|");
    println!("| observables, CSV, figure | {RUNS} | {seconds:.2} | {:.0} |", RUNS as f64 / seconds);
    println!();
    steady()?;
    reductions::run(&workspace_root().join("target/release/asperity"))?;
    Ok(true)
}

/// Microseconds a point of steady responses with stability, one thread: the time of the command with
/// many force amplitudes less that with one, over the points.
fn steady() -> Result<()> {
    let folder = tempfile::tempdir().context("no temporary folder")?;
    let run = |amplitudes: &str| -> Result<(f64, f64)> {
        let started = Instant::now();
        let traced = cargo(&["run", "--release", "--quiet", "--package", "asperity-cli", "--"])
            .args(["steady", SCENARIO, "--amplitude", amplitudes, "--from", "1000", "--to", "600"])
            .args(["--harmonics", "7", "--threads", "1", "--overwrite", "--quiet", "--out"])
            .arg(folder.path().join("steady"))
            .status()
            .context("the steady responses cannot be started")?;
        let seconds = started.elapsed().as_secs_f64();
        ensure!(traced.success(), "the steady responses failed");
        let written = std::fs::read_to_string(folder.path().join("steady/summary.json"))?;
        let summary: Value = serde_json::from_str(&written)?;
        let levels = summary["levels"].as_array().context("a summary without levels")?;
        Ok((seconds, levels.iter().filter_map(|level| level["points"].as_f64()).sum()))
    };
    println!("| steady, one thread, 7 harmonics, with stability | points | us a point |");
    println!("|---|---|---|");
    for _ in 0..3 {
        let [(first, few), (all, many)] = [run(AMPLITUDES[0])?, run(AMPLITUDES[1])?];
        let points = many - few;
        println!("| command less start-up | {points} | {:.0} |", 1e6 * (all - first) / points);
    }
    Ok(())
}
