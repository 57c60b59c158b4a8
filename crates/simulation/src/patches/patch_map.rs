//! Maps of contact patches: where cells are, with their pressures and gaps.

use std::path::Path;

use asperity_dynamics::ContactsState;
use asperity_matrices::{ContactCell, Deck, VtuGrid};
use asperity_scenario::{PatchSpec, StructureScenario};

use super::body::read_deck;
use super::ports::Patch;
use super::structure::PatchStructure;
use crate::error::SimulationError;

/// A patch with the places of its cells.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchMap {
    /// Name of the interface.
    pub name: String,
    /// Its cells.
    pub cells: Vec<CellPlace>,
}

/// A cell, its place and its state.
#[derive(Debug, Clone, PartialEq)]
pub struct CellPlace {
    /// Polygons that cover the cell \[m\]; its centre alone for a cell of a file.
    pub polygons: Vec<Vec<[f64; 3]>>,
    /// Area \[m2\].
    pub area_m2: f64,
    /// Pressure \[Pa\].
    pub pressure_pa: f64,
    /// Distance from first contact \[m\]; zero for a closed cell.
    pub gap_m: f64,
}

impl PatchMap {
    /// The map of a patch at an instant.
    pub(super) fn at(&self, patch: &Patch, state: &ContactsState) -> Self {
        let cells = self.cells.iter().zip(patch.cells.clone()).map(|(cell, i)| CellPlace {
            pressure_pa: state.pressures[i],
            gap_m: state.gaps[i],
            ..cell.clone()
        });
        Self { name: self.name.clone(), cells: cells.collect() }
    }
}

/// Maps at rest of the patches whose cells have places: those between surfaces, and those of files whose bodies have a mesh, at the
/// mean place of their nodes. The files of `scenario` are looked for in `folder`.
///
/// # Errors
/// [`SimulationError::Matrices`] for files that cannot be read.
pub fn patch_maps(
    scenario: &StructureScenario,
    structure: &PatchStructure,
    folder: &Path,
) -> Result<Vec<PatchMap>, SimulationError> {
    let mut maps = Vec::new();
    for (spec, patch) in scenario.interfaces.iter().zip(&structure.patches) {
        let polygons = match &spec.cells {
            Some(file) => centres(scenario, spec, file, folder)?,
            None => patch.outlines.clone(),
        };
        let contacts = &structure.structure.contacts()[patch.cells.clone()];
        if polygons.len() != contacts.len() {
            continue;
        }
        let place = |(polygons, contact): (_, &asperity_structure::PreloadedContact)| CellPlace {
            polygons,
            area_m2: contact.area(),
            pressure_pa: contact.pressure(),
            gap_m: contact.gap(),
        };
        let cells = polygons.into_iter().zip(contacts).map(place).collect();
        maps.push(PatchMap { name: patch.name.clone(), cells });
    }
    Ok(maps)
}

/// Centres of the cells of a file: means of their nodes with the magnitudes of their weights. None without a mesh.
fn centres(
    scenario: &StructureScenario,
    spec: &PatchSpec,
    file: &str,
    folder: &Path,
) -> Result<Vec<Vec<Vec<[f64; 3]>>>, SimulationError> {
    let mut decks: Vec<(&str, Deck)> = Vec::new();
    for body in &scenario.bodies {
        if let Some(deck) = read_deck(body, folder)? {
            decks.push((&body.name, deck));
        }
    }
    let centre = |cell: &ContactCell| {
        let (mut sum, mut place) = (0.0, [0.0; 3]);
        for weight in &cell.weights {
            let body = weight.body.as_ref().or(spec.body.as_ref())?;
            let (_, deck) = decks.iter().find(|(name, _)| name == body)?;
            let node = deck.nodes().get(weight.dof.node)?;
            sum += weight.weight.abs();
            place = [0, 1, 2].map(|k| place[k] + weight.weight.abs() * node[k]);
        }
        Some(vec![vec![place.map(|x| x / sum)]])
    };
    let cells = asperity_matrices::read_cells(&folder.join(file))?;
    Ok(cells.iter().map(centre).collect::<Option<Vec<_>>>().unwrap_or_default())
}

/// The cells of all maps as a grid of `ParaView`, with their pressures, gaps and areas, and the numbers of cells and
/// interfaces. None without cells.
pub fn patch_grid(maps: &[PatchMap]) -> Option<String> {
    let mut grid = VtuGrid::default();
    let names = ["pressure_pa", "gap_m", "area_m2", "cell", "interface"];
    let mut numbers = names.map(|name| (name, Vec::new()));
    for (interface, map) in maps.iter().enumerate() {
        for (number, cell) in map.cells.iter().enumerate() {
            for polygon in &cell.polygons {
                grid.add_polygon(polygon);
                let CellPlace { pressure_pa, gap_m, area_m2, .. } = *cell;
                let values = [pressure_pa, gap_m, area_m2, number as f64, interface as f64];
                for ((_, column), value) in numbers.iter_mut().zip(values) {
                    column.push(value);
                }
            }
        }
    }
    (!numbers[0].1.is_empty()).then(|| grid.to_text(&[], &numbers))
}
