//! `asperity schema`.

use asperity_identify::problem::problem_schema;
use asperity_scenario::scenario_schema;

use crate::failure::Failure;
use crate::rig::rig_schema;

/// Prints the JSON Schema of the scenario, of a problem, or of the settings of a rig.
#[allow(clippy::unnecessary_wraps, reason = "every subcommand has the same signature")]
pub(crate) fn run(identify: bool, rig: bool) -> Result<(), Failure> {
    let schema = match (identify, rig) {
        (true, _) => problem_schema(),
        (_, true) => rig_schema(),
        _ => scenario_schema(),
    };
    answer!("{}", super::pretty(schema));
    Ok(())
}
