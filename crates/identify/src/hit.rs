//! Simulated hits: rigs at values of the parameters, and hits on rigs of bars.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use asperity_dynamics::TransientCase;
use asperity_inference::CorrelatedErrors;
use asperity_mesh::Port;
use asperity_structure::{LoadCase, SampledFunction};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::error::IdentificationError;
use crate::problem::Changes;
use crate::problem_parameters::{Gains, ProblemParameters, Sensors};
use asperity_scenario::set_value;
use asperity_scenario::{ExcitationSpec, PlaceSpec, Scenario, StructureScenario, has_matrices};
use asperity_simulation::assemble::{load_case, load_case_at};
use asperity_simulation::error::SimulationError;
use asperity_simulation::observables::Observables;
use asperity_simulation::patches::{PatchSystem, ReducedStructures};
use asperity_simulation::prepared_scenario::PreparedScenario;
use asperity_simulation::static_state::StaticSummary;

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
    /// Errors that its receptances share.
    pub(super) shared_errors: Vec<SharedErrors>,
}

/// Errors of the real and imaginary parts of receptances of a hit.
#[derive(Debug, Clone)]
pub(super) struct SharedErrors {
    /// Places of the receptances among the frequencies of the hit.
    pub(super) lines: Range<usize>,
    /// Their errors, in the order of the observations.
    pub(super) errors: Arc<CorrelatedErrors>,
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

/// A hit to the accuracy of its scenario.
#[derive(Debug)]
pub(super) struct ConvergedHit {
    /// Peak of the force \[N\].
    pub(super) peak: f64,
    /// Step and modes.
    pub(super) resolution: Option<HitResolution>,
    /// Observables with their estimated errors.
    pub(super) observables: Observables,
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
    case: RigCase,
    /// The scenario's excitation there.
    excitation: Value,
}

/// A rig of bars, or a structure of matrices with its state at rest.
#[derive(Debug)]
enum RigCase {
    Bars(Arc<PreparedScenario>),
    Structure(Box<(PatchSystem, StaticSummary)>),
}

impl PreparedRig {
    /// The rig of a scenario (with the changes of its data) at `point`.
    pub(super) fn new(
        scenario: &Value,
        parameters: &ProblemParameters,
        point: &[f64],
        (folder, reductions): (&Path, &ReducedStructures),
    ) -> Result<Self, SimulationError> {
        let mut scenario = scenario.clone();
        parameters
            .write(&mut scenario, point)
            .map_err(|error| SimulationError::Scenario(error.to_string()))?;
        let is_structure = has_matrices(&scenario);
        // The place of a force is a port of a structure of matrices.
        let none = || json!({"kind": "none"});
        let silent = match (is_structure, scenario.pointer("/excitation/at")) {
            (true, Some(at)) => {
                json!({"kind": "haversine", "peak_n": 1, "duration_s": 1e-3, "at": at})
            }
            (true, None) => scenario.get("excitation").cloned().unwrap_or_else(none),
            (false, _) => none(),
        };
        let excitation = match scenario.get_mut("excitation") {
            Some(excitation) => std::mem::replace(excitation, silent),
            None => silent,
        };
        let case = if is_structure {
            let scenario: StructureScenario =
                serde_json::from_value(scenario).map_err(|error| invalid(&error))?;
            let assembly = reductions.assemble(&scenario, folder)?;
            let at_rest = assembly.structure.at_rest();
            RigCase::Structure(Box::new((PatchSystem::new(assembly)?, at_rest)))
        } else {
            let scenario: Scenario =
                serde_json::from_value(scenario).map_err(|error| invalid(&error))?;
            RigCase::Bars(Arc::new(PreparedScenario::new(&scenario, folder)?))
        };
        Ok(Self { case, excitation })
    }

    /// The state at rest.
    pub(super) fn at_rest(&self) -> &StaticSummary {
        match &self.case {
            RigCase::Bars(bars) => &bars.at_rest,
            RigCase::Structure(structure) => &structure.1,
        }
    }

    /// The rig of bars.
    pub(super) fn bars(&self) -> Result<&Arc<PreparedScenario>, SimulationError> {
        match &self.case {
            RigCase::Bars(bars) => Ok(bars),
            RigCase::Structure(_) => Err(other_kind("a stack of bars")),
        }
    }

    /// The structure of matrices.
    pub(super) fn structure(&self) -> Result<&PatchSystem, SimulationError> {
        match &self.case {
            RigCase::Bars(_) => Err(other_kind("a structure of matrices")),
            RigCase::Structure(structure) => Ok(&structure.0),
        }
    }
}

fn other_kind(expected: &str) -> SimulationError {
    SimulationError::Scenario(format!("the rig is not {expected}"))
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
        if let RigCase::Structure(structure) = &self.case {
            return Ok(Port::Number(structure.0.assembly.structure.load));
        }
        let excitation = self.excitation(set)?;
        let Some(at) = excitation.get("at") else { return Ok(Port::TOP) };
        let at = PlaceSpec::deserialize(at).map_err(|error| invalid(&error))?;
        Ok(at.port(self.bars()?.assembly.structure.stack().bodies())?)
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
        let load = match &self.force {
            HitForce::Scenario { set, peak_n } => {
                let spec = ExcitationSpec::deserialize(rig.excitation(set)?)
                    .map_err(|error| invalid(&error))?;
                let load = match &rig.case {
                    RigCase::Bars(bars) => {
                        load_case(&spec, bars.assembly.structure.stack().bodies(), folder)?
                    }
                    RigCase::Structure(_) => load_case_at(&spec, rig.load_port(set)?, folder)?,
                };
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

    /// The simulation of the hit on a rig of bars.
    pub(super) fn simulation(
        &self,
        rig: &PreparedRig,
        gains: Gains,
        folder: &Path,
    ) -> Result<TransientCase, SimulationError> {
        let bars = rig.bars()?;
        let modal = bars.modal().unwrap_or_default();
        let hit = bars.case(&modal, self.load(rig, gains, folder)?)?;
        let duration = self.duration.unwrap_or(hit.duration);
        Ok(match &self.resolution {
            Some(HitResolution { step, tolerance, counts }) => {
                let model = bars.modal_model(counts, hit.load.port())?;
                let tolerance = *tolerance;
                TransientCase { model, duration, step: Some(*step), tolerance, ..hit }
            }
            None => TransientCase { duration, ..hit },
        })
    }

    /// Modes of each body in the simulation of the hit under `load` on a rig of bars.
    pub(super) fn mode_counts(
        &self,
        rig: &PreparedRig,
        load: &LoadCase,
    ) -> Result<Vec<usize>, SimulationError> {
        if let Some(resolution) = &self.resolution {
            return Ok(resolution.counts.clone());
        }
        let bars = rig.bars()?;
        Ok(bars.mode_counts(&bars.modal().unwrap_or_default(), load)?)
    }
}
