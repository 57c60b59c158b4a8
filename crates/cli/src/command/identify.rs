//! `asperity identify`.

use std::io::{IsTerminal, stderr};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use asperity_identify::{
    Identification, IdentificationError, IdentificationProblem, IncompleteIdentification,
    StiffnessOrigin, Work, WorkProgress, identify,
};
use asperity_plot as plot;
use asperity_scenario::{digits_apart, four_digits};
use serde_json::Value;
use tracing::info_span;

use super::ResultFolder;
use crate::args::Output;
use crate::failure::Failure;
use crate::file_kind::FileKind;

/// Identifies the parameters of a problem; writes laws, tables, figures and the report.
pub(crate) fn run(
    path: &Path,
    is_fast: bool,
    output: &Output,
    threads: Option<usize>,
    quiet: bool,
) -> Result<(), Failure> {
    let problem = info_span!("read").in_scope(|| {
        let document = super::read_document(path, FileKind::Problem)?;
        Ok::<_, Failure>(IdentificationProblem::of(document)?)
    })?;
    let problem = if is_fast { problem.fast() } else { problem };
    let folder = ResultFolder::claim("identify", path, output)?;
    // The first ends the identification with what is finished.
    super::stop_on_signals(&problem.work().stop_flag());
    let found =
        while_watched(problem.work(), quiet, || super::on_threads(threads, || identify(&problem)))?;
    let found = match found {
        Err(IdentificationError::Stopped(found)) => {
            let folder = beside_finished(folder, path, output)?;
            return write_incomplete(&problem, &found, folder, output, quiet);
        }
        found => found?,
    };
    let folder = if found.stopped { beside_finished(folder, path, output)? } else { folder };

    if let Some(law) = found.law_json() {
        folder.write("law.json", super::pretty(&law))?;
    }
    folder.write("scenario.json", super::pretty(&found.scenario_json(&problem)?))?;
    folder.write("law.csv", found.law_table().to_csv())?;
    folder.write("data.csv", found.data_table().to_csv())?;
    folder.write("posterior.csv", found.posterior_table().to_csv())?;
    folder.write("draws.json", found.draws_json(&problem)?.to_string())?;
    let figures = plot::identification(&found);
    for (name, figure) in &figures {
        folder.draw(name, figure)?;
    }
    folder.write("report.html", plot::identification_report(&problem, &found, &figures))?;
    let folder = folder.finish("identification.json", &found.report(&problem), output.json)?;
    if !output.json && !quiet {
        print_estimates(&found)?;
        answer_line!("written to {}", folder.display());
    }
    if found.stopped { Err(Failure::Stopped(folder)) } else { Ok(()) }
}

/// Carries out `task` while its progress is shown: on a terminal in a bar, else in a line a minute.
fn while_watched<T>(work: &Arc<Work>, quiet: bool, task: impl FnOnce() -> T) -> T {
    let (done, ended) = channel::<()>();
    let watched = Arc::clone(work);
    let watcher = std::thread::spawn(move || {
        let bar = crate::progress::whole_bar(PARTS, quiet);
        let lines = !quiet && !stderr().is_terminal();
        let mut shown = Instant::now();
        let mut stopping = false;
        while ended.recv_timeout(LOOK) == Err(RecvTimeoutError::Timeout) {
            if watched.is_stopped() && !stopping {
                stopping = true;
                crate::progress::show_line(
                    "stopping; what is finished is written (Ctrl-C again ends at once)",
                );
            }
            let Some(progress) = watched.progress() else { continue };
            bar.set_position((progress.share * PARTS as f64) as u64);
            bar.set_message(words(&progress));
            if lines && shown.elapsed() >= MINUTE {
                shown = Instant::now();
                let percent = 100.0 * progress.share;
                crate::progress::show_line(&format!("{percent:.0} %, {}", words(&progress)));
            }
        }
        bar.finish_and_clear();
    });
    let result = task();
    drop(done);
    // A watcher that failed shows nothing more.
    let _ = watcher.join();
    result
}

/// Parts of the bar, the time between two looks at the progress, and that between two lines.
const PARTS: u64 = 1000;
const LOOK: Duration = Duration::from_millis(200);
const MINUTE: Duration = Duration::from_secs(60);

fn words(progress: &WorkProgress) -> String {
    let stage = progress.stage.name();
    let (Some(left), Some(most)) = (progress.left, progress.most) else {
        return format!("{stage}, time left unknown");
    };
    let [left, most] = [left, most].map(rounded);
    if left == most {
        format!("{stage}, about {left} left of the whole")
    } else {
        format!("{stage}, about {left} left of the whole, or up to {most}")
    }
}

/// A length of time in seconds, from a minute and a half on in minutes.
fn rounded(time: Duration) -> String {
    match time.as_secs() {
        seconds if seconds < 90 => format!("{seconds} s"),
        seconds => format!("{} min", (seconds + 30) / 60),
    }
}

/// The folder for the result of a run that was stopped.
fn beside_finished(
    folder: ResultFolder,
    path: &Path,
    output: &Output,
) -> Result<ResultFolder, Failure> {
    let is_finished = |earlier: &Value| earlier["complete"] == Value::Bool(true);
    folder.beside_finished(
        "stopped",
        is_finished,
        ("identify", "identification.json"),
        path,
        output,
    )
}

/// Writes the document, the law and the scenario of an identification that was stopped.
fn write_incomplete(
    problem: &IdentificationProblem,
    found: &IncompleteIdentification,
    folder: ResultFolder,
    output: &Output,
    quiet: bool,
) -> Result<(), Failure> {
    if let Some(law) = found.law_json() {
        folder.write("law.json", super::pretty(&law))?;
    }
    folder.write("scenario.json", super::pretty(&found.scenario_json(problem)?))?;
    let folder = folder.finish("identification.json", &found.report(problem), output.json)?;
    if !output.json && !quiet {
        for sentence in found.conclusions() {
            answer_line!("{sentence}");
        }
        for (label, value) in found.labels.iter().zip(&found.fit.point) {
            answer_line!("{label:<36} {value:>12.5e}");
        }
        answer_line!("written to {}", folder.display());
    }
    Err(Failure::Stopped(folder))
}

/// Prints the answer in words, and a line for each parameter.
fn print_estimates(found: &Identification) -> Result<(), Failure> {
    for sentence in found.conclusions() {
        answer_line!("{sentence}");
    }
    let percent = 100.0 * found.level;
    for one in &found.stiffnesses {
        let name = format!("K({} MPa) of {}", four_digits(1e-6 * one.pressure_pa), one.law);
        let [low, high] = one.interval_pa_per_m;
        let origin = match one.origin {
            StiffnessOrigin::Data => "",
            StiffnessOrigin::Smoothness => ", by smoothness",
            StiffnessOrigin::Given => ", given",
            StiffnessOrigin::Open => ", left open by the data",
        };
        let value = one.stiffness_pa_per_m;
        let places = digits_apart(&[low, value, high], 4) - 1;
        answer_line!(
            "{name:<36} {value:>12.places$e}   {percent:.0} %: {low:.places$e} to {high:.places$e} Pa/m{origin}"
        );
    }
    for estimate in found.estimates().into_iter().filter(|estimate| !estimate.in_steps) {
        let [low, high] = estimate.posterior_interval;
        let (name, value) = (estimate.name, estimate.value);
        let places = digits_apart(&[low, value, high], 6) - 1;
        answer_line!(
            "{name:<36} {value:>12.places$e}   {percent:.0} %: {low:.places$e} to {high:.places$e}"
        );
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

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_identify::WorkStage;

    #[test]
    fn the_time_left_and_the_most_are_told() {
        let words_of = |times: Option<[u64; 2]>| {
            let [left, most] = [0, 1].map(|n| times.map(|times| Duration::from_secs(times[n])));
            words(&WorkProgress { stage: WorkStage::Fit, share: 0.1, left, most })
        };
        assert_eq!(words_of(None), "fit, time left unknown");
        assert_eq!(words_of(Some([3, 3])), "fit, about 3 s left of the whole");
        assert_eq!(words_of(Some([40, 95])), "fit, about 40 s left of the whole, or up to 2 min");
    }
}
