//! The energy balance of one case.

use super::prepared_case::PreparedCase;
use super::simd::outcome::Outcome;
use crate::EnergyLedger;
use crate::contact_energy::excess;

/// The ledger of a finished case at the end of the steps that were integrated.
///
/// Velocities at the end come from the last five states to fourth order. What the start of the balance
/// stored counts as input.
pub(super) fn ledger(case: &PreparedCase, outcome: &Outcome) -> EnergyLedger {
    let model = &case.tabulated.step_model;
    let stored = case.start.as_ref().map_or(0.0, |start| start.stored);
    let mut ledger = EnergyLedger {
        input: outcome.work + stored,
        dissipated: outcome.loss,
        ..EnergyLedger::default()
    };
    let mut modes = Vec::with_capacity(model.modes.len());
    for (mode, &[q0, q1, q2, q3, q4]) in model.modes.iter().zip(&outcome.states) {
        let moved = 25.0 * q0 - 48.0 * q1 + 36.0 * q2 - 16.0 * q3 + 3.0 * q4;
        // Summing the loss by parts leaves this at the end.
        ledger.dissipated -= mode.dynamics.rate / (12.0 * model.step) * (q0 - q1).powi(2);
        modes.push([q0, moved / (12.0 * model.step)]);
    }
    for (contact, outcome) in case.model.contacts().iter().zip(&outcome.contacts) {
        ledger.contact_dissipated += contact.area() * outcome.loss;
    }
    let end = EnergyState {
        modes,
        tractions: outcome.row_tractions.clone(),
        closures: outcome.contacts.iter().map(|contact| contact.closure).collect(),
        load: case.amplitude * case.load.end.get(case.integrated() - 1).copied().unwrap_or(0.0),
    };
    [ledger.kinetic, ledger.elastic, ledger.contact] = end.stored(case);
    ledger.elastic += outcome.friction_stored;
    ledger.friction_dissipated = outcome.friction_loss;
    ledger.dissipated += ledger.contact_dissipated + ledger.friction_dissipated;
    ledger
}

/// A case at one time.
pub(super) struct EnergyState {
    /// Displacement and velocity of each mode that is stepped.
    pub(super) modes: Vec<[f64; 2]>,
    /// Traction increment of each row \[Pa\].
    pub(super) tractions: Vec<f64>,
    /// Closure increment of each contact \[m\].
    pub(super) closures: Vec<f64>,
    /// The load.
    pub(super) load: f64,
}

impl EnergyState {
    /// Kinetic energy, elastic energy of the modes and, half force times displacement, of the residual
    /// flexibility, and energy of the contacts \[J\].
    pub(super) fn stored(&self, case: &PreparedCase) -> [f64; 3] {
        let model = &case.tabulated.step_model;
        let (mut kinetic, mut elastic) = (0.0, 0.0);
        for (mode, &[displacement, velocity]) in model.modes.iter().zip(&self.modes) {
            if !mode.dynamics.massless {
                kinetic += 0.5 * velocity * velocity;
            }
            elastic += 0.5 * (mode.dynamics.angular_frequency * displacement).powi(2);
        }
        let (residual, load) = (&model.residual, self.load);
        let force = |i: usize| case.model.area(i) * self.tractions[i];
        elastic += 0.5 * residual.load_port * load * load;
        for i in 0..case.model.rows() {
            elastic -= residual.load[i] * load * force(i);
            for j in 0..case.model.rows() {
                elastic += 0.5 * force(i) * residual.closure[i][j] * force(j);
            }
        }
        let contacts = case.model.contacts().iter().zip(&self.closures);
        let contact = contacts.map(|(contact, &closure)| contact.area() * excess(contact, closure));
        [kinetic, elastic, contact.sum()]
    }
}
