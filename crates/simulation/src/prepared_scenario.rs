//! An assembled scenario, prepared once for many runs that differ in their force alone.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::{DynamicsError, Integrator, Modal, ModalModel, TransientCase};
use asperity_mesh::Port;
use asperity_scenario::Scenario;
use asperity_structure::LoadCase;

use crate::assemble::{Assembly, Sensor};
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
    /// By the number of modes of each body, which may depend on the load, and the port of the load.
    models: Mutex<Vec<KnownModel>>,
}

type KnownModel = (Vec<usize>, Port, Arc<ModalModel>);

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
        let named = |one: &Sensor| one.name.clone().unwrap_or_default();
        let further: Vec<String> = assembly.sensors.iter().skip(1).map(named).collect();
        let further: Vec<&str> = further.iter().map(String::as_str).collect();
        let base = assembly.load.base().is_some();
        let names = observable_names(&interfaces, &further, base).into();
        Ok(Self { assembly, at_rest, names, models: Mutex::default() })
    }

    /// The modal integrator, if the scenario asks for it.
    pub fn modal(&self) -> Option<Modal> {
        match self.assembly.method {
            Integrator::Modal(modal) => Some(modal),
            Integrator::FiniteDifference(_) => None,
        }
    }

    /// The transient case of `load` on the structure, read at its first sensor, for the duration of the
    /// scenario.
    ///
    /// # Errors
    /// [`SimulationError::Dynamics`] for a load or a number of modes out of range.
    pub fn case(&self, modal: &Modal, load: LoadCase) -> Result<TransientCase, SimulationError> {
        load.check()?;
        let model = self.modal_model(&self.mode_counts(modal, &load)?, load.port())?;
        let sampling = &self.assembly.sampling;
        let duration = sampling.samples() as f64 * sampling.interval();
        Ok(TransientCase { model, load, sensor: 0, duration, step: modal.step, tolerance: None })
    }

    /// Number of modes kept of each body for `load`, the rigid one included.
    ///
    /// # Errors
    /// [`DynamicsError::Mesh`] for a number out of range.
    pub fn mode_counts(&self, modal: &Modal, load: &LoadCase) -> Result<Vec<usize>, DynamicsError> {
        let count = modal.mode_count(self.at_rest.natural_frequency_hz, load);
        Ok(count.counts(self.assembly.structure.stack())?)
    }

    /// The modal model with these numbers of modes of each body, loaded at `port` and read at the
    /// sensors.
    ///
    /// # Errors
    /// As [`ModalModel::new`].
    pub fn modal_model(
        &self,
        counts: &[usize],
        port: Port,
    ) -> Result<Arc<ModalModel>, DynamicsError> {
        let mut models = self.models.lock().unwrap_or_else(PoisonError::into_inner);
        let known = |one: &&KnownModel| one.0 == counts && one.1 == port;
        if let Some((_, _, model)) = models.iter().find(known) {
            return Ok(Arc::clone(model));
        }
        let Assembly { structure, .. } = &self.assembly;
        let sensors = self.assembly.sensor_ports();
        let model = Arc::new(ModalModel::of_stack(structure, counts, port, &sensors)?);
        models.push((counts.to_vec(), port, Arc::clone(&model)));
        Ok(model)
    }
}
