//! The `asperity` command: parses the options, calls the libraries, prints the results.
//!
//! [`run`] is the whole command as a function. The program `asperity` and the console script of the Python
//! package call it.
//!
//! | module | does |
//! |---|---|
//! | `answer` | answers on standard output |
//! | `args` | the options |
//! | `command` | the subcommands, one a file |
//! | `failure` | errors, their exit status and their hints |
//! | `file_kind` | kinds of input files |
//! | `usage` | errors of options in words |
//! | `excerpt` | the lines of a text that an error is about |
//! | `progress` | progress bars, logs and messages on standard error |

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

use std::ffi::OsString;

use asperity_explore::ExploreOptions;
use clap::{ColorChoice, CommandFactory, FromArgMatches};

use args::{Args, Command};
use failure::Failure;

/// Carries out a command line, whose first argument is the name of the program, and returns the exit
/// status: 0 done, 1 the run failed, 2 the request is wrong, 130 stopped by a signal.
///
/// Answers go to standard output, progress and errors to standard error. Commands that are stopped
/// between their steps handle SIGINT and SIGTERM themselves from then on.
///
/// ```
/// assert_eq!(asperity_cli::run(["asperity", "check", "../simulation/examples/block.json"]), 0);
/// assert_eq!(asperity_cli::run(["asperity", "check", "absent.json"]), 2);
/// ```
pub fn run<T: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = T>) -> u8 {
    let outcome = parsed(arguments).and_then(|args| match args {
        Some(args) => execute(&args),
        None => Ok(()),
    });
    // A failed command may have printed too.
    let finished = answer::finish();
    match outcome.and(finished) {
        Ok(()) => 0,
        Err(failure) => {
            failure.show();
            failure.exit_status()
        }
    }
}

/// The options; none if the help or the version has been printed.
fn parsed<T: Into<OsString> + Clone>(
    arguments: impl IntoIterator<Item = T>,
) -> Result<Option<Args>, Failure> {
    let colors = if progress::takes_colors() { ColorChoice::Auto } else { ColorChoice::Never };
    let matches = Args::command().color(colors).try_get_matches_from(arguments);
    match matches.and_then(|matches| Args::from_arg_matches(&matches)) {
        Ok(args) => Ok(Some(args)),
        Err(error) if error.use_stderr() => Err(Failure::Usage(error)),
        Err(help) => {
            answer::write(format_args!(""))?;
            help.print().map_err(Failure::Answer)?;
            Ok(None)
        }
    }
}

fn execute(args: &Args) -> Result<(), Failure> {
    let identifying = matches!(args.command, Command::Identify { .. });
    progress::start_logging(args.verbosity(), args.log_format, identifying);
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
        Command::Explore { input, port, no_browser, state, out, data } => {
            let mut options = ExploreOptions::default();
            (options.port, options.out, options.data) = (*port, out.clone(), data.clone());
            options.set.clone_from(&input.set);
            command::explore::run(input, &options, state.as_deref(), *no_browser, args.quiet)
        }
        Command::Law { input, output, export, fit, import_gaps } => {
            command::law::run(input, output, export, fit.as_deref(), import_gaps.as_deref())
        }
        Command::Modes { input, output, count } => command::modes::run(input, output, *count),
        Command::Check { input, json } => command::check::run(input, *json),
        Command::Schema { identify, rig, study, matrices } => {
            command::schema::run([*identify, *rig, *study, *matrices])
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
