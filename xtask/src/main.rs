//! Development tasks of asperity.
//!
//! | task | file | does |
//! |---|---|---|
//! | `cargo xtask ci [--quick]` | `ci` | every check of CI, in order, up to the first failure |
//! | `cargo xtask tidy` | `tidy` | holds the repository to its rules |
//! | `cargo xtask package` | `package` | every package, checked from its own archive |
//! | `cargo xtask python` | `python` | the Python package, built and tested as a wheel |
//! | `cargo xtask bench` | `bench` | speed of the kernels and of a sweep, as one table |
//! | `cargo xtask campaign` | `campaign` | random scenarios through both engines, differences judged |
//! | `cargo xtask fuzz` | `fuzz` | every fuzz target for a time |
//! | `cargo xtask cluster` | `cluster` | a study on a real Slurm on this machine, one shard killed |
//! | `cargo xtask reproduce` | `reproduce` | every figure of the paper, every claim checked |
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tasks report to a terminal")]

mod bench;
mod campaign;
mod ci;
mod cluster;
mod figures;
mod fuzz;
mod hexahedron;
mod package;
mod python;
mod reproduce;
mod solid;
mod tidy;
mod workspace;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

/// Development tasks of asperity.
#[derive(Debug, Parser)]
#[command(name = "xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Run everything CI checks, in order, up to the first failure.
    Ci {
        /// Run the inner loop only: format, lints, unit tests, tidy.
        #[arg(long)]
        quick: bool,
    },
    /// Hold the repository to its rules.
    Tidy,
    /// Check every package from its own archive.
    Package,
    /// Build the Python package as a wheel and test it.
    Python,
    /// Measure the kernels and a sweep of 100 000 hits.
    Bench,
    /// Run random scenarios with both engines and judge where they differ.
    Campaign(campaign::Arguments),
    /// Run the fuzz targets one after the other.
    Fuzz(fuzz::Arguments),
    /// Run a study on a real Slurm of two nodes on this machine, with one shard killed; needs Slurm and
    /// munge.
    Cluster,
    /// Recompute every figure of the paper and check every claim.
    Reproduce(reproduce::Arguments),
}

fn main() -> ExitCode {
    let passed = match Cli::parse().task {
        Task::Ci { quick } => ci::run(quick, &Cli::command()),
        Task::Tidy => tidy::run(&Cli::command()),
        Task::Package => package::run(),
        Task::Python => python::prepare().and_then(|environment| python::run(environment.as_ref())),
        Task::Bench => bench::run(),
        Task::Campaign(arguments) => campaign::run(&arguments),
        Task::Fuzz(arguments) => fuzz::run(&arguments),
        Task::Cluster => cluster::run(),
        Task::Reproduce(arguments) => reproduce::run(&arguments),
    };
    match passed {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
