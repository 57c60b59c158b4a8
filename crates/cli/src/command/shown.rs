//! What the commands for bars and for structures given by matrices write and print.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicU64, Ordering};

use asperity_experiment::AnalysisError;
use asperity_measure::{MeasureError, WriteOptions, write};
use asperity_plot as plot;
use asperity_simulation::assemble::Interfaces;
use asperity_simulation::error::OutputError;
use asperity_simulation::modes::ModesSummary;
use asperity_simulation::record::{frf_columns, frf_csv, history_csv, measurement_record};
use asperity_simulation::run::{Run, receptance};
use asperity_simulation::summary::{Amplitude, Summary};

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

/// Error over value up to which a number of a response that depends on rounding is stated.
const STATED: f64 = 0.05;

/// The summary as text.
pub(super) fn in_words(summary: &Summary) -> String {
    let mut lines = Vec::new();
    let mut line = |name: &str, value: String| lines.push(format!("{name:<26}{value}\n"));
    if let Some(natural) = summary.at_rest.natural_frequency_hz {
        line("natural frequency at rest", format!("{natural:.2} Hz"));
    }
    // Numbers that depend on rounding are not stated.
    let stated = |name: &str, value: f64| {
        let error =
            summary.accuracy.as_ref().and_then(|accuracy| accuracy.errors.get(name)?.as_f64());
        !summary.sensitive || error.is_some_and(|error| error <= STATED * value.abs())
    };
    let undetermined = || "not determined, depends on rounding".to_owned();
    match &summary.fundamental {
        Some(f) if !stated("fundamental.frequency_hz", f.frequency_hz) => {
            line("fundamental", undetermined());
        }
        Some(f) => {
            let unit = match f.amplitude {
                Amplitude::PerForce { .. } => "m/N",
                Amplitude::PerBase { .. } => "s^2 (relative displacement per base acceleration)",
            };
            let (hz, receptance) = (f.frequency_hz, f.amplitude.value());
            line("fundamental", format!("{hz:.2} Hz, {receptance:.4e} {unit}"));
            if let Some(ratio) = f.damping_ratio
                && stated("fundamental.damping_ratio", ratio)
            {
                line("damping (half power)", format!("{:.2} %", 100.0 * ratio));
            }
        }
        None => line("fundamental", "no peak".to_owned()),
    }
    match &summary.second_harmonic {
        Some(_) if !stated("harmonic_ratio", summary.harmonic_ratio.unwrap_or(f64::NAN)) => {
            line("second harmonic", undetermined());
        }
        Some(s) => {
            let ratio = summary.harmonic_ratio.unwrap_or(f64::NAN);
            line("second harmonic", format!("{:.2} Hz, A2/A1 = {ratio:.4}", s.frequency_hz));
        }
        None => line("second harmonic", "no peak".to_owned()),
    }
    for contact in &summary.interfaces {
        let (low, high) = (contact.pressure_min_pa / 1e6, contact.pressure_max_pa / 1e6);
        let named = |what: &str| format!("interfaces.{}.{what}", contact.name);
        let mut text = if stated(&named("pressure_max_pa"), contact.pressure_max_pa) {
            format!("{low:.4} to {high:.4} MPa")
        } else {
            undetermined()
        };
        if contact.contact_lost_s > 0.0 && stated(&named("contact_lost_s"), contact.contact_lost_s)
        {
            let _ = write!(text, ", contact lost for {:.3} ms", 1e3 * contact.contact_lost_s);
        }
        line(&contact.name, text);
    }
    let residual = summary.energy.residual_relative;
    line("energy balance", format!("closes to {residual:.1e} of the input"));
    if let Some(accuracy) = &summary.accuracy {
        let (error, asked) = (accuracy.estimated_error, accuracy.asked);
        let reached = if accuracy.reached { "" } else { ", not reached" };
        line("estimated error", format!("{error:.1e} ({asked:.0e} asked for{reached})"));
    }
    if let Some(from) = summary.sensitive_from_s {
        line("depends on rounding", format!("from {:.3} ms on", 1e3 * from));
    }
    let numerics = &summary.numerics;
    line("run", format!("{} steps in {:.3} s", numerics.steps, numerics.wall_s));
    lines.concat()
}

/// Prints frequencies and damping.
pub(super) fn show_modes(answer: &ModesSummary) -> Result<(), Failure> {
    for (number, mode) in answer.modes.iter().enumerate() {
        let (hz, percent) = (mode.frequency_hz, 100.0 * mode.damping_ratio);
        answer_line!("mode {:<3} {hz:>12.3} Hz   damping {percent:.3} %", number + 1);
    }
    Ok(())
}
