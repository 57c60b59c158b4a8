//! `asperity identify`.

use std::path::Path;
use std::sync::Mutex;

use asperity_identify::{Identification, Problem, ProblemError, Step, identify};
use indicatif::ProgressBar;

use crate::args::Output;
use crate::failure::Failure;
use crate::plot;

/// The law and all else that is unknown, from measured responses.
pub(crate) fn run(
    path: &Path,
    output: &Output,
    threads: Option<usize>,
    quiet: bool,
) -> Result<(), Failure> {
    let problem = Problem::read(path)?;
    let folder = super::claim(path, output)?;
    let bar: Mutex<Option<(&str, ProgressBar)>> = Mutex::new(None);
    let hear = |step: Step| {
        let mut bar = bar.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if bar.as_ref().is_none_or(|(name, _)| *name != step.name) {
            if let Some((_, old)) = bar.take() {
                old.finish_and_clear();
            }
            let new = crate::progress::bar(step.of as u64, step.name, quiet);
            *bar = Some((step.name, new));
        }
        if let Some((_, bar)) = bar.as_ref() {
            bar.set_length(step.of as u64);
            bar.set_position(step.done as u64);
        }
    };
    let outcome = asperity_study::sweep::on_threads(threads, || identify(&problem, &hear));
    if let Some((_, bar)) = bar.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take() {
        bar.finish_and_clear();
    }
    let found = match outcome {
        Some(found) => found?,
        None => return Err(Failure::Threads { threads: threads.unwrap_or_default() }),
    };

    let report = found.report(&problem);
    folder.write("identification.json", super::pretty(&report))?;
    if let Some(law) = found.law_json() {
        folder.write("law.json", super::pretty(&law))?;
    }
    folder.write("scenario.json", super::pretty(&found.scenario_json(&problem)?))?;
    folder.write("law.csv", found.law_csv())?;
    folder.write("data.csv", found.data_csv())?;
    folder.write("posterior.csv", found.posterior_csv())?;
    let figures = plot::identification(&found);
    for (name, figure) in &figures {
        super::draw(&folder, &format!("{name}.svg"), figure)?;
    }
    folder.write("report.html", plot::identification_report(&problem, &found, &figures))?;
    if output.json {
        answer!("{}", super::pretty(&report));
    } else if !quiet {
        say(&found);
        answer_line!("written to {}", folder.path().display());
    }
    Ok(())
}

/// The answer in words, and a line for each unknown.
fn say(found: &Identification) {
    for sentence in found.words() {
        answer_line!("{sentence}");
    }
    let percent = 100.0 * found.level;
    for estimate in found.estimates() {
        let [low, high] = estimate.posterior_interval;
        answer_line!(
            "{:<36} {:>12.5e}   {percent:.0} %: {low:.5e} to {high:.5e}",
            estimate.name,
            estimate.value
        );
    }
}

impl From<ProblemError> for Failure {
    fn from(error: ProblemError) -> Self {
        match error {
            ProblemError::Document(error) => Self::Document(error),
            ProblemError::Study(error) => Self::Study(error),
            ProblemError::Analysis(error) => Self::Analysis(error),
            error => Self::Problem(Box::new(error)),
        }
    }
}
