//! The step from which a ring-down is linear.
//!
//! The step is predicted from the slowest ring-down, under mass-proportional damping alone. Each case is
//! checked there: if a law bends too much in the motion left, the case is integrated to its end.

use std::f64::consts::TAU;

use super::assembly::ModalModel;
use super::load_steps::LoadSteps;
use super::prepared_case::PreparedCase;
use super::simd::outcome::Outcome;
use crate::EnergyLedger;

/// Largest change of the displacement by the bend of the laws, over the peak displacement: below the
/// error of the laws' tables.
const DEPARTURE: f64 = 1e-6;

/// Factor on the amplitude at which that change is reached by a law whose stiffness changes by as large
/// a share as its pressure. It is below one because the check gives each contact all of the energy.
const AMPLITUDE: f64 = 0.5;

/// Share of its peak below which a force counts as passed when the ring-down is predicted.
const PASSED: f64 = 1e-3;

/// A response is integrated over a whole number of its sixteenths, so that cases with similar
/// ring-downs run side by side; over twelve at most, since a shorter rest is not worth its rows.
const PARTS: f64 = 16.0;
const MOST_PARTS: f64 = 12.0;

/// Step from which a response of `steps` steps of `step` \[s\] may be linear; none where too little of
/// the response would be left, or where it is not known to ring down.
pub(super) fn start(
    model: &ModalModel,
    load: &LoadSteps,
    step: f64,
    steps: usize,
) -> Option<usize> {
    let structure = model.preloaded();
    let (frequency, rate) = (TAU * structure.natural_frequency()?, structure.damping_rate());
    // Written so that a rate that is not a number has no rest.
    let rings_down = rate > 0.0 && rate < frequency && !model.is_dissipative();
    if !rings_down {
        return None;
    }
    let amplitude = AMPLITUDE * (DEPARTURE * rate / frequency).sqrt();
    let peak = load.mean.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let acting = load.mean.iter().rposition(|force| force.abs() > PASSED * peak)? + 1;
    let decay = -2.0 * amplitude.ln() / (rate * step);
    // The recurrence sees the load of the step before.
    let from = (acting as f64 + decay).max((load.steps() + 2) as f64);
    let parts = (PARTS * from / steps as f64).ceil();
    (parts <= MOST_PARTS).then(|| (parts / PARTS * steps as f64).ceil() as usize)
}

/// True if the rest of the motion of `case` is linear.
///
/// The energy left bounds each closure, `Y = sqrt(2 E / (S K))`. Up to Y the law departs from its tangent
/// by a share b. This changes a frequency by the share b/2, and the phase over the ring-down by `b w / c`,
/// with the damping rate c.
pub(super) fn is_straight(case: &PreparedCase, outcome: &Outcome, energy: &EnergyLedger) -> bool {
    let structure = case.model.preloaded();
    let turns = TAU * structure.natural_frequency().unwrap_or(0.0) / structure.damping_rate();
    let left = energy.kinetic + energy.elastic + energy.contact;
    let pairs = case.model.contacts().iter().zip(&case.tabulated.tables);
    // A number that is not one is not straight.
    pairs.zip(&outcome.contacts).all(|((contact, table), seen)| {
        let stiffness = table.tangent(0.0);
        let bound = (2.0 * left / (contact.area() * stiffness)).sqrt();
        let bend = |closure: f64| (table.get(closure) / (stiffness * closure) - 1.0).abs();
        let largest = seen.extremes.highest.max(-seen.extremes.lowest);
        let change = |closure: f64| bound / largest * bend(closure) * turns;
        change(bound) <= DEPARTURE && change(-bound) <= DEPARTURE
    })
}

/// The energy balance at the end of a response, from the balance `energy` where its linear rest begins:
/// the energy left decays at the rate of the mass-proportional damping.
pub(super) fn at_end(case: &PreparedCase, energy: EnergyLedger) -> EnergyLedger {
    let model = &case.tabulated.step_model;
    let time = (case.steps - case.integrated()) as f64 * model.step;
    let share = (-case.model.preloaded().damping_rate() * time).exp();
    let left = energy.kinetic + energy.elastic + energy.contact;
    EnergyLedger {
        kinetic: share * energy.kinetic,
        elastic: share * energy.elastic,
        contact: share * energy.contact,
        dissipated: energy.dissipated + (1.0 - share) * left,
        ..energy
    }
}
