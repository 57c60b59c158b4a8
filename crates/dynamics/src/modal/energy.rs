//! The energy balance of one case.

use super::prepared_case::PreparedCase;
use super::simd::outcome::Outcome;
use crate::EnergyLedger;
use crate::contact_energy::excess;

/// The ledger of a finished case at the end of the steps that were integrated.
///
/// Velocities at the end come from the last five states to fourth order. The elastic energy is
/// the energy of the modes and, half force times displacement, of the residual flexibility.
pub(super) fn ledger(case: &PreparedCase, outcome: &Outcome) -> EnergyLedger {
    let model = &case.tabulated.step_model;
    let mut ledger =
        EnergyLedger { input: outcome.work, dissipated: outcome.loss, ..EnergyLedger::default() };
    for (mode, &[q0, q1, q2, q3, q4]) in model.modes.iter().zip(&outcome.states) {
        let moved = 25.0 * q0 - 48.0 * q1 + 36.0 * q2 - 16.0 * q3 + 3.0 * q4;
        let velocity = moved / (12.0 * model.step);
        // Summing the loss by parts leaves this at the end.
        ledger.dissipated -= mode.dynamics.rate / (12.0 * model.step) * (q0 - q1).powi(2);
        if !mode.dynamics.massless {
            ledger.kinetic += 0.5 * velocity * velocity;
        }
        ledger.elastic += 0.5 * (mode.dynamics.angular_frequency * q0).powi(2);
    }
    let contacts = case.model.contacts();
    let residual = &model.residual;
    let load = case.amplitude * case.load.end.get(case.integrated() - 1).copied().unwrap_or(0.0);
    let force = |i: usize| case.model.area(i) * outcome.row_tractions[i];
    ledger.elastic += 0.5 * residual.load_port * load * load;
    for (i, contact) in contacts.iter().enumerate() {
        let increment = outcome.contacts[i].closure;
        ledger.contact_dissipated += contact.area() * outcome.contacts[i].loss;
        ledger.contact += contact.area() * excess(contact, increment);
    }
    for i in 0..case.model.rows() {
        ledger.elastic -= residual.load[i] * load * force(i);
        for j in 0..case.model.rows() {
            ledger.elastic += 0.5 * force(i) * residual.closure[i][j] * force(j);
        }
    }
    ledger.elastic += outcome.friction_stored;
    ledger.friction_dissipated = outcome.friction_loss;
    ledger.dissipated += ledger.contact_dissipated + ledger.friction_dissipated;
    ledger
}
