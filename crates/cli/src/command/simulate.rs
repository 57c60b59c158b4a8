//! `asperity simulate`.

use asperity_plot as plot;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::run::simulate_with_progress;
use serde_json::json;

use super::ResultFolder;
use super::shown::{with_percents, write_run};
use crate::args::analyse::RecordFormat;
use crate::args::figures::MagnitudeAxis;
use crate::args::{Input, Output};
use crate::failure::Failure;

/// Simulates one hit; writes summary, history, FRF and figures.
pub(crate) fn run(
    input: &Input,
    output: &Output,
    record: Option<RecordFormat>,
    magnitude: MagnitudeAxis,
    quiet: bool,
) -> Result<(), Failure> {
    let document = super::read(input)?;
    if document.has_matrices() {
        return super::patches::simulate(&document, output, record, magnitude, quiet);
    }
    let scenario = super::checked(&document)?;
    let folder = ResultFolder::claim("simulate", document.path(), output)?;
    // A scenario that cannot be assembled is an error of the run.
    if let Ok(assembly) = Assembly::new(&scenario, document.folder()) {
        super::show_unusual_values(&assembly, quiet);
    }

    let run =
        with_percents(quiet, |progress| simulate_with_progress(&document, &scenario, progress))?;
    write_run(&folder, &run, record, magnitude)?;
    let folder = folder.finish("summary.json", &json!(run.summary), output.json)?;
    if !output.json && !quiet {
        answer!("{}", plot::run_words(&run.summary));
        answer_line!("written to {}", folder.display());
    }
    Ok(())
}
