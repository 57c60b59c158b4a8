//! `asperity identify`.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use asperity_identify::inference::Progress;
use asperity_identify::{
    Identification, IdentificationError, IdentificationProblem, identify_with_progress,
};
use indicatif::ProgressBar;
use tracing::info_span;

use super::ResultFolder;
use crate::args::Output;
use crate::failure::Failure;
use crate::plot;

/// Identifies the parameters of a problem; writes laws, tables, figures and the report.
pub(crate) fn run(
    path: &Path,
    output: &Output,
    threads: Option<usize>,
    quiet: bool,
) -> Result<(), Failure> {
    let problem = info_span!("read").in_scope(|| IdentificationProblem::read(path))?;
    let folder = ResultFolder::claim("identify", path, output)?;
    let bar: Mutex<Option<(&str, ProgressBar)>> = Mutex::new(None);
    let show = |step: Progress| {
        let stage = step.stage.name();
        let mut bar = bar.lock().unwrap_or_else(PoisonError::into_inner);
        if bar.as_ref().is_none_or(|(name, _)| *name != stage) {
            if let Some((_, old)) = bar.take() {
                old.finish_and_clear();
            }
            *bar = Some((stage, crate::progress::bar(step.of as u64, stage, quiet)));
        }
        if let Some((_, bar)) = bar.as_ref() {
            bar.set_length(step.of as u64);
            bar.set_position(step.done as u64);
        }
    };
    let found = super::on_threads(threads, || identify_with_progress(&problem, &show));
    if let Some((_, bar)) = bar.lock().unwrap_or_else(PoisonError::into_inner).take() {
        bar.finish_and_clear();
    }
    let found = found??;

    if let Some(law) = found.law_json() {
        folder.write("law.json", super::pretty(&law))?;
    }
    folder.write("scenario.json", super::pretty(&found.scenario_json(&problem)?))?;
    folder.write("law.csv", found.law_csv())?;
    folder.write("data.csv", found.data_csv())?;
    folder.write("posterior.csv", found.posterior_csv())?;
    let figures = plot::identification(&found);
    for (name, figure) in &figures {
        folder.draw(&format!("{name}.svg"), figure)?;
    }
    folder.write("report.html", plot::identification_report(&problem, &found, &figures))?;
    let folder = folder.finish("identification.json", &found.report(&problem), output.json)?;
    if !output.json && !quiet {
        print_estimates(&found)?;
        answer_line!("written to {}", folder.display());
    }
    Ok(())
}

/// Prints the answer in words, and a line for each parameter.
fn print_estimates(found: &Identification) -> Result<(), Failure> {
    for sentence in found.conclusions() {
        answer_line!("{sentence}");
    }
    let percent = 100.0 * found.level;
    for estimate in found.estimates() {
        let [low, high] = estimate.posterior_interval;
        let (name, value) = (estimate.name, estimate.value);
        answer_line!("{name:<36} {value:>12.5e}   {percent:.0} %: {low:.5e} to {high:.5e}");
    }
    Ok(())
}

impl From<IdentificationError> for Failure {
    fn from(error: IdentificationError) -> Self {
        match error {
            IdentificationError::Document(error) => Self::Document(error),
            IdentificationError::Study(error) => Self::Study(error),
            IdentificationError::Analysis(error) => Self::Analysis(error),
            error => Self::Problem(Box::new(error)),
        }
    }
}
