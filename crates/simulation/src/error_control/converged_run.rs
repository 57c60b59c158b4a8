//! Requests to the error control, and the runs that reach their accuracy.

use std::sync::Arc;

use asperity_dynamics::{CaseResponse, TransientCase};
use asperity_structure::LoadCase;

use crate::accuracy::ErrorEstimate;
use crate::error::SimulationError;
use crate::observables::Observables;
use crate::prepared_scenario::PreparedScenario;

/// A modal run that is to reach the accuracy of its scenario.
#[derive(Debug, Clone)]
pub struct RunRequest {
    /// The structure at rest, and the accuracy.
    pub prepared: Arc<PreparedScenario>,
    /// The load.
    pub load: LoadCase,
    /// Number of the sensor that is read.
    pub sensor: usize,
    /// Duration \[s\]; that of the scenario if not given.
    pub duration: Option<f64>,
    /// A structure close to this one, and the load with a rounded amplitude: other requests have the same, and
    /// step, modes and errors are found there. None for a request that is refined by itself.
    pub near: Option<(Arc<PreparedScenario>, LoadCase)>,
}

/// A transient case with the step and the modes that were chosen, and its observables with their
/// errors.
#[derive(Debug)]
pub struct ConvergedRun {
    /// The transient case.
    pub case: TransientCase,
    /// Its observables, with [estimated errors](Observables::estimate).
    pub observables: Observables,
    /// Modes of each body, the rigid one included.
    pub counts: Vec<usize>,
    pub(super) record: CaseResponse,
}

impl ConvergedRun {
    /// Runs of one load at all sensors as the run at the first, with the features of the others.
    ///
    /// # Errors
    /// The first error among the runs.
    pub(crate) fn joined(
        runs: impl IntoIterator<Item = Result<Self, SimulationError>>,
    ) -> Result<Self, SimulationError> {
        let mut runs = runs.into_iter();
        let mut first = runs.next().unwrap_or(Err(SimulationError::NoSensor))?;
        let others = runs.map(|run| Ok(run?.observables));
        let others = others.collect::<Result<Vec<_>, SimulationError>>()?;
        first.observables = first.observables.with_sensors(others);
        Ok(first)
    }

    pub(super) fn is_reached(&self) -> bool {
        self.observables.estimate().is_some_and(ErrorEstimate::is_reached)
    }
}

impl RunRequest {
    /// The requests of a load read at each sensor.
    pub fn at_sensors(
        prepared: &Arc<PreparedScenario>,
        load: &LoadCase,
        duration: Option<f64>,
    ) -> Vec<Self> {
        let request = |sensor: usize| Self {
            prepared: Arc::clone(prepared),
            load: load.clone(),
            sensor,
            duration,
            near: None,
        };
        (0..prepared.assembly.sensors.len()).map(request).collect()
    }

    /// The request of the reference run: on the [near](Self::near) structure, if there is one, the next power
    /// of two above the amplitude of this request; none for no load.
    pub(super) fn reference(&self) -> Option<Self> {
        let amplitude = self.load.amplitude();
        if self.load.peak() == 0.0 {
            return None;
        }
        let octave = amplitude.abs().log2().ceil().exp2().copysign(amplitude);
        let prepared = self.near.as_ref().map_or(&self.prepared, |(prepared, _)| prepared);
        let (prepared, load) = (Arc::clone(prepared), self.load.with_amplitude(octave));
        Some(Self { prepared, load, near: None, ..self.clone() })
    }

    /// The request of the near run, which loses contact as this request does.
    pub(super) fn near_run(&self) -> Option<Self> {
        let (prepared, load) = self.near.clone()?;
        Some(Self { prepared, load, near: None, ..self.clone() })
    }

    pub(super) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.prepared, &other.prepared)
            && (self.sensor, self.duration) == (other.sensor, other.duration)
            && self.load == other.load
    }
}
