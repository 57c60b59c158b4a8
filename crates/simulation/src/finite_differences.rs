//! Responses by finite differences, with their errors estimated from a second grid.
//!
//! The scheme is of first order in its step (Eq. 4 has the damping one-sided), of second in its
//! cells. So the difference of two responses, whose steps have the ratio r, shows the error of the
//! finer one divided by r - 1, or that of the coarser one divided by 1 - 1/r. The second grid has
//! cells of twice the length, or four times, a quarter of the work or less. Where that lengthens no
//! step, because the shortest body has the fewest nodes already, it has cells and steps of half the
//! length. Cells are as long as the scenario says: the errors are stated, not controlled.

use asperity_dynamics::{FiniteDifference, Integrator, Transient};
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
/// time from which on it depends on rounding.
pub(crate) fn integrate(
    assembly: &Assembly,
    at_rest: &StaticSummary,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<(Transient, Observables), SimulationError> {
    let Assembly { structure, load, sampling, method, .. } = assembly;
    let ports = assembly.sensor_ports();
    let stage = info_span!("integrate").entered();
    let transient = method.integrate_with_progress(structure, load, &ports, sampling, progress)?;
    let mut diverged = None;
    if contact_is_lost(&transient.contacts) {
        let other = method.integrate(structure, &perturbed(load), &ports, sampling)?;
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
        let estimate = estimated(*method, assembly, at_rest, &transient, &found);
        found = found.with_estimate(estimate);
    }
    Ok((transient, found))
}

/// The errors of `found`, by a second grid.
fn estimated(
    method: FiniteDifference,
    assembly: &Assembly,
    at_rest: &StaticSummary,
    transient: &Transient,
    found: &Observables,
) -> ErrorEstimate {
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
    let Ok(other) = other.integrate(structure, load, &assembly.sensor_ports(), sampling) else {
        return ErrorEstimate::unknown(found.all(), DEFAULT_ACCURACY);
    };
    let Ok(observables) = Observables::of_transient(assembly, at_rest, &other) else {
        return ErrorEstimate::unknown(found.all(), DEFAULT_ACCURACY);
    };
    let divisor = (other.step / transient.step - 1.0).abs();
    ErrorEstimate::new(found.all(), observables.all(), divisor, DEFAULT_ACCURACY)
}
