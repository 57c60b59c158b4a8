//! Progress bars on a terminal and logs on standard error, both through one [`MultiProgress`], so
//! that a line of the log does not break a bar.

use std::io::{IsTerminal, Write, stderr};
use std::sync::{LazyLock, OnceLock};

use clap::ValueEnum;
use indicatif::{HumanDuration, MultiProgress, ProgressBar, ProgressState, ProgressStyle};
use tracing_subscriber::filter::{EnvFilter, LevelFilter};
use tracing_subscriber::fmt::format::FmtSpan;
use tracing_subscriber::fmt::time::uptime;

static TERMINAL: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);
static LOG_FORMAT: OnceLock<LogFormat> = OnceLock::new();

/// Format of the log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LogFormat {
    /// A line of text for each event.
    Text,
    /// A JSON object on a line for each event.
    Json,
}

/// Standard error, above the progress bars. A closed or full one loses the text, without an error:
/// the exit status remains.
struct LogWriter;

impl Write for LogWriter {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let _ = TERMINAL.suspend(|| stderr().write_all(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Writes text to standard error, above the progress bars, with a line break at its end.
/// Characters that would control the terminal or reorder the text, as names and files may contain
/// them, are replaced.
pub(crate) fn show_line(text: &str) {
    let plain: String =
        text.chars().map(|c| if is_deceptive(c) { '\u{fffd}' } else { c }).collect();
    show_styled(&plain);
}

/// Writes text that may contain the escape sequences of its own styles to standard error.
pub(crate) fn show_styled(text: &str) {
    let _ = LogWriter.write_all(format!("{text}\n").as_bytes());
}

/// True for control characters but the line break and the tab, and for those that change the
/// direction of the text.
fn is_deceptive(character: char) -> bool {
    let directs = matches!(character, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    directs || (character.is_control() && !matches!(character, '\n' | '\t'))
}

/// True if standard error takes colours: it is a terminal, and `NO_COLOR` is not set or empty.
pub(crate) fn takes_colors() -> bool {
    stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Starts logging at `verbosity`: -1 errors only, 0 warnings, 1 the times of the stages of a run,
/// 2 and more details. `RUST_LOG` overrides it.
///
/// While `identifying`, the integrator's warnings need a verbosity of 1: most laws that the search
/// tries are far from the law found.
pub(crate) fn start_logging(verbosity: i8, format: LogFormat, identifying: bool) {
    let level = match verbosity {
        ..0 => LevelFilter::ERROR,
        0 => LevelFilter::WARN,
        1 => LevelFilter::INFO,
        2 => LevelFilter::DEBUG,
        _ => LevelFilter::TRACE,
    };
    let mut filter = EnvFilter::builder().with_default_directive(level.into()).from_env_lossy();
    if identifying && verbosity == 0 && std::env::var_os("RUST_LOG").is_none() {
        filter = EnvFilter::new("warn,asperity_dynamics=error");
    }
    let log = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_span_events(FmtSpan::CLOSE)
        .with_ansi(takes_colors())
        .with_writer(|| LogWriter);
    let _ = LOG_FORMAT.set(format);
    // A second start in one process is the only way to fail, and harmless.
    let _ = match format {
        LogFormat::Text if verbosity > 0 => log.with_target(false).with_timer(uptime()).try_init(),
        LogFormat::Text => log.with_target(false).without_time().try_init(),
        LogFormat::Json => log.json().flatten_event(true).try_init(),
    };
}

/// True if standard error takes one JSON object a line.
pub(crate) fn logs_json() -> bool {
    LOG_FORMAT.get() == Some(&LogFormat::Json)
}

/// Writes notices to standard error.
pub(crate) fn show_notices<T: std::fmt::Display>(notices: impl IntoIterator<Item = T>) {
    for notice in notices {
        if logs_json() {
            tracing::warn!("{notice}");
        } else {
            show_line(&format!("note: {notice}"));
        }
    }
}

/// A bar of `length` steps of the whole of a command, whose message tells the time left; nothing where
/// standard error is not a terminal.
pub(crate) fn whole_bar(length: u64, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("[{bar:40}] {percent} % {elapsed} {msg}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    TERMINAL.add(ProgressBar::new(length).with_style(style.progress_chars("=> ")))
}

/// A bar of `length` steps on standard error; nothing where that is not a terminal.
pub(crate) fn bar(length: u64, message: &'static str, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len} {elapsed}{left}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    let style = style.with_key("left", |state: &ProgressState, text: &mut dyn std::fmt::Write| {
        let left = state.eta();
        // Nothing is known before the first step, and nothing is left after the last.
        if state.pos() > 0 && !left.is_zero() {
            let _ = write!(text, " (left: {:#})", HumanDuration(left));
        }
    });
    let bar = ProgressBar::new(length).with_style(style.progress_chars("=> "));
    TERMINAL.add(bar.with_message(message))
}
