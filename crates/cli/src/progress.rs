//! Progress on a terminal, logs on standard error.

use indicatif::{ProgressBar, ProgressStyle};
use tracing_indicatif::IndicatifLayer;
use tracing_subscriber::filter::{EnvFilter, LevelFilter};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

/// Starts logging at `verbosity`: -1 errors only, 0 warnings, 1 information, 2 and more details.
/// With `searching` the integrator's warnings wait for one more: a search goes through laws that
/// nobody asked for. The environment variable `RUST_LOG` overrides it.
pub(crate) fn start_logging(verbosity: i8, searching: bool) {
    let level = match verbosity {
        ..0 => LevelFilter::ERROR,
        0 => LevelFilter::WARN,
        1 => LevelFilter::INFO,
        2 => LevelFilter::DEBUG,
        _ => LevelFilter::TRACE,
    };
    let mut filter = EnvFilter::builder().with_default_directive(level.into()).from_env_lossy();
    if searching && verbosity == 0 && std::env::var_os("RUST_LOG").is_none() {
        filter = EnvFilter::new("warn,asperity_dynamics=error");
    }
    let bars = IndicatifLayer::new();
    let lines = tracing_subscriber::fmt::layer()
        .with_writer(bars.get_stderr_writer())
        .with_target(false)
        .without_time();
    // A second start in one process is the only way to fail, and harmless.
    let _ = tracing_subscriber::registry().with(filter).with(lines).with(bars).try_init();
}

/// A bar of `length` steps on standard error; nothing where that is no terminal.
pub(crate) fn bar(length: u64, what: &'static str, quiet: bool) -> ProgressBar {
    if quiet {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template("{msg} [{bar:40}] {pos}/{len} {elapsed} (left: {eta})")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style.progress_chars("=> ")).with_message(what)
}
