//! `asperity simulate`.

use std::sync::atomic::{AtomicU64, Ordering};

use asperity_experiment::AnalysisError;
use asperity_measure::{MeasureError, WriteOptions, write};
use asperity_plot as plot;
use asperity_simulation::assemble::Assembly;
use asperity_simulation::error::OutputError;
use asperity_simulation::record::{frf_columns, frf_csv, history_csv, measurement_record};
use asperity_simulation::run::{Run, receptance, simulate_with_progress};
use serde_json::json;

use super::ResultFolder;
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

/// The result of `work`, whose progress is shown in per cent.
pub(super) fn with_percents<T>(quiet: bool, work: impl FnOnce(&(dyn Fn(f64) + Sync)) -> T) -> T {
    let bar = crate::progress::bar(100, "integrating", quiet);
    let shown = AtomicU64::new(0);
    let result = work(&|fraction| {
        let percent = (100.0 * fraction) as u64;
        if shown.swap(percent, Ordering::Relaxed) != percent {
            bar.set_position(percent);
        }
    });
    bar.finish_and_clear();
    result
}

/// Writes history, FRF and their figures, and the run as a measurement record.
pub(super) fn write_run<S>(
    folder: &ResultFolder,
    run: &Run<S>,
    record: Option<RecordFormat>,
    magnitude: MagnitudeAxis,
) -> Result<(), Failure> {
    folder.write("history.csv", history_csv(run))?;
    folder.draw("history", &plot::history(run))?;
    if let (Some(frf), Some(columns)) = (receptance(run, 0)?, frf_columns(run)?) {
        folder.write("frf.csv", frf_csv(&columns))?;
        folder.draw("frf", &plot::frf(&frf, &run.summary, magnitude.into()))?;
    }
    if let Some(format) = record {
        let record = measurement_record(run, run.summary.title.as_deref());
        let place = folder.unfinished(format.file_name())?;
        let path = folder.0.path().join(format.file_name());
        let written = write(&place, &[record], format.format(), &WriteOptions::default());
        written.map_err(|error| match error {
            MeasureError::Io { source, .. } => OutputError::Io { path, source }.into(),
            other => Failure::from(AnalysisError::from(other)),
        })?;
    }
    Ok(())
}
