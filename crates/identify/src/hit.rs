//! Simulated hits: from values of the parameters to simulations.

use std::path::Path;
use std::sync::Arc;

use asperity_dynamics::TransientCase;
use asperity_mesh::Port;
use asperity_structure::{LoadCase, SampledFunction};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::error::IdentificationError;
use crate::problem::Changes;
use crate::problem_parameters::{Gains, ProblemParameters, Sensors};
use asperity_scenario::set_value;
use asperity_scenario::{ExcitationSpec, PlaceSpec, Scenario};
use asperity_simulation::assemble::load_case;
use asperity_simulation::error::SimulationError;
use asperity_simulation::prepared_scenario::PreparedScenario;

/// Applies the changes of `place` to a scenario.
pub(super) fn apply(
    scenario: &mut Value,
    changes: &Changes,
    place: &str,
) -> Result<(), IdentificationError> {
    changes.iter().try_for_each(|(pointer, value)| {
        set_value(scenario, pointer, &value.to_string())
            .map(|_| ())
            .map_err(|source| IdentificationError::Set { place: place.to_owned(), source })
    })
}

/// One simulated hit.
#[derive(Debug, Clone)]
pub(super) struct SimulatedHit {
    /// Name of the first data that ask for it.
    pub(super) data: String,
    /// Index of its rig.
    pub(super) rig: usize,
    /// Gains of its sensors.
    pub(super) sensors: Sensors,
    /// The force.
    pub(super) force: HitForce,
    /// Duration \[s\]; the scenario's if not given.
    pub(super) duration: Option<f64>,
    /// Step and modes, held for all points so that results are smooth in the parameters.
    pub(super) resolution: Option<HitResolution>,
    /// Frequencies of the requested receptance \[Hz\].
    pub(super) frequencies: Vec<f64>,
    /// True if its backbone is requested.
    pub(super) backbone: bool,
}

/// Step and modes of a hit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HitResolution {
    /// Step \[s\], the longest where contact is lost.
    pub(super) step: f64,
    /// Tolerance of steps of the hit's own, where contact is lost.
    pub(super) tolerance: Option<f64>,
    /// Modes of each body.
    pub(super) counts: Vec<usize>,
}

impl HitResolution {
    /// True if this has steps as short and modes as many as `other`.
    pub(super) fn covers(&self, other: &Self) -> bool {
        let mut modes = self.counts.iter().zip(&other.counts);
        let tolerances = match (self.tolerance, other.tolerance) {
            (Some(own), Some(asked)) => own <= asked,
            (own, asked) => own.is_some() || asked.is_none(),
        };
        tolerances && self.step <= 1.001 * other.step && modes.all(|(own, asked)| own >= asked)
    }
}

/// The force of a hit.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum HitForce {
    /// The force of the scenario, with some changes, and this peak as measured \[N\].
    Scenario {
        /// Changes inside /excitation.
        set: Changes,
        /// Measured peak.
        peak_n: Option<f64>,
    },
    /// Measured samples: times \[s\] and forces \[N\].
    Record {
        /// Changes inside /excitation, whose place is that of the force.
        set: Changes,
        /// Times \[s\].
        time_s: Vec<f64>,
        /// Forces as measured \[N\].
        force_n: Vec<f64>,
    },
}

/// A rig at some values of the parameters.
#[derive(Debug)]
pub(super) struct PreparedRig {
    pub(super) case: Arc<PreparedScenario>,
    /// The scenario's excitation there.
    excitation: Value,
}

impl PreparedRig {
    /// The rig of a scenario (with the changes of its data) at `point`.
    pub(super) fn new(
        scenario: &Value,
        parameters: &ProblemParameters,
        point: &[f64],
        folder: &Path,
    ) -> Result<Self, SimulationError> {
        let mut scenario = scenario.clone();
        parameters
            .write(&mut scenario, point)
            .map_err(|error| SimulationError::Scenario(error.to_string()))?;
        let silent = json!({"kind": "none"});
        let excitation = match scenario.get_mut("excitation") {
            Some(excitation) => std::mem::replace(excitation, silent),
            None => silent,
        };
        let scenario: Scenario =
            serde_json::from_value(scenario).map_err(|error| invalid(&error))?;
        Ok(Self { case: Arc::new(PreparedScenario::new(&scenario, folder)?), excitation })
    }
}

fn invalid(error: &serde_json::Error) -> SimulationError {
    SimulationError::Scenario(error.to_string())
}

impl PreparedRig {
    /// The scenario's excitation with some changes inside it.
    fn excitation(&self, set: &Changes) -> Result<Value, SimulationError> {
        let mut part = json!({ "excitation": self.excitation });
        for (pointer, value) in set {
            set_value(&mut part, pointer, &value.to_string())?;
        }
        Ok(part.get_mut("excitation").map(Value::take).unwrap_or_default())
    }

    /// The port of the scenario's excitation with some changes inside it.
    pub(super) fn load_port(&self, set: &Changes) -> Result<Port, SimulationError> {
        let excitation = self.excitation(set)?;
        let Some(at) = excitation.get("at") else { return Ok(Port::TOP) };
        let at = PlaceSpec::deserialize(at).map_err(|error| invalid(&error))?;
        Ok(at.port(self.case.assembly.structure.stack().bodies())?)
    }
}

impl SimulatedHit {
    /// The force of the hit on a rig, as sensors of these `gains` have measured it.
    pub(super) fn load(
        &self,
        rig: &PreparedRig,
        gains: Gains,
        folder: &Path,
    ) -> Result<LoadCase, SimulationError> {
        let bodies = rig.case.assembly.structure.stack().bodies();
        let load = match &self.force {
            HitForce::Scenario { set, peak_n } => {
                let spec = ExcitationSpec::deserialize(rig.excitation(set)?)
                    .map_err(|error| invalid(&error))?;
                let load = load_case(&spec, bodies, folder)?;
                match peak_n {
                    Some(peak) => load.with_amplitude(peak / gains.force),
                    None => load,
                }
            }
            HitForce::Record { set, time_s, force_n } => {
                let samples = SampledFunction::new(time_s.clone(), force_n.clone())?;
                let load = LoadCase::samples(&samples).at(rig.load_port(set)?);
                load.with_amplitude(load.amplitude() / gains.force)
            }
        };
        load.check()?;
        Ok(load)
    }

    /// The simulation of the hit.
    pub(super) fn simulation(
        &self,
        rig: &PreparedRig,
        gains: Gains,
        folder: &Path,
    ) -> Result<TransientCase, SimulationError> {
        let modal = rig.case.modal().unwrap_or_default();
        let hit = rig.case.case(&modal, self.load(rig, gains, folder)?)?;
        let duration = self.duration.unwrap_or(hit.duration);
        Ok(match &self.resolution {
            Some(HitResolution { step, tolerance, counts }) => {
                let model = rig.case.modal_model(counts, hit.load.port())?;
                let tolerance = *tolerance;
                TransientCase { model, duration, step: Some(*step), tolerance, ..hit }
            }
            None => TransientCase { duration, ..hit },
        })
    }

    /// Modes of each body in the simulation of the hit under `load`.
    pub(super) fn mode_counts(
        &self,
        rig: &PreparedRig,
        load: &LoadCase,
    ) -> Result<Vec<usize>, SimulationError> {
        match &self.resolution {
            Some(resolution) => Ok(resolution.counts.clone()),
            None => Ok(rig.case.mode_counts(&rig.case.modal().unwrap_or_default(), load)?),
        }
    }
}
