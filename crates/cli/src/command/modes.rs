//! `asperity modes`.

use asperity_plot as plot;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::modes::{ModesSummary, linearised_modes};
use asperity_simulation::provenance::Provenance;
use asperity_simulation::record::modes_csv;
use serde_json::json;

use super::ResultFolder;
use super::shown::show_modes;
use crate::args::{Input, Output};
use crate::failure::Failure;

/// Computes natural frequencies, damping ratios and mode shapes about static equilibrium.
pub(crate) fn run(input: &Input, output: &Output, count: usize) -> Result<(), Failure> {
    let document = super::read(input)?;
    if document.has_matrices() {
        return super::patches::modes(&document, output, count);
    }
    let scenario = super::checked(&document)?;
    let assembly = Assembly::new(&scenario, document.folder())?;
    let found = linearised_modes(&assembly, count)?;
    let folder = ResultFolder::claim("modes", document.path(), output)?;

    folder.write("modes.csv", modes_csv(&found))?;
    folder.draw("modes", &plot::modes(&found))?;
    let provenance = Provenance::of_scenario(&document, &scenario)?;
    let answer = ModesSummary::new(&scenario, &assembly, &found, provenance);
    let folder = folder.finish("modes.json", &json!(answer), output.json)?;
    if output.json {
        return Ok(());
    }
    show_modes(&answer)?;
    answer_line!("written to {}", folder.display());
    Ok(())
}
