//! `asperity schema`.

use asperity_identify::problem::problem_schema;
use asperity_scenario::scenario_schema;
use asperity_study::study_schema;

use crate::failure::Failure;
use crate::rig::rig_schema;

/// Prints the JSON Schema of the scenario, of a problem, of a study file, or of the settings of a rig.
#[allow(clippy::unnecessary_wraps, reason = "every subcommand has the same signature")]
pub(crate) fn run(identify: bool, rig: bool, study: bool) -> Result<(), Failure> {
    let schema = match (identify, rig, study) {
        (true, ..) => problem_schema(),
        (_, true, _) => rig_schema(),
        (.., true) => study_schema(),
        _ => scenario_schema(),
    };
    answer!("{}", super::pretty(schema));
    Ok(())
}
