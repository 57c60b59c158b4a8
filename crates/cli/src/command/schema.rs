//! `asperity schema`.

use asperity_identify::problem::problem_schema;
use asperity_scenario::{scenario_schema, structure_schema};
use asperity_study::study_schema;

use crate::failure::Failure;
use crate::rig::rig_schema;

/// Prints the JSON Schema of the scenario, or of what is `asked` for: a problem, the settings of a rig, a study
/// file, a structure of matrices.
#[allow(clippy::unnecessary_wraps, reason = "every subcommand has the same signature")]
pub(crate) fn run(asked: [bool; 4]) -> Result<(), Failure> {
    let schema = match asked {
        [true, ..] => problem_schema(),
        [_, true, ..] => rig_schema(),
        [_, _, true, _] => study_schema(),
        [.., true] => structure_schema(),
        _ => scenario_schema(),
    };
    answer!("{}", super::pretty(schema));
    Ok(())
}
