//! The `asperity` command: parses the options, calls the libraries, prints the results.
//!
//! | module | does |
//! |---|---|
//! | [`mod@answer`] | answers on standard output |
//! | [`args`] | the options |
//! | [`command`] | the subcommands, one a file |
//! | [`failure`] | errors, their exit status and their hints |
//! | [`file_kind`] | kinds of input files |
//! | [`usage`] | errors of options in words |
//! | [`excerpt`] | the lines of a text that an error is about |
//! | [`progress`] | progress bars, logs and messages on standard error |

#[macro_use]
mod answer;
mod args;
mod command;
mod excerpt;
mod failure;
mod file_kind;
mod progress;
mod rig;
mod usage;

use std::process::ExitCode;

use clap::{ColorChoice, CommandFactory, FromArgMatches};

use args::{Args, Command};
use failure::Failure;

fn main() -> ExitCode {
    let colors = if progress::takes_colors() { ColorChoice::Auto } else { ColorChoice::Never };
    let matches = Args::command().color(colors).try_get_matches();
    let args = match matches.and_then(|matches| Args::from_arg_matches(&matches)) {
        Ok(args) => args,
        Err(usage) => return show_usage(&usage),
    };
    let identifying = matches!(args.command, Command::Identify { .. });
    progress::start_logging(args.verbosity(), args.log_format, identifying);
    ended(run(&args).and_then(|()| answer::finish()))
}

fn ended(outcome: Result<(), Failure>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.show();
            failure.exit_code()
        }
    }
}

/// Prints the help or the version on standard output, or the error of an option on standard error.
fn show_usage(error: &clap::Error) -> ExitCode {
    if error.use_stderr() {
        usage::show(error);
        return ExitCode::from(2);
    }
    let printed =
        answer::write(format_args!("")).and_then(|()| error.print().map_err(Failure::Answer));
    ended(printed.and_then(|()| answer::finish()))
}

fn run(args: &Args) -> Result<(), Failure> {
    match &args.command {
        Command::Simulate { input, output, record, magnitude } => {
            command::simulate::run(input, output, *record, *magnitude, args.quiet)
        }
        Command::Sweep { input, output, vary, threads } => {
            command::sweep::run(input, output, vary, *threads, args.quiet)
        }
        Command::Steady { input, output, range, threads } => {
            command::steady::run(input, output, range, *threads, args.quiet)
        }
        Command::Law { input, output, export, fit, import_gaps } => {
            command::law::run(input, output, export, fit.as_deref(), import_gaps.as_deref())
        }
        Command::Modes { input, output, count } => command::modes::run(input, output, *count),
        Command::Check { input, json } => command::check::run(input, *json),
        Command::Schema { identify, rig, study, matrices } => {
            command::schema::run(*identify, *rig, *study, *matrices)
        }
        Command::Study(asked) => command::study::run(asked, args.quiet),
        Command::Identify { problem, fast, output, threads } => {
            command::identify::run(problem, *fast, output, *threads, args.quiet)
        }
        Command::Analyse(asked) => command::analyse::run(asked, args.quiet),
        Command::Watch(asked) => command::watch::run(asked, args.quiet),
        Command::Decay(asked) => command::decay::run(asked, args.quiet),
        Command::Inspect(asked) => command::inspect::run(asked, args.quiet),
        Command::Convert(asked) => command::convert::run(asked, args.quiet),
        Command::Completions { shell } => command::completions::run(*shell),
        Command::Man { folder } => command::man::run(folder, args.quiet),
    }
}
