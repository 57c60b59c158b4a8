//! Requests to the error control, and the runs that reach their accuracy.

use std::sync::Arc;

use asperity_dynamics::{Excitation, HitResponse, HitSimulation};

use crate::accuracy::ErrorEstimate;
use crate::observables::Observables;
use crate::prepared_scenario::PreparedScenario;

/// A modal run that is to reach the accuracy of its scenario.
#[derive(Debug, Clone)]
pub struct RunRequest {
    /// The structure at rest, and the accuracy.
    pub prepared: Arc<PreparedScenario>,
    /// The force.
    pub excitation: Excitation,
    /// Duration \[s\]; that of the scenario if not given.
    pub duration: Option<f64>,
}

/// A transient case with the step and the modes that were chosen, and its observables with their
/// errors.
#[derive(Debug)]
pub struct ConvergedRun {
    /// The transient case.
    pub case: HitSimulation,
    /// Its observables, with [estimated errors](Observables::estimate).
    pub observables: Observables,
    /// Modes of each body, the rigid one included.
    pub counts: Vec<usize>,
    pub(super) record: HitResponse,
}

impl ConvergedRun {
    pub(super) fn is_reached(&self) -> bool {
        self.observables.estimate().is_some_and(ErrorEstimate::is_reached)
    }
}

impl RunRequest {
    /// The request of the reference run: the peak of the force is the next power of two above the peak
    /// of this request. None where forces of one shape are not told from others.
    pub(super) fn reference(&self) -> Option<Self> {
        let (unit, factor) = self.excitation.unit();
        if unit.peak() != 1.0 || factor == 0.0 {
            return None;
        }
        let octave = factor.abs().log2().ceil().exp2().copysign(factor);
        let excitation = unit.scaled(octave);
        Some(Self { prepared: Arc::clone(&self.prepared), excitation, duration: self.duration })
    }

    pub(super) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.prepared, &other.prepared)
            && (&self.excitation, self.duration) == (&other.excitation, other.duration)
    }
}
