//! `cargo xtask bench`: the speed of the kernels and of a sweep, as one table.

use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::ci::cargo;

/// Runs of the sweep that is timed.
const RUNS: usize = 100_000;

/// The scenario of the sweep.
const SCENARIO: &str = "fixtures/scenarios/nouira2020-modified.json";

/// Runs the kernel benchmarks, then a sweep from the command line to its CSV.
///
/// Numbers hold for this machine, as busy as it is; the ratios hold elsewhere.
pub(crate) fn run() -> Result<bool> {
    for bench in ["modal", "finite_difference"] {
        let passed = cargo(&["bench", "--package", "asperity-dynamics", "--bench", bench])
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
    Ok(true)
}
