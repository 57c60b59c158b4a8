//! An assembled scenario, prepared once for many runs that differ in their force alone.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::{DynamicsError, Excitation, HitSimulation, Integrator, Modal, ModalModel};
use asperity_scenario::Scenario;

use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::quantity::observable_names;
use crate::static_state::StaticSummary;

/// An assembled scenario with its state at rest and the modal models built so far.
#[derive(Debug)]
pub struct PreparedScenario {
    /// The assembled scenario.
    pub assembly: Assembly,
    /// Its state at rest.
    pub at_rest: StaticSummary,
    /// Names of the observables of its responses.
    pub names: Arc<[String]>,
    /// By the number of modes of each body, which may depend on the force.
    models: Mutex<Vec<(Vec<usize>, Arc<ModalModel>)>>,
}

impl PreparedScenario {
    /// Assembles a scenario; sample files are looked for in `folder`.
    ///
    /// # Errors
    /// [`SimulationError`] when a part cannot be built.
    pub fn new(scenario: &Scenario, folder: &Path) -> Result<Self, SimulationError> {
        let assembly = Assembly::new(scenario, folder)?;
        let at_rest = StaticSummary::of(&assembly);
        let interfaces: Vec<&str> =
            at_rest.interfaces.iter().map(|one| one.name.as_str()).collect();
        let names = observable_names(&interfaces).into();
        Ok(Self { assembly, at_rest, names, models: Mutex::default() })
    }

    /// The modal integrator, if the scenario asks for it.
    pub fn modal(&self) -> Option<Modal> {
        match self.assembly.method {
            Integrator::Modal(modal) => Some(modal),
            Integrator::FiniteDifference(_) => None,
        }
    }

    /// The transient case of `excitation` on the structure, for the duration of the scenario.
    ///
    /// # Errors
    /// [`SimulationError::Dynamics`] for a force or a number of modes out of range.
    pub fn case(
        &self,
        modal: &Modal,
        excitation: Excitation,
    ) -> Result<HitSimulation, SimulationError> {
        excitation.check()?;
        let model = self.modal_model(&self.mode_counts(modal, &excitation)?)?;
        let sampling = &self.assembly.sampling;
        let duration = sampling.samples() as f64 * sampling.interval();
        Ok(HitSimulation { model, excitation, duration, step: modal.step })
    }

    /// Number of modes kept of each body for `excitation`, the rigid one included.
    ///
    /// # Errors
    /// [`DynamicsError::Mesh`] for a number out of range.
    pub fn mode_counts(
        &self,
        modal: &Modal,
        excitation: &Excitation,
    ) -> Result<Vec<usize>, DynamicsError> {
        let count = modal.mode_count(self.at_rest.natural_frequency_hz, excitation);
        Ok(count.counts(self.assembly.structure.stack())?)
    }

    /// The modal model with these numbers of modes of each body.
    ///
    /// # Errors
    /// As [`ModalModel::new`].
    pub fn modal_model(&self, counts: &[usize]) -> Result<Arc<ModalModel>, DynamicsError> {
        let mut models = self.models.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, model)) = models.iter().find(|(known, _)| known == counts) {
            return Ok(Arc::clone(model));
        }
        let model = Arc::new(ModalModel::new(self.assembly.structure.reduced_to(counts)?)?);
        models.push((counts.to_vec(), Arc::clone(&model)));
        Ok(model)
    }
}
