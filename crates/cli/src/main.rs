//! The `asperity` command: parses the options, calls the libraries, prints the results.
//!
//! | module | does |
//! |---|---|
//! | [`mod@answer`] | answers on standard output |
//! | [`args`] | the options |
//! | [`command`] | the subcommands, one a file |
//! | [`plot`] | the figures that the subcommands write |
//! | [`failure`] | errors, their exit status and their hints |
//! | [`progress`] | progress bars and logs on standard error |
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
    let identifying = matches!(args.command, Command::Identify { .. });
    progress::start_logging(args.verbosity(), args.log_format, identifying);
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
        Command::Convert(asked) => command::convert::run(asked, args.quiet),
    }
}
