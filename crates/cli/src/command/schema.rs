//! `asperity schema`.

use asperity_identify::problem::problem_schema;
use asperity_scenario::scenario_schema;

use crate::failure::Failure;

/// Prints the JSON Schema of the scenario, or of a problem.
#[allow(clippy::unnecessary_wraps, reason = "every subcommand has the same signature")]
pub(crate) fn run(identify: bool) -> Result<(), Failure> {
    let schema = if identify { problem_schema() } else { scenario_schema() };
    answer!("{}", super::pretty(schema));
    Ok(())
}
