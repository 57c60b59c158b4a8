//! Development tasks of asperity.
//!
//! | task | file | does |
//! |---|---|---|
//! | `cargo xtask ci` | `ci` | everything CI checks, in order, up to the first failure |
//! | `cargo xtask tidy` | `tidy` | holds the repository to its rules |
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tasks report to a terminal")]

mod ci;
mod tidy;
// WIRE reproduce (1 of 3): `mod reproduce;`, and its row in the table above.

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
    Ci,
    /// Hold the repository to its rules.
    Tidy,
    // WIRE reproduce (2 of 3): `Reproduce(reproduce::Arguments)`. `ci` runs
    // `cargo xtask reproduce --check` as soon as this subcommand exists.
}

fn main() -> ExitCode {
    let passed = match Cli::parse().task {
        Task::Ci => ci::run(&Cli::command()),
        Task::Tidy => tidy::run(&Cli::command()),
        // WIRE reproduce (3 of 3): `Task::Reproduce(arguments) => reproduce::run(&arguments)`.
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
