//! Transient runs of structures with contact patches.
//!
//! A run is refined until its numbers are as accurate as was asked for: the step is halved, and the response
//! of two thirds of the modes shows the error by the modes left out, whose flexibility is kept and
//! whose inertia is not.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use asperity_dynamics::{ContactExtremes, DynamicsError, ManyContacts, Sampling, Transient};
use asperity_scenario::{Document, StructureScenario};
use asperity_signal::Complex64;
use asperity_structure::{LoadCase, PreloadedContact, PreloadedStructure};
use asperity_table::DataTable;
use serde::Serialize;
use tracing::info_span;

use super::structure::{PatchStructure, assemble_patches};
use crate::accuracy::ErrorEstimate;
use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::observables::{Observables, free_from};
use crate::provenance::Provenance;
use crate::row_inputs::receptance_of;
use crate::run::Run;
use crate::summary::{Numerics, Summary};

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

/// Least number of modes with inertia of a response with fewer of them.
const LEAST_MODES: usize = 2;

/// A finished run of a structure with patches.
#[derive(Debug)]
pub struct PatchRun {
    /// The run, with an interface for each patch.
    pub run: Run<PatchStructure>,
    /// The cells of each patch.
    pub cells: Vec<Vec<CellSummary>>,
    /// Relative errors by the modes left out, at most.
    pub truncation: f64,
}

/// `summary.json` of a run of a structure with patches.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PatchSummary {
    /// Numbers that runs of bars have too.
    #[serde(flatten)]
    pub summary: Summary,
    /// The cells of each interface.
    pub cells: Vec<CellCounts>,
    /// Displacement of each sensor at rest by all loads.
    pub static_displacements: Vec<SensorDisplacement>,
    /// The modes kept.
    pub truncation: Truncation,
}

/// Displacement of a sensor at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorDisplacement {
    /// Name of the sensor.
    pub sensor: String,
    /// Displacement along its direction \[m\]; motions that nothing holds stay out.
    pub displacement_m: f64,
}

/// Cells of an interface in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellCounts {
    /// Name of the interface.
    pub interface: String,
    /// Number of cells.
    pub cells: usize,
    /// Cells without contact at rest.
    pub open_at_rest: usize,
    /// Cells that are closed at rest and lose contact for a time.
    pub lose_contact: usize,
    /// Highest pressure of a cell \[Pa\].
    pub pressure_max_pa: f64,
    /// Longest time of a cell without contact \[s\].
    pub contact_lost_longest_s: f64,
}

impl CellCounts {
    fn new(interface: &str, cells: &[CellSummary]) -> Self {
        let most = |of: fn(&CellSummary) -> f64| cells.iter().map(of).fold(0.0, f64::max);
        Self {
            interface: interface.to_owned(),
            cells: cells.len(),
            open_at_rest: cells.iter().filter(|one| one.is_open_at_rest()).count(),
            lose_contact: cells.iter().filter(|one| one.loses_contact()).count(),
            pressure_max_pa: most(|one| one.pressure_max_pa),
            contact_lost_longest_s: most(|one| one.contact_lost_s),
        }
    }
}

/// Modes kept, and the errors by those left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truncation {
    /// Number of modes kept of each body.
    pub modes_per_body: Vec<usize>,
    /// Relative errors by the modes left out, at most.
    pub relative_error: f64,
    /// Treatment of the others.
    pub note: &'static str,
}

impl PatchRun {
    /// The summary of the run and its cells.
    pub fn summary(&self) -> PatchSummary {
        let structure = &self.run.assembly.structure;
        let counts = structure.patches.iter().zip(&self.cells);
        let sensors = self.run.assembly.sensors.iter().zip(&structure.static_displacements);
        let displacement = |(sensor, &displacement_m): (&crate::assemble::Sensor, &f64)| {
            let sensor = sensor.name.clone().unwrap_or_default();
            SensorDisplacement { sensor, displacement_m }
        };
        PatchSummary {
            static_displacements: sensors.map(displacement).collect(),
            summary: self.run.summary.clone(),
            cells: counts.map(|(patch, cells)| CellCounts::new(&patch.name, cells)).collect(),
            truncation: Truncation {
                modes_per_body: structure.modes_per_body.clone(),
                relative_error: self.truncation,
                note: "flexibility of the modes left out is kept, their inertia is not; accelerations converge slowest",
            },
        }
    }

    /// `cells.csv`: a row for each cell.
    pub fn cells_table(&self) -> DataTable {
        let patches = self.run.assembly.structure.patches.iter().zip(&self.cells);
        let all: Vec<(&str, &CellSummary)> = patches
            .flat_map(|(patch, cells)| cells.iter().map(|cell| (patch.name.as_str(), cell)))
            .collect();
        let of = |value: fn(&CellSummary) -> f64| -> Vec<f64> {
            all.iter().map(|(_, cell)| value(cell)).collect()
        };
        DataTable::new()
            .texts("interface", all.iter().map(|(patch, _)| *patch))
            .texts("cell", all.iter().map(|(_, cell)| cell.cell.as_str()))
            .with("area_m2", of(|one| one.area_m2))
            .with("pressure_at_rest_pa", of(|one| one.pressure_pa))
            .with("gap_at_rest_m", of(|one| one.gap_m))
            .with("pressure_min_pa", of(|one| one.pressure_min_pa))
            .with("pressure_max_pa", of(|one| one.pressure_max_pa))
            .with("contact_lost_s", of(|one| one.contact_lost_s))
    }
}

/// A cell at rest and over the run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellSummary {
    /// Name of the cell.
    pub cell: String,
    /// Area \[m2\].
    pub area_m2: f64,
    /// Pressure at rest \[Pa\].
    pub pressure_pa: f64,
    /// Distance from first contact at rest \[m\]; zero for a closed cell.
    pub gap_m: f64,
    /// Lowest pressure \[Pa\].
    pub pressure_min_pa: f64,
    /// Highest pressure \[Pa\].
    pub pressure_max_pa: f64,
    /// Time without contact \[s\].
    pub contact_lost_s: f64,
}

impl CellSummary {
    /// True for a cell without contact at rest.
    pub fn is_open_at_rest(&self) -> bool {
        self.gap_m > 0.0
    }

    /// True for a cell that is closed at rest and loses contact.
    pub fn loses_contact(&self) -> bool {
        !self.is_open_at_rest() && self.contact_lost_s > 0.0
    }

    fn new(name: &str, contact: &PreloadedContact, seen: &ContactExtremes) -> Self {
        Self {
            cell: name.to_owned(),
            area_m2: contact.area(),
            pressure_pa: contact.pressure(),
            gap_m: contact.gap(),
            pressure_min_pa: seen.pressure_min,
            pressure_max_pa: seen.pressure_max,
            contact_lost_s: seen.lost,
        }
    }
}

/// Carries out the run that `document` describes; `progress` receives the fraction done.
///
/// # Errors
/// [`SimulationError`] when the structure cannot be assembled or the run fails.
pub fn simulate_patches(
    document: &Document,
    scenario: &StructureScenario,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<PatchRun, SimulationError> {
    simulate_patches_unless(document, scenario, &AtomicBool::new(false), progress)
}

/// As [`simulate_patches`]; once `stop` is set, a response ends before its next sample.
///
/// # Errors
/// Those of [`simulate_patches`], and [`DynamicsError::Stopped`].
pub fn simulate_patches_unless(
    document: &Document,
    scenario: &StructureScenario,
    stop: &AtomicBool,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<PatchRun, SimulationError> {
    let started = Instant::now();
    let folder = document.folder();
    let assembly = info_span!("assemble").in_scope(|| assemble_patches(scenario, folder))?;
    progress(0.3);
    let system = PatchSystem::new(assembly)?;
    let RefinedPatchResponse { response, truncation, .. } = system.refined(stop, progress)?;
    let PatchResponse { transient, cells, observables } = response;
    let PatchSystem { assembly, .. } = system;
    for warning in &observables.warnings {
        tracing::warn!("{warning}");
    }
    let numerics = Numerics {
        method: "many_contacts",
        step_s: transient.step,
        steps: transient.steps,
        modes_per_body: Some(assembly.structure.modes_per_body.clone()),
        instructions: "scalar".to_owned(),
        wall_s: started.elapsed().as_secs_f64(),
    };
    let provenance = Provenance::of_structure(document, scenario)?;
    let (title, at_rest) = (scenario.title.clone(), assembly.structure.at_rest());
    let summary = Summary::new(title, &assembly, at_rest, &observables, numerics, provenance);
    let contacts = assembly.structure.structure.contacts();
    let patches = assembly.structure.patches.iter();
    let of_patch = |patch: &super::Patch| {
        let names = patch.cell_names.iter().zip(patch.cells.clone());
        names.map(|(name, i)| CellSummary::new(name, &contacts[i], &cells[i])).collect()
    };
    let cells = patches.map(of_patch).collect();
    progress(1.0);
    Ok(PatchRun { run: Run { assembly, transient, observables, summary }, cells, truncation })
}

/// A structure at rest with its force, ready for steps of time.
#[derive(Debug, Clone)]
pub struct PatchSystem {
    /// The structure, the force and the sampling.
    pub assembly: Assembly<PatchStructure>,
    system: ManyContacts,
}

/// A response of a structure with patches.
#[derive(Debug)]
pub struct PatchResponse {
    /// Motions, with an interface for each patch.
    pub transient: Transient,
    /// Extremes of each cell, and of the springs after them.
    pub cells: Vec<ContactExtremes>,
    /// Its observables.
    pub observables: Observables,
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
        let system = system(&assembly, Arc::clone(&assembly.structure.structure))?;
        Ok(Self { assembly, system })
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
        let (transient, cells) = system.integrate_groups_unless(load, sampling, parts, stop)?;
        let at_rest = structure.at_rest();
        let observables = Observables::of_transient(&self.assembly, &at_rest, &transient)?;
        Ok(PatchResponse { transient, cells, observables })
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
            asperity_structure::Damping::Rate(structure.damping_rate()),
        )?;
        let system = system(&self.assembly, Arc::new(fewer))?;
        let other = self.response_of(&system, parts, stop)?.observables;
        Ok(ErrorEstimate::new(found.observables.all(), other.all(), 1.0, accuracy))
    }

    /// Lowest and highest pressure \[Pa\] of the cells of each patch in a response.
    pub fn pressures(&self, response: &PatchResponse) -> Vec<[f64; 2]> {
        let of = |patch: &super::Patch| {
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
        let (history, rate) = (&self.transient.history, self.rate());
        let unknown = Complex64::new(f64::NAN, f64::NAN);
        let at = |frequency| receptance_of(history, rate, &[frequency]).pop().unwrap_or(unknown);
        frequencies.iter().copied().map(at).collect()
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

/// The system that time integration steps, with an interface for each patch.
pub(super) fn system(
    assembly: &Assembly<PatchStructure>,
    structure: Arc<PreloadedStructure<asperity_mesh::ComponentModes>>,
) -> Result<ManyContacts, SimulationError> {
    let PatchStructure { patches, load, sensors, .. } = &assembly.structure;
    let groups = patches.iter().map(|patch| patch.cells.clone()).collect();
    Ok(ManyContacts::new(structure, *load, sensors.clone())?.with_groups(groups))
}
