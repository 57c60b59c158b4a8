//! Errors of options in words.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::error::Error as _;

use crate::progress::show_line;

/// Shows an error of the command line on standard error, which may be closed or full.
pub(crate) fn show(error: &clap::Error) {
    match plain(error) {
        Some(text) => show_line(&format!("error: {text}")),
        None => drop(error.print()),
    }
    if let Some(hint) = hint(error) {
        show_line(&format!("hint: {hint}"));
    }
}

/// A value that its own reader refuses, in the words of the reader alone: these name the value and
/// what is accepted.
fn plain(error: &clap::Error) -> Option<String> {
    let reason = error.source()?.to_string();
    let value = text(error, ContextKind::InvalidValue)?;
    let option = text(error, ContextKind::InvalidArg)?;
    let names_it = error.kind() == ErrorKind::ValueValidation && reason.contains(&value);
    names_it.then(|| format!("{}: {reason}", option.split(' ').next().unwrap_or(&option)))
}

/// The channel option `--force` of `analyse`, where other commands have it for `--overwrite`.
fn hint(error: &clap::Error) -> Option<&'static str> {
    let option = text(error, ContextKind::InvalidArg)?;
    let without_value = text(error, ContextKind::InvalidValue).is_none_or(|value| value.is_empty());
    (option == "--force <CHANNEL>" && without_value).then_some(
        "--force selects the channel of the force; --overwrite replaces existing results",
    )
}

fn text(error: &clap::Error, kind: ContextKind) -> Option<String> {
    match error.get(kind)? {
        ContextValue::String(text) => Some(text.clone()),
        _ => None,
    }
}
