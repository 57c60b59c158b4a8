//! Transient runs of structures with contact patches, and their results.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use asperity_dynamics::{ContactExtremes, ContactsState, InterfaceHistory};
use asperity_scenario::{Document, StructureScenario};
use asperity_structure::PreloadedContact;
use asperity_table::{DataTable, columns_to_csv};
use serde::Serialize;
use tracing::info_span;

use super::recording::Recording;
use super::structure::{PatchStructure, assemble_patches};
use super::system::{PatchResponse, PatchSystem, RefinedPatchResponse};
use crate::error::SimulationError;
use crate::provenance::Provenance;
use crate::run::Run;
use crate::summary::{Numerics, Summary};

/// A finished run of a structure with patches.
#[derive(Debug)]
pub struct PatchRun {
    /// The run, with an interface for each patch.
    pub run: Run<PatchStructure>,
    /// The cells of each patch.
    pub cells: Vec<Vec<CellSummary>>,
    /// Relative errors by the modes left out, at most.
    pub truncation: f64,
    /// States at the instants that the scenario asks for.
    pub states: Vec<ContactsState>,
    /// The cells that the scenario asks for over time.
    pub cell_histories: Vec<CellHistory>,
}

/// A cell over time.
#[derive(Debug, Clone, PartialEq)]
pub struct CellHistory {
    /// Name of the interface.
    pub interface: String,
    /// Name of the cell.
    pub cell: String,
    /// Its pressure, closure and stiffness at the samples of the response.
    pub history: InterfaceHistory,
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

    /// Columns of `cells-history.csv`, with their names: the time, and pressure, closure and stiffness of the cells that are
    /// recorded; none without such cells.
    pub fn cell_history_columns(&self) -> Vec<(String, &[f64])> {
        let mut columns: Vec<(String, &[f64])> = Vec::new();
        if !self.cell_histories.is_empty() {
            columns.push(("time_s".to_owned(), &self.run.transient.history.time));
        }
        for CellHistory { interface, cell, history } in &self.cell_histories {
            let name = |quantity: &str| format!("{interface}:{cell}:{quantity}");
            columns.push((name("pressure_pa"), &history.pressure));
            columns.push((name("closure_m"), &history.closure));
            columns.push((name("stiffness_pa_per_m"), &history.stiffness));
        }
        columns
    }

    /// `cells-history.csv`: a row per output sample; none without cells that are recorded.
    pub fn cell_history_csv(&self) -> Option<String> {
        let columns = self.cell_history_columns();
        let named = columns.iter().map(|(name, column)| (name.as_str(), *column));
        (!columns.is_empty()).then(|| columns_to_csv(named))
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
/// Those of [`simulate_patches`], and [`DynamicsError::Stopped`](asperity_dynamics::DynamicsError::Stopped).
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
    let recording = Recording::new(scenario, &assembly)?;
    let system = PatchSystem::recorded(assembly, recording)?;
    let RefinedPatchResponse { response, truncation, .. } = system.refined(stop, progress)?;
    let PatchResponse { mut transient, readings, cells, observables, states, recorded } = response;
    transient.history = transient.history.every(readings);
    let PatchSystem { assembly, recording, .. } = system;
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
    let named = |(&contact, history): (&usize, InterfaceHistory)| {
        let mut patches = assembly.structure.patches.iter();
        let patch = patches.find(|patch| patch.cells.contains(&contact))?;
        let cell = patch.cell_names[contact - patch.cells.start].clone();
        Some(CellHistory { interface: patch.name.clone(), cell, history: history.every(readings) })
    };
    let cell_histories = recording.contacts.iter().zip(recorded).filter_map(named).collect();
    progress(1.0);
    let run = Run { assembly, transient, observables, summary };
    Ok(PatchRun { run, cells, truncation, states, cell_histories })
}
