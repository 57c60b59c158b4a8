//! Instants and cells of a run that are recorded beside its history.

use asperity_dynamics::Sampling;
use asperity_scenario::{JsonPointer, StructureScenario};

use super::ports::Patch;
use super::structure::PatchStructure;
use crate::assemble::Assembly;
use crate::error::SimulationError;

/// Instants in the first period where none are asked for.
const DEFAULT_INSTANTS: usize = 6;

/// Most samples of all cells together that are recorded, 1.2 GB.
const MOST_SAMPLES: usize = 50_000_000;

/// Samples at which the state is kept, and contacts that are recorded over time.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Recording {
    pub(super) samples: Vec<usize>,
    pub(super) contacts: Vec<usize>,
}

impl Recording {
    /// The instants and cells that `scenario` asks for.
    ///
    /// # Errors
    /// [`SimulationError::Model`] for instants outside of the response, for interfaces and cells that do not exist, and for more samples
    /// of cells than are recorded.
    pub(super) fn new(
        scenario: &StructureScenario,
        assembly: &Assembly<PatchStructure>,
    ) -> Result<Self, SimulationError> {
        let samples = match &scenario.output.instants_s {
            Some(instants) => samples_at(instants, &assembly.sampling)?,
            None => first_period(assembly),
        };
        let contacts = contacts(scenario, &assembly.structure)?;
        let recorded = contacts.len().saturating_mul(assembly.sampling.samples());
        if recorded > MOST_SAMPLES {
            // A choice of ours refuses no scenario.
            if scenario.output.cells.is_empty() {
                return Ok(Self { samples, contacts: Vec::new() });
            }
            return Err(SimulationError::model(
                "/output/cells",
                format!("{} cells over time have {recorded} samples", contacts.len()),
                format!("at most {MOST_SAMPLES} samples; name fewer cells"),
            ));
        }
        Ok(Self { samples, contacts })
    }
}

/// Samples nearest to these times \[s\].
fn samples_at(instants: &[f64], sampling: &Sampling) -> Result<Vec<usize>, SimulationError> {
    let last = sampling.samples() - 1;
    let sample = |(number, time): (usize, &f64)| {
        let sample = (time * sampling.rate()).round();
        if sample <= last as f64 {
            return Ok(sample as usize);
        }
        let end = last as f64 * sampling.interval();
        Err(SimulationError::model(
            &format!("/output/instants_s/{number}"),
            format!("the response ends before {time} s"),
            format!("times from 0 to {end} s, the last sample"),
        ))
    };
    instants.iter().enumerate().map(sample).collect()
}

/// Instants that divide the first period of the lowest natural frequency, or a response that is shorter.
fn first_period(assembly: &Assembly<PatchStructure>) -> Vec<usize> {
    let last = assembly.sampling.samples() - 1;
    let natural = assembly.structure.structure.natural_frequency();
    let period = natural.map_or(f64::INFINITY, |hz| assembly.sampling.rate() / hz);
    let period = period.min(last as f64);
    let part = |k: usize| (k as f64 * period / DEFAULT_INSTANTS as f64).round() as usize;
    (1..=DEFAULT_INSTANTS).map(part).collect()
}

/// Place of the cells of an interface in the scenario.
fn cells_of(interface: &str) -> JsonPointer {
    JsonPointer::root().child("output").child("cells").child(interface)
}

fn contacts(
    scenario: &StructureScenario,
    structure: &PatchStructure,
) -> Result<Vec<usize>, SimulationError> {
    let asked = &scenario.output.cells;
    let names = || structure.patches.iter().map(|patch| patch.name.as_str());
    if let Some(name) = asked.keys().find(|&name| names().all(|one| one != name)) {
        return Err(SimulationError::model(
            &cells_of(name).to_string(),
            format!("there is no interface \"{name}\""),
            names().collect::<Vec<_>>().join(", "),
        ));
    }
    let mut contacts = Vec::new();
    for patch in &structure.patches {
        let Some(cells) = asked.get(&patch.name) else {
            contacts.extend(extremes(structure, patch));
            continue;
        };
        for (number, cell) in cells.iter().enumerate() {
            let Some(place) = patch.cell_names.iter().position(|name| name == cell) else {
                let (first, last) = (patch.cell_names.first(), patch.cell_names.last());
                return Err(SimulationError::model(
                    &cells_of(&patch.name).child(number).to_string(),
                    format!("\"{}\" has no cell \"{cell}\"", patch.name),
                    format!(
                        "one of its {} cells, from \"{}\" to \"{}\"",
                        patch.cells.len(),
                        first.map_or("", String::as_str),
                        last.map_or("", String::as_str)
                    ),
                ));
            };
            let contact = patch.cells.start + place;
            if !contacts.contains(&contact) {
                contacts.push(contact);
            }
        }
    }
    Ok(contacts)
}

/// The cells of the highest and of the lowest pressure at rest, of those the first; none of a single cell, which is its patch.
fn extremes(structure: &PatchStructure, patch: &Patch) -> Vec<usize> {
    let pressure = |i: &usize| structure.structure.contacts()[*i].pressure();
    let highest = patch.cells.clone().rev().max_by(|a, b| pressure(a).total_cmp(&pressure(b)));
    let lowest = patch.cells.clone().min_by(|a, b| pressure(a).total_cmp(&pressure(b)));
    match (highest, lowest) {
        (Some(highest), Some(lowest)) if highest != lowest => vec![highest, lowest],
        _ => Vec::new(),
    }
}
