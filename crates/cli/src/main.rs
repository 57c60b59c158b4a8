//! The `asperity` command: parse, call the study, print. No numerics live here.
//!
//! | module | does |
//! |---|---|
//! | [`mod@answer`] | answers on standard output |
//! | [`args`] | the options |
//! | [`command`] | one file per subcommand |
//! | [`plot`] | the figures that the subcommands write |
//! | [`failure`] | what went wrong, its exit status, and how it is shown |
//! | [`progress`] | bars on a terminal, logs on standard error |
#![allow(clippy::print_stderr, reason = "a command prints its errors to standard error")]

#[macro_use]
mod answer;
mod args;
mod command;
mod failure;
mod plot;
mod progress;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};
use failure::Failure;

fn main() -> ExitCode {
    let args = Args::parse();
    let searching = matches!(args.command, Command::Identify { .. });
    progress::start_logging(args.verbosity(), searching);
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.show();
            failure.exit_code()
        }
    }
}

fn run(args: &Args) -> Result<(), Failure> {
    match &args.command {
        Command::Simulate { input, output, record } => {
            command::simulate::run(input, output, *record, args.quiet)
        }
        Command::Sweep { input, output, vary, threads } => {
            command::sweep::run(input, output, vary, *threads, args.quiet)
        }
        Command::Steady { input, output, range, threads } => {
            command::steady::run(input, output, range, *threads, args.quiet)
        }
        Command::Law { input, output, fit } => command::law::run(input, output, fit.as_deref()),
        Command::Modes { input, output, count } => command::modes::run(input, output, *count),
        Command::Check { input, json } => command::check::run(input, *json),
        Command::Schema { identify } => command::schema::run(*identify),
        Command::Identify { problem, output, threads } => {
            command::identify::run(problem, output, *threads, args.quiet)
        }
        Command::Analyse(asked) => command::analyse::run(asked, args.quiet),
        Command::Convert { input, output, knowledge, to, si, json } => {
            let written = command::convert::Written { to: *to, si: *si, json: *json };
            command::convert::run(input, output, knowledge, written, args.quiet)
        }
    }
}
