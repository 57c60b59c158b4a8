//! `asperity schema`.

use crate::failure::Failure;

/// Prints the JSON Schema of the scenario.
#[allow(clippy::unnecessary_wraps, reason = "every subcommand has the same signature")]
pub(crate) fn run() -> Result<(), Failure> {
    answer!("{}", super::pretty(asperity_study::schema::schema()));
    Ok(())
}
