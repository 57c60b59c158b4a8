//! Responses of a run while it is refined.

use asperity_dynamics::{CaseResponse, ContactExtremes, TransientCase};
use asperity_structure::LoadCase;

use crate::observables::Observables;

/// Relative change of the force of a perturbed run.
const PERTURBATION: f64 = 1e-12;

/// Difference of two displacements, over the largest, from which on they count as diverged.
const DIVERGED: f64 = 1e-3;

/// Use of a response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ResponseKind {
    /// The response of the level.
    Fine,
    /// Of another step.
    Other,
    /// Of fewer modes; of more where a scenario gives rigid ones alone.
    Fewer,
    /// Of the level, to a slightly larger force.
    Perturbed,
}

/// A response and its observables.
#[derive(Debug)]
pub(super) struct Response {
    pub(super) case: TransientCase,
    pub(super) record: CaseResponse,
    pub(super) observables: Observables,
}

impl Response {
    pub(super) fn loses_contact(&self) -> bool {
        contact_is_lost(&self.record.contacts)
    }

    /// True if a contact is lost, or near opening under a law that never separates: such faces fly apart as well.
    /// Errors of these responses are not those of responses to other forces.
    pub(super) fn opens(&self) -> bool {
        let mut contacts = self.case.model.contacts().iter().zip(&self.record.contacts);
        contacts.any(|(contact, seen)| {
            let separates = contact.law().domain().separates();
            seen.lost > 0.0 || (!separates && contact.is_near_opening(seen.pressure_min))
        })
    }

    pub(super) fn has_friction(&self) -> bool {
        self.case.model.preloaded().friction().is_some()
    }
}

/// True if any of some contacts is lost for a time.
pub(crate) fn contact_is_lost(contacts: &[ContactExtremes]) -> bool {
    contacts.iter().any(|contact| contact.lost > 0.0)
}

/// The force of a perturbed run.
pub(crate) fn perturbed(load: &LoadCase) -> LoadCase {
    load.with_amplitude((1.0 + PERTURBATION) * load.amplitude())
}

/// Sample from which on two displacements differ.
pub(crate) fn divergence_sample(a: &[f64], b: &[f64]) -> Option<usize> {
    let largest = a.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    a.iter().zip(b).position(|(a, b)| (a - b).abs() > DIVERGED * largest)
}

/// Time \[s\] from which on the displacements of two responses differ.
pub(super) fn divergence(a: &CaseResponse, b: &CaseResponse) -> Option<f64> {
    let sample = divergence_sample(&a.displacement, &b.displacement)?;
    // The filter delays by half its length.
    let steps = (sample * a.decimation.factor).saturating_sub(a.decimation.taps.len() / 2);
    Some(steps as f64 * a.step)
}
