//! Simulated hits: from values of the parameters to simulations.

use std::path::Path;
use std::sync::Arc;

use asperity_dynamics::{Excitation, ForceRecord, HitSimulation};
use serde_json::{Value, json};

use crate::error::IdentificationError;
use crate::problem::Changes;
use crate::problem_parameters::{Gains, ProblemParameters, Sensors};
use asperity_scenario::set_value;
use asperity_scenario::{ExcitationSpec, Scenario};
use asperity_simulation::assemble::excitation;
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
    pub(super) drive: HitForce,
    /// Duration \[s\]; that of the scenario if not given.
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
    /// Step \[s\].
    pub(super) step: f64,
    /// Modes of each body.
    pub(super) counts: Vec<usize>,
}

impl HitResolution {
    /// True if this has steps as short and modes as many as `other`.
    pub(super) fn covers(&self, other: &Self) -> bool {
        let mut modes = self.counts.iter().zip(&other.counts);
        self.step <= 1.001 * other.step && modes.all(|(own, asked)| own >= asked)
    }
}

/// The force of a hit.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum HitForce {
    /// The scenario's, with some changes, and this peak as measured \[N\].
    Scenario {
        /// Changes inside /excitation.
        set: Changes,
        /// Measured peak.
        peak_n: Option<f64>,
    },
    /// Measured samples: times \[s\] and forces \[N\].
    Record {
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
        let scenario: Scenario = serde_json::from_value(scenario)
            .map_err(|error| SimulationError::Scenario(error.to_string()))?;
        Ok(Self { case: Arc::new(PreparedScenario::new(&scenario, folder)?), excitation })
    }
}

impl SimulatedHit {
    /// The force of the hit on a rig, as sensors of these `gains` have measured it.
    pub(super) fn excitation(
        &self,
        rig: &PreparedRig,
        gains: Gains,
        folder: &Path,
    ) -> Result<Excitation, SimulationError> {
        let found = match &self.drive {
            HitForce::Scenario { set, peak_n } => {
                let mut part = json!({ "excitation": rig.excitation });
                for (pointer, value) in set {
                    set_value(&mut part, pointer, &value.to_string())?;
                }
                if let (Some(peak), Some(Value::Object(excitation))) =
                    (peak_n, part.get_mut("excitation"))
                {
                    excitation.insert("peak_n".to_owned(), (peak / gains.force).into());
                }
                let spec = part.get_mut("excitation").map(Value::take).unwrap_or_default();
                let spec: ExcitationSpec = serde_json::from_value(spec)
                    .map_err(|error| SimulationError::Scenario(error.to_string()))?;
                excitation(&spec, folder)?
            }
            HitForce::Record { time_s, force_n } => {
                let force = force_n.iter().map(|force| force / gains.force).collect();
                Excitation::Record(ForceRecord::new(time_s.clone(), force)?)
            }
        };
        found.check()?;
        Ok(found)
    }

    /// The simulation of the hit.
    pub(super) fn simulation(
        &self,
        rig: &PreparedRig,
        gains: Gains,
        folder: &Path,
    ) -> Result<HitSimulation, SimulationError> {
        let modal = rig.case.modal().unwrap_or_default();
        let excitation = self.excitation(rig, gains, folder)?;
        let hit = rig.case.case(&modal, excitation)?;
        let duration = self.duration.unwrap_or(hit.duration);
        Ok(match &self.resolution {
            Some(HitResolution { step, counts }) => {
                let model = rig.case.modal_model(counts)?;
                HitSimulation { model, duration, step: Some(*step), ..hit }
            }
            None => HitSimulation { duration, ..hit },
        })
    }

    /// Modes of each body in the simulation of the hit under `excitation`.
    pub(super) fn mode_counts(
        &self,
        rig: &PreparedRig,
        excitation: &Excitation,
    ) -> Result<Vec<usize>, SimulationError> {
        match &self.resolution {
            Some(resolution) => Ok(resolution.counts.clone()),
            None => Ok(rig.case.mode_counts(&rig.case.modal().unwrap_or_default(), excitation)?),
        }
    }
}
