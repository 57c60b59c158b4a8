//! What runs of a sweep share that differ in their drive alone.

use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use asperity_dynamics::{DynamicsError, Excitation, Hit, Integrator, Modal, ModalRig};

use crate::assemble::{Assembly, excitation};
use crate::error::StudyError;
use crate::run::rest_state;
use crate::summary::{StaticSummary, Summary};
use asperity_scenario::{ExcitationSpec, Scenario};

/// An assembled scenario, with the modal rigs made of it so far.
#[derive(Debug)]
pub struct Case {
    /// The assembled scenario.
    pub assembly: Assembly,
    /// Its state at rest.
    pub at_rest: StaticSummary,
    /// By the number of modes of each body, which may depend on the drive.
    rigs: Mutex<Vec<(Vec<usize>, Arc<ModalRig>)>>,
    names: OnceLock<Arc<[String]>>,
}

impl Case {
    /// Prepares a scenario.
    ///
    /// # Errors
    /// [`StudyError`] when a part cannot be built.
    pub fn new(scenario: &Scenario, folder: &Path) -> Result<Self, StudyError> {
        let assembly = Assembly::new(scenario, folder)?;
        let at_rest = rest_state(&assembly);
        Ok(Self { assembly, at_rest, rigs: Mutex::default(), names: OnceLock::new() })
    }

    /// The names of the numbers of this case's runs, one of which has this summary.
    pub fn names(&self, summary: &Summary) -> Arc<[String]> {
        Arc::clone(self.names.get_or_init(|| summary.names().into()))
    }

    /// The modal integrator, if the scenario asks for it.
    pub fn modal(&self) -> Option<Modal> {
        match self.assembly.method {
            Integrator::Modal(modal) => Some(modal),
            Integrator::FiniteDifference(_) => None,
        }
    }

    /// The hit of `drive` on this case.
    pub fn hit(
        &self,
        modal: &Modal,
        drive: &ExcitationSpec,
        folder: &Path,
    ) -> Result<Hit, StudyError> {
        let excitation = excitation(drive, folder)?;
        excitation.check()?;
        self.strike(modal, excitation)
    }

    /// The hit of a checked `excitation` on this case.
    pub fn strike(&self, modal: &Modal, excitation: Excitation) -> Result<Hit, StudyError> {
        let rig = self.rig(modal, &excitation)?;
        let sampling = &self.assembly.sampling;
        let duration = sampling.samples() as f64 * sampling.interval();
        Ok(Hit { rig, excitation, duration, step: modal.step })
    }

    fn rig(&self, modal: &Modal, excitation: &Excitation) -> Result<Arc<ModalRig>, DynamicsError> {
        let structure = &self.assembly.structure;
        let count = modal.mode_count(self.at_rest.natural_frequency_hz, excitation);
        let modes = count.counts(structure.stack())?;
        let mut rigs = self.rigs.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, rig)) = rigs.iter().find(|(known, _)| *known == modes) {
            return Ok(Arc::clone(rig));
        }
        let rig = Arc::new(ModalRig::new(structure.reduced_to(&modes)?)?);
        rigs.push((modes, Arc::clone(&rig)));
        Ok(rig)
    }
}
