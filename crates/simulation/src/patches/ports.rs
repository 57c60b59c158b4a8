//! Ports of a structure of matrices: cells of patches, loads, the excitation and sensors.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use asperity_law::{ContactLaw, LawError};
use asperity_matrices::{
    ContactCell, ContactSurface, Deck, MatricesError, PatchSplit, SurfaceCells,
};
use asperity_mesh::{PortPair, PortPattern};
use asperity_scenario::{
    Along, ExcitationSpec, MatrixBodySpec, PatchSpec, PlaceSpec, SplitSpec, StaticLoadSpec,
    StructureScenario, SurfaceSpec,
};
use asperity_structure::UnloadedContact;

use super::body::{Body, read_deck};
use crate::error::SimulationError;
use crate::shared_laws::shared_law;

/// Most cells of a structure.
const MOST_CELLS: usize = asperity_dynamics::MOST_CONTACTS;

/// Pressure for which laws are built that depend on one \[Pa\].
const LAW_PRESSURE: f64 = 1e5;

/// A contact patch.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Name of the interface.
    pub name: String,
    /// Contacts of the structure that are its cells.
    pub cells: Range<usize>,
    /// Names of the cells.
    pub cell_names: Vec<String>,
    /// Polygons that cover each cell \[m\]; none for cells of a file.
    pub outlines: Vec<Vec<Vec<[f64; 3]>>>,
}

/// Ports of a structure, and what acts at them. Without bodies read, where their reduction is known, the patterns
/// are empty.
pub(super) struct Ports<'a> {
    names: Vec<&'a str>,
    /// The mesh of each body, where it was read.
    pub(super) decks: Vec<Option<Deck>>,
    pub(super) bodies: Vec<Body>,
    /// Body and pattern of each port.
    pub(super) patterns: Vec<(usize, PortPattern)>,
    pub(super) pairs: Vec<PortPair>,
    pub(super) contacts: Vec<UnloadedContact>,
    pub(super) patches: Vec<Patch>,
    /// Port and factor of each static load.
    pub(super) loads: Vec<(usize, f64)>,
    pub(super) load: usize,
    pub(super) sensors: Vec<usize>,
}

impl<'a> Ports<'a> {
    /// The ports of `scenario`, with the files of its bodies if `whole`.
    pub(super) fn read(
        scenario: &'a StructureScenario,
        folder: &Path,
        whole: bool,
    ) -> Result<Self, SimulationError> {
        // Surfaces of patches are read with every run.
        let is_side = |name: &str| {
            let patches = scenario.interfaces.iter();
            let mut sides = patches.flat_map(|patch| patch.above.iter().chain(&patch.below));
            sides.any(|side| side.body == name)
        };
        let deck = |spec: &MatrixBodySpec| {
            if whole || is_side(&spec.name) { read_deck(spec, folder) } else { Ok(None) }
        };
        let decks = scenario.bodies.iter().map(deck).collect::<Result<Vec<_>, _>>()?;
        let specs = scenario.bodies.iter().zip(&decks).filter(|_| whole);
        let read = |(spec, deck): (_, &Option<Deck>)| Body::read(spec, folder, deck.as_ref());
        let bodies = specs.map(read).collect::<Result<Vec<_>, _>>()?;
        let mut ports = Self {
            names: scenario.bodies.iter().map(|body| body.name.as_str()).collect(),
            decks,
            bodies,
            patterns: Vec::new(),
            pairs: Vec::new(),
            contacts: Vec::new(),
            patches: Vec::new(),
            loads: Vec::new(),
            load: 0,
            sensors: Vec::new(),
        };
        for (number, patch) in scenario.interfaces.iter().enumerate() {
            ports.add_patch(scenario, patch, number, folder)?;
        }
        if scenario.gravity_m_per_s2 != [0.0; 3] {
            for body in 0..ports.names.len() {
                let nodes = ports.decks[body].as_ref().map(Deck::nodes);
                let weight = ports.bodies.get(body).map(|Body { matrices, .. }| {
                    let forces = matrices.gravity_loads(scenario.gravity_m_per_s2, nodes);
                    let acting = forces.into_iter().enumerate().filter(|(_, force)| *force != 0.0);
                    acting.collect()
                });
                let port = ports.add(body, weight.unwrap_or_default());
                ports.loads.push((port, 1.0));
            }
        }
        for (number, load) in scenario.loads.iter().enumerate() {
            ports.add_load(load, number, folder)?;
        }
        ports.load = match scenario.excitation.at() {
            Some(at) => ports.add_place(at, "/excitation/at")?,
            None if matches!(scenario.excitation, ExcitationSpec::None) => {
                // No force acts; the first sensor's port stands in for one.
                ports.add_sensor(scenario, 0)?
            }
            None => {
                let accepted = "{\"body\": NAME, \"node\": NUMBER, \"direction\": [x, y, z]}";
                return Err(SimulationError::model(
                    "/excitation",
                    "the force has no place \"at\"",
                    accepted,
                ));
            }
        };
        for number in 0..scenario.sensors.len() {
            let port = ports.add_sensor(scenario, number)?;
            ports.sensors.push(port);
        }
        Ok(ports)
    }

    fn add(&mut self, body: usize, pattern: PortPattern) -> usize {
        self.patterns.push((body, pattern));
        self.patterns.len() - 1
    }

    /// The mesh of a body.
    fn deck(&self, body: usize, place: &str) -> Result<&Deck, SimulationError> {
        self.decks[body].as_ref().ok_or_else(|| {
            let problem =
                format!("body \"{}\" has no mesh with sets and surfaces", self.names[body]);
            SimulationError::model(place, problem, "a body with \"mesh\"")
        })
    }

    /// Nodes of a set of a body.
    fn set(&self, body: usize, set: &str, place: &str) -> Result<Vec<i64>, SimulationError> {
        let place = format!("{place}/set");
        let nodes = self.deck(body, &place)?.node_set(set)?.to_vec();
        if nodes.is_empty() {
            return Err(SimulationError::model(&place, "the set has no nodes", "a set of nodes"));
        }
        Ok(nodes)
    }

    /// Numbers of the ports of a body.
    pub(super) fn of(&self, body: usize) -> Vec<usize> {
        (0..self.patterns.len()).filter(|&port| self.patterns[port].0 == body).collect()
    }

    fn body(&self, name: &str, place: &str) -> Result<usize, SimulationError> {
        self.names.iter().position(|known| *known == name).ok_or_else(|| {
            let problem = format!("no body is named \"{name}\"");
            SimulationError::model(place, problem, self.names.join(", "))
        })
    }

    fn add_sensor(
        &mut self,
        scenario: &StructureScenario,
        number: usize,
    ) -> Result<usize, SimulationError> {
        let place = format!("/sensors/{number}/at");
        let at = scenario.sensors.get(number).and_then(|sensor| sensor.at.as_ref());
        let accepted = "{\"body\": NAME, \"node\": NUMBER, \"direction\": [x, y, z]}";
        let at =
            at.ok_or_else(|| SimulationError::model(&place, "the sensor has no place", accepted))?;
        self.add_place(at, &place)
    }

    fn add_place(&mut self, at: &PlaceSpec, place: &str) -> Result<usize, SimulationError> {
        let body = self.body(&at.body, &format!("{place}/body"))?;
        let Along::Node { node, direction } = at.along else {
            let problem = "the place is one of a bar";
            return Err(SimulationError::model(
                place,
                problem,
                "node and direction of a body of matrices",
            ));
        };
        let along = |body: &Body| body.along(node, direction, place);
        let pattern = self.bodies.get(body).map(along).transpose()?;
        Ok(self.add(body, pattern.unwrap_or_default()))
    }

    fn add_load(
        &mut self,
        load: &StaticLoadSpec,
        number: usize,
        folder: &Path,
    ) -> Result<(), SimulationError> {
        let place = format!("/loads/{number}");
        let body = self.body(&load.body, &format!("{place}/body"))?;
        let owner = body;
        let (pattern, factor) = match load {
            StaticLoadSpec {
                file: Some(file),
                factor,
                node: None,
                set: None,
                direction: None,
                force_n: None,
                ..
            } => {
                let read = |read: &Body| {
                    let forces = asperity_matrices::read_loads(&folder.join(file))?;
                    let own = forces
                        .iter()
                        .filter(|one| one.body.as_ref().is_none_or(|name| *name == load.body));
                    let rows = own.map(|one| Ok((read.row(one.dof, &place)?, one.force_n)));
                    rows.collect::<Result<PortPattern, SimulationError>>()
                };
                let pattern = self.bodies.get(body).map(read).transpose()?;
                (pattern.unwrap_or_default(), factor.unwrap_or(1.0))
            }
            StaticLoadSpec {
                file: None,
                factor: None,
                direction: Some(direction),
                force_n: Some(force),
                node,
                set,
                ..
            } if node.is_some() != set.is_some() => {
                let spread = |body: &Body| {
                    let nodes = match (node, set) {
                        (Some(node), _) => vec![*node],
                        (None, set) => {
                            self.set(owner, set.as_deref().unwrap_or_default(), &place)?
                        }
                    };
                    let share = 1.0 / nodes.len() as f64;
                    let mut pattern = PortPattern::new();
                    for &node in &nodes {
                        let rows = body.along(node, *direction, &place)?;
                        pattern.extend(rows.into_iter().map(|(row, part)| (row, share * part)));
                    }
                    Ok::<_, SimulationError>(pattern)
                };
                let pattern = self.bodies.get(body).map(spread).transpose()?;
                (pattern.unwrap_or_default(), *force)
            }
            _ => {
                let accepted = "\"file\" with or without \"factor\", or \"node\" or \"set\" with \"direction\" and \"force_n\"";
                return Err(SimulationError::model(
                    &place,
                    "the load is given twice or not at all",
                    accepted,
                ));
            }
        };
        let port = self.add(body, pattern);
        self.loads.push((port, factor));
        Ok(())
    }

    fn add_patch(
        &mut self,
        scenario: &StructureScenario,
        patch: &PatchSpec,
        number: usize,
        folder: &Path,
    ) -> Result<(), SimulationError> {
        let place = format!("/interfaces/{number}");
        let law = shared_law(&scenario.laws, &patch.law, LAW_PRESSURE);
        let law: Arc<dyn ContactLaw> = law.map_err(|source: LawError| SimulationError::Law {
            law: patch.law.name().to_owned(),
            interface: Some(patch.name.clone()),
            pressure_pa: LAW_PRESSURE,
            source,
        })?;
        if !(law.domain().separates() || law.domain().is_bilateral()) {
            let problem =
                "the law never separates, so the faces have no first contact to count from";
            let accepted = "a law with a closure at zero pressure, or a constant stiffness";
            return Err(SimulationError::model(&format!("{place}/law"), problem, accepted));
        }
        let (cells, outlines) = self.cells(patch, &place, folder)?;
        let first = self.contacts.len();
        if first + cells.len() > MOST_CELLS {
            let problem = format!("{} cells in all", first + cells.len());
            let key = if patch.cells.is_some() { "cells" } else { "split" };
            let accepted =
                format!("at most {MOST_CELLS}; a grid such as \"split\": [12, 3] has few");
            return Err(SimulationError::model(&format!("{place}/{key}"), problem, accepted));
        }
        for cell in &cells {
            let pair = self.cell_pair(cell, patch, &place)?;
            self.pairs.push(pair);
            self.contacts.push(UnloadedContact {
                name: format!("{}, cell {}", patch.name, cell.name),
                area: cell.area_m2,
                law: Arc::clone(&law),
                gap: patch.initial_gap_m,
                damping: None,
            });
        }
        self.patches.push(Patch {
            name: patch.name.clone(),
            cells: first..self.contacts.len(),
            cell_names: cells.into_iter().map(|cell| cell.name).collect(),
            outlines,
        });
        Ok(())
    }

    /// The cells of a patch, from its file or between its surfaces, with polygons that cover them.
    #[expect(clippy::type_complexity, reason = "polygons of each cell")]
    fn cells(
        &self,
        patch: &PatchSpec,
        place: &str,
        folder: &Path,
    ) -> Result<(Vec<ContactCell>, Vec<Vec<Vec<[f64; 3]>>>), SimulationError> {
        let above = match patch {
            PatchSpec {
                cells: Some(file),
                above: None,
                below: None,
                split: None,
                along: None,
                ..
            } => {
                return Ok((asperity_matrices::read_cells(&folder.join(file))?, Vec::new()));
            }
            PatchSpec { cells: None, body: None, above: Some(above), .. } => above,
            _ => {
                let problem = "the cells are given twice or not at all";
                let accepted = "\"cells\", a file, with or without \"body\"; or \"above\" with or without \"below\", \"split\" and \"along\"";
                return Err(SimulationError::model(place, problem, accepted));
            }
        };
        let split = match patch.split {
            Some(SplitSpec::Grid(cells)) => PatchSplit::Grid { cells, along: patch.along },
            None | Some(SplitSpec::Faces(_)) if patch.along.is_none() => PatchSplit::Faces,
            _ => {
                let problem = "a direction without a grid";
                let accepted = "\"along\" beside \"split\": [columns, rows]";
                return Err(SimulationError::model(&format!("{place}/along"), problem, accepted));
            }
        };
        let upper = self.surface(above, &format!("{place}/above"))?;
        let lower = patch.below.as_ref();
        let lower = lower.map(|side| self.surface(side, &format!("{place}/below"))).transpose()?;
        let key = if lower.is_some() { "below" } else { "above" };
        let made = SurfaceCells::new(&upper, lower.as_ref(), split);
        let SurfaceCells { cells, outlines, surface_areas_m2, .. } =
            made.map_err(|error| at(&format!("{place}/{key}"), error))?;
        let area: f64 = cells.iter().map(|cell| cell.area_m2).sum();
        let [above, below] = surface_areas_m2;
        tracing::info!(
            interface = patch.name,
            cells = cells.len(),
            "contact area {area:.6e} m2 of surfaces of {above:.6e} m2 and {below:.6e} m2"
        );
        Ok((cells, outlines))
    }

    fn surface<'b>(
        &'b self,
        side: &'b SurfaceSpec,
        place: &str,
    ) -> Result<ContactSurface<'b>, SimulationError> {
        let body = self.body(&side.body, &format!("{place}/body"))?;
        let deck = self.deck(body, &format!("{place}/body"))?;
        let (key, found) = match (&side.surface, &side.set) {
            (Some(name), None) => {
                ("surface", ContactSurface::of_surface(deck, name, Some(&side.body)))
            }
            (None, Some(name)) => {
                ("set", ContactSurface::of_node_set(deck, name, Some(&side.body)))
            }
            _ => {
                let problem = "the surface is given twice or not at all";
                return Err(SimulationError::model(place, problem, "\"surface\" or \"set\""));
            }
        };
        found.map_err(|error| at(&format!("{place}/{key}"), error))
    }

    /// The closure of a cell: of one body a port of its own, of two the difference of two ports.
    fn cell_pair(
        &mut self,
        cell: &ContactCell,
        patch: &PatchSpec,
        place: &str,
    ) -> Result<PortPair, SimulationError> {
        let mut patterns: Vec<(usize, PortPattern)> = Vec::new();
        for weight in &cell.weights {
            let name = weight.body.as_ref().or(patch.body.as_ref()).ok_or_else(|| {
                let accepted = "\"body\" of the interface, or a column body in the file of cells";
                SimulationError::model(place, "the cells have no body", accepted)
            })?;
            let body = self.body(name, &format!("{place}/body"))?;
            let row = |body: &Body| body.row(weight.dof, &format!("{place}/cells"));
            let row = self.bodies.get(body).map(row).transpose()?.unwrap_or_default();
            match patterns.iter_mut().find(|(own, _)| *own == body) {
                Some((_, pattern)) => pattern.push((row, weight.weight)),
                None => patterns.push((body, vec![(row, weight.weight)])),
            }
        }
        let mut patterns = patterns.into_iter();
        match (patterns.next(), patterns.next(), patterns.next()) {
            (Some((body, pattern)), None, None) => Ok(PortPair::on_ground(self.add(body, pattern))),
            (Some((above, upper)), Some((below, lower)), None) => {
                let upper = self.add(above, upper);
                let negative = lower.into_iter().map(|(row, weight)| (row, -weight)).collect();
                Ok(PortPair::between(upper, self.add(below, negative)))
            }
            _ => {
                let problem = format!("cell {} joins more than two bodies", cell.name);
                Err(SimulationError::model(
                    &format!("{place}/cells"),
                    problem,
                    "cells of one or two bodies",
                ))
            }
        }
    }
}

/// A fault of a mesh with the place in the scenario that names it.
fn at(place: &str, error: MatricesError) -> SimulationError {
    match error {
        MatricesError::Inconsistent { what, remedy } => SimulationError::model(place, what, remedy),
        other => other.into(),
    }
}
