//! Time integration of structures with contact patches, refined.
//!
//! A run is refined until its numbers are as accurate as was asked for: the step is halved, and the response
//! of two thirds of the modes shows the error by the modes left out, whose flexibility is kept and
//! whose inertia is not.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity_dynamics::{
    ContactExtremes, ContactsResponse, ContactsState, DynamicsError, InterfaceHistory,
    ManyContacts, Sampling, Transient,
};
use asperity_mesh::ComponentModes;
use asperity_signal::Complex64;
use asperity_structure::{Damping, LoadCase, PreloadedStructure};

use super::Patch;
use super::recording::Recording;
use super::structure::PatchStructure;
use crate::accuracy::ErrorEstimate;
use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::observables::{Observables, free_from};
use crate::response_parts::most_readings;
use crate::row_inputs::receptance_of;

/// Steps of the first response in the period of the lowest natural frequency, and in the time in which the
/// load changes.
const STEPS_IN_PERIOD: f64 = 80.0;
const STEPS_IN_LOAD: f64 = 20.0;

/// Most halvings of the first step.
const MOST_HALVINGS: u32 = 7;

/// Most steps times contacts of a response that is refined any more.
const MOST_WORK: f64 = 1e8;

/// Share of the accuracy that the error by the step may have.
const STEP_SHARE: f64 = 0.5;

/// Most numbers that are read of a response beyond its output, 160 MB.
const MOST_READ: usize = 20_000_000;

/// Least number of modes with inertia of a response with fewer of them.
const LEAST_MODES: usize = 2;

/// A structure at rest with its force, ready for steps of time.
#[derive(Debug, Clone)]
pub struct PatchSystem {
    /// The structure, the force and the sampling.
    pub assembly: Assembly<PatchStructure>,
    system: ManyContacts,
    pub(super) recording: Recording,
}

/// A response of a structure with patches.
#[derive(Debug)]
pub struct PatchResponse {
    /// Motions, with an interface for each patch, read several times for each output sample.
    pub transient: Transient,
    /// Readings for each output sample.
    pub readings: usize,
    /// Extremes of each cell, and of the springs after them.
    pub cells: Vec<ContactExtremes>,
    /// Its observables.
    pub observables: Observables,
    /// States at the instants that are recorded.
    pub(super) states: Vec<ContactsState>,
    /// Cells that are recorded over time.
    pub(super) recorded: Vec<InterfaceHistory>,
}

/// A response that is accurate enough, or as accurate as work allows.
#[derive(Debug)]
pub struct RefinedPatchResponse {
    /// The response, its observables with their estimated errors.
    pub response: PatchResponse,
    /// Steps between samples.
    pub parts: usize,
    /// Relative errors by the modes left out, at most.
    pub truncation: f64,
}

impl PatchSystem {
    /// The system of an assembled structure.
    ///
    /// # Errors
    /// [`SimulationError::Dynamics`] for contacts that time integration does not take.
    pub fn new(assembly: Assembly<PatchStructure>) -> Result<Self, SimulationError> {
        Self::recorded(assembly, Recording::default())
    }

    /// The system whose responses have what is recorded, too.
    pub(super) fn recorded(
        assembly: Assembly<PatchStructure>,
        recording: Recording,
    ) -> Result<Self, SimulationError> {
        let structure = Arc::clone(&assembly.structure.structure);
        let system = system(&assembly, structure, &recording)?;
        Ok(Self { assembly, system, recording })
    }

    /// The same structure under another force, for a duration \[s\], by default its own.
    ///
    /// # Errors
    /// [`SimulationError::Dynamics`] for a duration out of range.
    pub fn with_load(
        &self,
        load: LoadCase,
        duration: Option<f64>,
    ) -> Result<Self, SimulationError> {
        let mut own = self.clone();
        own.assembly.load = load;
        if let Some(duration) = duration {
            own.assembly.sampling = Sampling::new(duration, own.assembly.sampling.rate())?;
        }
        Ok(own)
    }

    /// Steps between samples of a first response.
    pub fn first_parts(&self) -> usize {
        let Assembly { structure, load, sampling, .. } = &self.assembly;
        let natural = structure.structure.natural_frequency();
        let period = natural.map_or(f64::INFINITY, |hz| 1.0 / (hz * STEPS_IN_PERIOD));
        let step = period.min(load.time_scale() / STEPS_IN_LOAD);
        let interval = sampling.interval();
        if step.is_finite() { (interval / step).ceil().max(1.0) as usize } else { 1 }
    }

    /// The response with `parts` steps between samples.
    ///
    /// # Errors
    /// [`SimulationError::Dynamics`] as [`ManyContacts::integrate`].
    pub fn response(&self, parts: usize) -> Result<PatchResponse, SimulationError> {
        self.response_of(&self.system, parts, &AtomicBool::new(false))
    }

    fn response_of(
        &self,
        system: &ManyContacts,
        parts: usize,
        stop: &AtomicBool,
    ) -> Result<PatchResponse, SimulationError> {
        let Assembly { structure, load, sampling, .. } = &self.assembly;
        let readings = self.readings(parts);
        let read = sampling.divided(readings);
        let instants = self.recording.samples.iter().map(|sample| sample * readings).collect();
        let system = system.clone().with_instants(instants);
        let found = system.integrate_unless(load, &read, parts / readings, stop)?;
        let ContactsResponse { mut transient, contacts: cells, states } = found;
        // Cells that are recorded come after the patches.
        let patches = structure.patches.len();
        let recorded = transient.history.interfaces.split_off(patches);
        transient.contacts.truncate(patches);
        let at_rest = structure.at_rest();
        let seen = (&transient, read.rate());
        let observables = Observables::of_transient(&self.assembly, &at_rest, seen)?;
        Ok(PatchResponse { transient, readings, cells, observables, states, recorded })
    }

    /// Readings for each output sample of a response with `parts` steps between samples: every step is read, so that the
    /// observables are as accurate as the steps at any output rate, up to [`MOST_READ`] numbers.
    fn readings(&self, parts: usize) -> usize {
        let Assembly { structure, sampling, sensors, .. } = &self.assembly;
        let interfaces = structure.patches.len() + self.recording.contacts.len();
        let numbers = sampling.samples() * (2 + 3 * sensors.len() + 3 * interfaces);
        most_readings(parts, MOST_READ / numbers.max(1))
    }

    /// The response to the accuracy of its scenario, unless `stop` is set before; `progress` receives the fraction
    /// done.
    ///
    /// # Errors
    /// Those of [`response`](Self::response), and [`DynamicsError::Stopped`].
    pub fn refined(
        &self,
        stop: &AtomicBool,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<RefinedPatchResponse, SimulationError> {
        let accuracy = self.assembly.accuracy;
        let samples = self.assembly.sampling.samples() as f64;
        let contacts = self.assembly.structure.structure.contacts().len() as f64;
        let first = self.first_parts();
        let mut last: Option<PatchResponse> = None;
        let mut halvings = 0;
        loop {
            let parts = first << halvings;
            let may_halve =
                halvings < MOST_HALVINGS && 2.0 * samples * parts as f64 * contacts <= MOST_WORK;
            let found = match self.response_of(&self.system, parts, stop) {
                Err(SimulationError::Dynamics(
                    DynamicsError::Coarse { .. } | DynamicsError::Unstable { .. },
                )) if may_halve => {
                    halvings += 1;
                    continue;
                }
                found => found?,
            };
            progress(0.3 + 0.6 * f64::from(halvings + 1) / f64::from(MOST_HALVINGS + 1));
            let lost = found.cells.iter().any(|one| one.lost > 0.0);
            let by_step = match &last {
                // Of second order while contact holds, of first where it is lost.
                Some(coarser) => ErrorEstimate::new(
                    found.observables.all(),
                    coarser.observables.all(),
                    if lost { 1.0 } else { 3.0 },
                    accuracy,
                ),
                None => ErrorEstimate::unknown(found.observables.all(), accuracy),
            };
            tracing::debug!(
                step_s = found.transient.step,
                error_by_step = by_step.relative,
                "refined"
            );
            if by_step.relative <= STEP_SHARE * accuracy || !may_halve {
                let by_modes = self.truncation(parts, &found, stop)?;
                let truncation = by_modes.relative;
                let observables = found.observables.with_estimate(by_step.plus(&by_modes));
                let response = PatchResponse { observables, ..found };
                return Ok(RefinedPatchResponse { response, parts, truncation });
            }
            last = Some(found);
            halvings += 1;
        }
    }

    /// Errors by the modes left out: the response of two thirds of them differs by more.
    fn truncation(
        &self,
        parts: usize,
        found: &PatchResponse,
        stop: &AtomicBool,
    ) -> Result<ErrorEstimate, SimulationError> {
        let accuracy = self.assembly.accuracy;
        let structure = &*self.assembly.structure.structure;
        let modes = structure.component_modes();
        let inert = modes.modes().iter().filter(|mode| !mode.massless).count();
        let fewer = (2 * inert / 3).max(LEAST_MODES);
        if fewer >= inert {
            return Ok(ErrorEstimate::of_share(found.observables.all(), 0.0, accuracy));
        }
        let fewer = PreloadedStructure::of_components(
            modes.with_inertia_of(fewer),
            structure.contacts().to_vec(),
            Damping::Rate(structure.damping_rate()),
        )?;
        let system = system(&self.assembly, Arc::new(fewer), &Recording::default())?;
        let other = self.response_of(&system, parts, stop)?.observables;
        Ok(ErrorEstimate::new(found.observables.all(), other.all(), 1.0, accuracy))
    }

    /// Lowest and highest pressure \[Pa\] of the cells of each patch in a response.
    pub fn pressures(&self, response: &PatchResponse) -> Vec<[f64; 2]> {
        let of = |patch: &Patch| {
            let cells = response.cells[patch.cells.clone()].iter();
            cells.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], cell| {
                [low.min(cell.pressure_min), high.max(cell.pressure_max)]
            })
        };
        self.assembly.structure.patches.iter().map(of).collect()
    }
}

impl PatchResponse {
    /// Receptance of the first sensor \[m/N\] at `frequencies` \[Hz\]; NaN from half of the sample rate on.
    pub fn receptance(&self, frequencies: &[f64]) -> Vec<Complex64> {
        receptance_of(&self.transient.history, self.rate(), frequencies)
    }

    /// Displacement of the first sensor \[m\] after the force, whose peak is `peak` \[N\], and its sample rate \[Hz\].
    pub fn decay(&self, peak: f64) -> (&[f64], f64) {
        let history = &self.transient.history;
        let free = free_from(&history.load, peak);
        (&history.sensors[0].displacement[free..], self.rate())
    }

    fn rate(&self) -> f64 {
        match self.transient.history.time[..] {
            [first, second, ..] => 1.0 / (second - first),
            _ => f64::NAN,
        }
    }
}

/// The system that time integration steps, with an interface for each patch and each cell that is recorded.
pub(super) fn system(
    assembly: &Assembly<PatchStructure>,
    structure: Arc<PreloadedStructure<ComponentModes>>,
    recording: &Recording,
) -> Result<ManyContacts, SimulationError> {
    let PatchStructure { patches, load, sensors, .. } = &assembly.structure;
    let patches = patches.iter().map(|patch| patch.cells.clone());
    let cells = recording.contacts.iter().map(|&contact| contact..contact + 1);
    let system = ManyContacts::new(structure, *load, sensors.clone())?;
    Ok(system.with_groups(patches.chain(cells).collect()))
}
