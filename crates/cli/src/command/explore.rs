//! `asperity explore`.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity_explore::{ExploreOptions, Server};

use super::stop_on_signals;
use crate::args::Input;
use crate::failure::Failure;

/// Serves the live page of a scenario, until Ctrl-C.
pub(crate) fn run(
    input: &Input,
    options: &ExploreOptions,
    state: Option<&str>,
    no_browser: bool,
    quiet: bool,
) -> Result<(), Failure> {
    let document = super::read(input)?;
    if document.has_matrices() {
        super::patches::checked(&document)?;
    } else {
        super::checked(&document)?;
    }
    let server = Server::of(document, options)?;
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signals(&stop);
    let fragment = state.map(|text| format!("#{}", text.trim_start_matches('#')));
    let url = server.url() + &fragment.unwrap_or_default();
    answer_line!("{url}");
    crate::answer::finish()?;
    if !quiet {
        crate::progress::show_line("the page is open until Ctrl-C");
    }
    if !no_browser && has_browser() && open::that_detached(&url).is_err() {
        tracing::info!("no browser was opened");
    }
    server.run(&stop)?;
    Ok(())
}

/// True where a browser may be shown: on Linux and its like in a graphical session.
fn has_browser() -> bool {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(all(unix, not(target_os = "macos"))) || is_set("DISPLAY") || is_set("WAYLAND_DISPLAY")
}
