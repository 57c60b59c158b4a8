//! A rig with some unknowns, struck: from values of the unknowns to hits.

use std::path::Path;

use asperity_dynamics::{Excitation, ForceRecord, Hit};
use serde_json::{Value, json};

use crate::problem::Changes;
use crate::unknowns::{Gains, Sensors, Unknowns};
use asperity_scenario::{ExcitationSpec, Scenario, set_value};
use asperity_study::assemble::excitation;
use asperity_study::error::StudyError;
use asperity_study::prepared_scenario::PreparedScenario;

/// The scenario of some strikes, all but the force.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rig {
    /// The scenario, with the changes of these data.
    pub(super) scenario: Value,
}

/// One strike.
#[derive(Debug, Clone)]
pub(super) struct Strike {
    /// Number of its rig.
    pub(super) rig: usize,
    /// What it was measured with.
    pub(super) sensors: Sensors,
    /// The force.
    pub(super) drive: Drive,
    /// How long it is watched \[s\]; the scenario's duration if not given.
    pub(super) duration: Option<f64>,
    /// Frequencies at which its receptance is asked for \[Hz\].
    pub(super) frequencies: Vec<f64>,
    /// Whether its backbone is asked for.
    pub(super) backbone: bool,
}

/// The force of a strike.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Drive {
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

/// A rig at some values of the unknowns.
#[derive(Debug)]
pub(super) struct Prepared {
    pub(super) case: PreparedScenario,
    /// The scenario's excitation there.
    excitation: Value,
}

impl Rig {
    /// The rig at `point`.
    pub(super) fn prepare(
        &self,
        unknowns: &Unknowns,
        point: &[f64],
        folder: &Path,
    ) -> Result<Prepared, StudyError> {
        let mut scenario = self.scenario.clone();
        unknowns
            .write(&mut scenario, point)
            .map_err(|error| StudyError::Scenario { reason: error.to_string() })?;
        let silent = json!({"kind": "none"});
        let excitation = match scenario.get_mut("excitation") {
            Some(excitation) => std::mem::replace(excitation, silent),
            None => silent,
        };
        let scenario: Scenario = serde_json::from_value(scenario)
            .map_err(|error| StudyError::Scenario { reason: error.to_string() })?;
        Ok(Prepared { case: PreparedScenario::new(&scenario, folder)?, excitation })
    }
}

impl Strike {
    /// The force of the strike on a rig, as sensors of these `gains` have measured it.
    pub(super) fn excitation(
        &self,
        rig: &Prepared,
        gains: Gains,
        folder: &Path,
    ) -> Result<Excitation, StudyError> {
        let found = match &self.drive {
            Drive::Scenario { set, peak_n } => {
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
                    .map_err(|error| StudyError::Scenario { reason: error.to_string() })?;
                excitation(&spec, folder)?
            }
            Drive::Record { time_s, force_n } => {
                let force = force_n.iter().map(|force| force / gains.force).collect();
                Excitation::Record(ForceRecord::new(time_s.clone(), force)?)
            }
        };
        found.check()?;
        Ok(found)
    }

    /// The strike as a hit.
    pub(super) fn hit(
        &self,
        rig: &Prepared,
        gains: Gains,
        folder: &Path,
    ) -> Result<Hit, StudyError> {
        let modal = rig.case.modal().unwrap_or_default();
        let excitation = self.excitation(rig, gains, folder)?;
        let hit = rig.case.hit(&modal, excitation)?;
        Ok(Hit { duration: self.duration.unwrap_or(hit.duration), ..hit })
    }
}
