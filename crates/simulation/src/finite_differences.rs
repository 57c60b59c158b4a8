//! Responses by finite differences, with their errors estimated from a second grid.
//!
//! The scheme is of first order in its step (Eq. 4 has the damping one-sided), of second in its
//! cells. So the difference of two responses, whose steps have the ratio r, shows the error of the
//! finer one divided by r - 1, or that of the coarser one divided by 1 - 1/r. The second grid has
//! cells of twice the length, or four times, a quarter of the work or less. Where that lengthens no
//! step, because the shortest body has the fewest nodes already, it has cells and steps of half the
//! length. Cells are as long as the scenario says: the errors are stated, not controlled.

use std::sync::atomic::AtomicBool;

use asperity_dynamics::{DynamicsError, FiniteDifference, Integrator, Transient};
use asperity_structure::LoadCase;
use tracing::info_span;

use crate::accuracy::ErrorEstimate;
use crate::assemble::{Assembly, DEFAULT_ACCURACY};
use crate::error::SimulationError;
use crate::error_control::{contact_is_lost, divergence_sample, perturbed};
use crate::observables::Observables;
use crate::static_state::StaticSummary;

/// Ratio of the steps of two grids from which on their responses tell the error.
const OTHER_STEP: f64 = 1.5;

/// The response by finite differences with its estimated errors; where contact is lost, with the
/// time from which on it depends on rounding. Once `stop` is set, the run ends within 64 samples.
pub(crate) fn integrate(
    assembly: &Assembly,
    at_rest: &StaticSummary,
    stop: &AtomicBool,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<(Transient, Observables), SimulationError> {
    let Assembly { structure, load, sampling, method, .. } = assembly;
    let ports = assembly.sensor_ports();
    let stage = info_span!("integrate").entered();
    let run = |load: &LoadCase, progress: &(dyn Fn(f64) + Sync)| {
        method.integrate_unless(structure, load, &ports, sampling, stop, progress)
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
        .in_scope(|| Observables::of_transient(assembly, at_rest, &transient))?;
    if let Some(sample) = diverged {
        found.mark_sensitive(transient.history.time[sample]);
    }
    if let Integrator::FiniteDifference(method) = method {
        let _stage = info_span!("estimate the error").entered();
        let estimate = estimated(*method, assembly, at_rest, (&transient, &found), stop)?;
        found = found.with_estimate(estimate);
    }
    Ok((transient, found))
}

/// The errors of `found`, by a second grid.
fn estimated(
    method: FiniteDifference,
    assembly: &Assembly,
    at_rest: &StaticSummary,
    (transient, found): (&Transient, &Observables),
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
    let other = match other.integrate_unless(structure, load, &ports, sampling, stop, &|_| ()) {
        Ok(other) => other,
        Err(stopped @ DynamicsError::Stopped { .. }) => return Err(stopped.into()),
        Err(_) => return unknown(),
    };
    let Ok(observables) = Observables::of_transient(assembly, at_rest, &other) else {
        return unknown();
    };
    let divisor = (other.step / transient.step - 1.0).abs();
    Ok(ErrorEstimate::new(found.all(), observables.all(), divisor, DEFAULT_ACCURACY))
}
