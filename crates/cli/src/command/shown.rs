//! Progress and files of a run, of bars or of a structure given by matrices.

use std::sync::atomic::{AtomicU64, Ordering};

use asperity_experiment::AnalysisError;
use asperity_measure::{MeasureError, WriteOptions, write};
use asperity_plot as plot;
use asperity_simulation::assemble::Interfaces;
use asperity_simulation::error::OutputError;
use asperity_simulation::record::{frf_columns, frf_csv, history_csv, measurement_record};
use asperity_simulation::run::{Run, receptance};

use super::ResultFolder;
use crate::args::analyse::RecordFormat;
use crate::args::figures::MagnitudeAxis;
use crate::failure::Failure;

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
pub(super) fn write_run<S: Interfaces>(
    folder: &ResultFolder,
    run: &Run<S>,
    record: Option<RecordFormat>,
    magnitude: MagnitudeAxis,
) -> Result<(), Failure> {
    folder.write("history.csv", history_csv(run))?;
    folder.draw("history", &plot::history(run))?;
    if let Some(figure) = plot::pressure_closure(run) {
        folder.draw("pressure-closure", &figure)?;
    }
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
