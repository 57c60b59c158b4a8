//! Responses by finite differences, with their errors estimated from a second grid.
//!
//! The scheme is of first order in its step (Eq. 4 has the damping one-sided), of second in its
//! cells. So the difference of two responses, whose steps have the ratio r, shows the error of the
//! finer one divided by r - 1, or that of the coarser one divided by 1 - 1/r. The second grid has
//! cells of twice the length, or four times, a quarter of the work or less. Where that lengthens no
//! step, because the shortest body has the fewest nodes already, it has cells and steps of half the
//! length. Cells are as long as the scenario says: the errors are stated, not controlled.
//! Observables are read from [readings] between the output samples.

use std::sync::atomic::AtomicBool;

use asperity_dynamics::{DynamicsError, FiniteDifference, Integrator, Transient};
use asperity_structure::LoadCase;
use tracing::info_span;

use crate::accuracy::ErrorEstimate;
use crate::assemble::{Assembly, DEFAULT_ACCURACY};
use crate::error::SimulationError;
use crate::error_control::{contact_is_lost, divergence_sample, perturbed};
use crate::observables::Observables;
use crate::response_parts::readings;
use crate::static_state::StaticSummary;

/// Ratio of the steps of two grids from which on their responses tell the error.
const OTHER_STEP: f64 = 1.5;

/// Readings in a period of the static frequency, and in the time in which the load changes, if the steps are as short.
const READINGS_IN_PERIOD: f64 = 512.0;
const READINGS_IN_LOAD: f64 = 64.0;

/// Most readings of a response beyond its output samples.
const MOST_READINGS: usize = 4_000_000;

/// A response by finite differences.
pub(crate) struct FineResponse {
    /// The response, its history read several times for each output sample.
    pub(crate) transient: Transient,
    /// Readings for each output sample.
    pub(crate) readings: usize,
    /// Its observables, with their estimated errors.
    pub(crate) observables: Observables,
}

/// The response by finite differences with its estimated errors; where contact is lost, with the
/// time from which on it depends on rounding. Once `stop` is set, the run ends within 64 samples.
pub(crate) fn integrate(
    assembly: &Assembly,
    at_rest: &StaticSummary,
    stop: &AtomicBool,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<FineResponse, SimulationError> {
    let Assembly { structure, load, sampling, method, .. } = assembly;
    let ports = assembly.sensor_ports();
    let stage = info_span!("integrate").entered();
    let period = at_rest.natural_frequency_hz.map(|natural| 1.0 / natural);
    let interval = period.map_or(f64::INFINITY, |period| {
        (period / READINGS_IN_PERIOD).min(load.time_scale() / READINGS_IN_LOAD)
    });
    let readings = readings_of(method, assembly, interval);
    let read = sampling.divided(readings);
    let run = |load: &LoadCase, progress: &(dyn Fn(f64) + Sync)| {
        method.integrate_unless(structure, load, &ports, &read, stop, progress)
    };
    let transient = run(load, progress)?;
    let mut diverged = None;
    if contact_is_lost(&transient.contacts) {
        let other = run(&perturbed(load), &|_| ())?;
        let pairs = transient.history.sensors.iter().zip(&other.history.sensors);
        let found = pairs.filter_map(|(a, b)| divergence_sample(&a.displacement, &b.displacement));
        diverged = found.min();
    }
    drop(stage);
    let mut found = info_span!("analyse")
        .in_scope(|| Observables::of_transient(assembly, at_rest, (&transient, read.rate())))?;
    if let Some(sample) = diverged {
        found.mark_sensitive(transient.history.time[sample]);
    }
    if let Integrator::FiniteDifference(method) = method {
        let _stage = info_span!("estimate the error").entered();
        let first = (&transient, &found, read.interval());
        let estimate = estimated(*method, assembly, at_rest, first, stop)?;
        found = found.with_estimate(estimate);
    }
    Ok(FineResponse { transient, readings, observables: found })
}

/// Readings for each output sample, of the whole steps between them, that are at most `interval` \[s\] apart.
fn readings_of(method: &Integrator, assembly: &Assembly, interval: f64) -> usize {
    let Assembly { structure, load, sampling, .. } = assembly;
    let samples = sampling.samples();
    let outline = method.outline(structure, load, sampling);
    let steps = outline.map_or(1, |outline| outline.steps / samples);
    readings(steps, sampling.interval() / interval, MOST_READINGS / samples)
}

/// The errors of `found`, read at an interval \[s\], by a second grid. It is read twice as often, or at every step, so
/// that the difference has the error of reading, too.
fn estimated(
    method: FiniteDifference,
    assembly: &Assembly,
    at_rest: &StaticSummary,
    (transient, found, interval): (&Transient, &Observables, f64),
    stop: &AtomicBool,
) -> Result<ErrorEstimate, SimulationError> {
    let Assembly { structure, load, sampling, .. } = assembly;
    let with_cell = |factor: f64| FiniteDifference { cell: factor * method.cell, ..method };
    let step = |method: FiniteDifference| {
        method.outline(structure, sampling).map_or(transient.step, |outline| outline.step)
    };
    let longer = |factor: &f64| step(with_cell(*factor)) >= OTHER_STEP * transient.step;
    let other = match [2.0, 4.0].into_iter().find(longer) {
        Some(factor) => with_cell(factor),
        None => FiniteDifference { courant: 0.5 * method.courant, ..with_cell(0.5) },
    };
    let unknown = || Ok(ErrorEstimate::unknown(found.all(), DEFAULT_ACCURACY));
    let ports = assembly.sensor_ports();
    let read = sampling.divided(readings_of(&other.into(), assembly, 0.5 * interval));
    let other = match other.integrate_unless(structure, load, &ports, &read, stop, &|_| ()) {
        Ok(other) => other,
        Err(stopped @ DynamicsError::Stopped { .. }) => return Err(stopped.into()),
        Err(_) => return unknown(),
    };
    let Ok(observables) = Observables::of_transient(assembly, at_rest, (&other, read.rate()))
    else {
        return unknown();
    };
    let divisor = (other.step / transient.step - 1.0).abs();
    Ok(ErrorEstimate::new(found.all(), observables.all(), divisor, DEFAULT_ACCURACY))
}
