//! A structure of matrices at rest, from the files of its scenario.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use asperity_dynamics::{Integrator, Sampling};
use asperity_law::{ContactLaw, LawError};
use asperity_matrices::{
    ContactCell, Deck, Dof, Matrices, MatricesFormat, MatrixFiles, MatrixUnits,
};
use asperity_mesh::{ComponentModes, Port, PortPair, PortPattern, ReducedBody, SparseBody};
use asperity_scenario::{
    Along, DampingSpec, ExcitationSpec, MatricesFormatSpec, MatrixBodySpec, PatchSpec, PlaceSpec,
    StaticLoadSpec, StructureScenario,
};
use asperity_structure::{
    LoadCase, PreloadedContact, PreloadedStructure, StructureError, UnloadedContact,
    contacts_at_rest,
};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use tracing::info_span;

use super::kept_reduction::{self, FOLDER, ReductionKey};
use crate::accuracy::DEFAULT_ACCURACY;
use crate::assemble::{Assembly, Interfaces, Sensor, samples_of};
use crate::error::SimulationError;
use crate::shared_laws::shared_law;
use crate::static_state::{StaticInterface, StaticSummary};

/// Most cells of a structure.
const MOST_CELLS: usize = asperity_dynamics::MOST_CONTACTS;

/// Pressure for which laws are built that depend on one \[Pa\].
const LAW_PRESSURE: f64 = 1e5;

/// A structure of matrices at rest under its loads.
#[derive(Debug, Clone)]
pub struct PatchStructure {
    /// Its component modes, with a contact for each cell.
    pub structure: Arc<PreloadedStructure<ComponentModes>>,
    /// Its patches; their cells are ranges of the contacts.
    pub patches: Vec<Patch>,
    /// Each patch as one contact of its whole area at its mean pressure.
    interfaces: Vec<PreloadedContact>,
    /// Port of the excitation.
    pub load: usize,
    /// Ports of the sensors.
    pub sensors: Vec<usize>,
    /// Number of modes kept of each body.
    pub modes_per_body: Vec<usize>,
    /// Number of motions without stiffness before contact, of each body.
    pub rigid_motions: Vec<usize>,
}

/// A contact patch.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Name of the interface.
    pub name: String,
    /// Contacts of the structure that are its cells.
    pub cells: Range<usize>,
    /// Names of the cells.
    pub cell_names: Vec<String>,
}

impl Interfaces for PatchStructure {
    /// Each patch as one contact of its whole area at its mean pressure.
    fn interfaces(&self) -> &[PreloadedContact] {
        &self.interfaces
    }
}

impl PatchStructure {
    /// The state at rest: mean pressure, stiffness and closure of each patch.
    pub fn at_rest(&self) -> StaticSummary {
        let contacts = self.structure.contacts();
        let interface = |(patch, whole): (&Patch, &PreloadedContact)| {
            let cells = &contacts[patch.cells.clone()];
            let mean = |of: &dyn Fn(&PreloadedContact) -> f64| {
                cells.iter().map(|cell| cell.area() * of(cell)).sum::<f64>() / whole.area()
            };
            StaticInterface {
                name: patch.name.clone(),
                pressure_pa: mean(&PreloadedContact::pressure),
                stiffness_pa_per_m: mean(&PreloadedContact::stiffness),
                closure_m: mean(&PreloadedContact::closure),
            }
        };
        StaticSummary {
            natural_frequency_hz: self.structure.natural_frequency(),
            interfaces: self.patches.iter().zip(&self.interfaces).map(interface).collect(),
        }
    }
}

/// Assembles the structure of `scenario`; its files are looked for in `folder`.
///
/// # Errors
/// [`SimulationError::Matrices`] for files that cannot be read; [`SimulationError::Model`] for places, bodies and
/// directions that do not exist; [`SimulationError::Structure`] without static equilibrium.
pub fn assemble_patches(
    scenario: &StructureScenario,
    folder: &Path,
) -> Result<Assembly<PatchStructure>, SimulationError> {
    let (damping, internal) = scenario.damping.of_bodies()?;
    if !matches!(scenario.damping, DampingSpec::MassProportional(_) | DampingSpec::Rayleigh(_)) {
        return Err(model(
            "/damping",
            "the kind is not one of a structure of matrices",
            "mass_proportional or rayleigh",
        ));
    }
    let time = internal.retardation_time().unwrap_or(0.0);
    let key = ReductionKey::new(folder, scenario)?;
    // The files of a kept reduction were checked when it was made.
    let (ports, reduced) = if let Some(found) = kept_reduction::find(folder, &key) {
        (Ports::new(scenario, folder, Vec::new())?, found)
    } else {
        let bodies = info_span!("read matrices").in_scope(|| {
            let read = |body| Body::read(body, folder);
            scenario.bodies.iter().map(read).collect::<Result<Vec<_>, _>>()
        })?;
        let ports = Ports::new(scenario, folder, bodies)?;
        let made = info_span!("reduce").in_scope(|| reduced_bodies(scenario, &ports))?;
        kept_reduction::keep(folder, &key, &made);
        (ports, made)
    };
    let count = ports.patterns.len();
    let own: Vec<Vec<usize>> = (0..scenario.bodies.len()).map(|body| ports.of(body)).collect();
    let fits = |(body, own): (&ReducedBody, &Vec<usize>)| body.residual.ports() == own.len();
    if reduced.len() != own.len() || !reduced.iter().zip(&own).all(fits) {
        let problem = "the kept reduction is not one of this structure";
        return Err(model("/bodies", problem, format!("a folder {FOLDER} that is removed")));
    }
    let joined: Vec<(&ReducedBody, &[usize])> =
        reduced.iter().zip(&own).map(|(body, own)| (body, own.as_slice())).collect();
    let modes = ReducedBody::joined(&joined, count, time, ports.pairs.clone());
    let modes = modes.map_err(StructureError::from)?;
    let contacts = contacts_at_rest(&modes, &ports.contacts, &ports.loads)?;
    let modes_per_body = reduced.iter().map(|body| body.angular_frequencies.len()).collect();
    let rigid_motions = reduced.iter().map(ReducedBody::rigid_count).collect();
    let structure = PreloadedStructure::of_components(modes, contacts, damping)?;
    let interfaces = ports.patches.iter().map(|patch| whole(patch, structure.contacts()));
    let structure = PatchStructure {
        interfaces: interfaces.collect::<Result<_, _>>()?,
        structure: Arc::new(structure),
        patches: ports.patches,
        load: ports.load,
        sensors: ports.sensors,
        modes_per_body,
        rigid_motions,
    };
    let named = |(spec, &port): (&asperity_scenario::SensorSpec, &usize)| Sensor {
        name: Some(spec.name.clone()),
        port: Port::Number(port),
        kind: spec.kind,
    };
    Ok(Assembly {
        load: load_case(scenario, structure.load, folder)?,
        sensors: scenario.sensors.iter().zip(&structure.sensors).map(named).collect(),
        structure,
        sampling: Sampling::new(scenario.duration_s, scenario.output_rate_hz)?,
        method: Integrator::default(),
        accuracy: scenario.accuracy.unwrap_or(DEFAULT_ACCURACY),
    })
}

/// The bodies in their modes, with the flexibility at their ports.
fn reduced_bodies(
    scenario: &StructureScenario,
    ports: &Ports<'_>,
) -> Result<Vec<ReducedBody>, SimulationError> {
    let reduce = |(number, body): (usize, &Body)| {
        let own = ports.of(number).into_iter();
        let patterns: Vec<PortPattern> = own.map(|port| ports.patterns[port].1.clone()).collect();
        let matrices = &body.matrices;
        let (stiffness, mass) = (sparse(matrices.stiffness()), sparse(matrices.mass()));
        let body = SparseBody::new(stiffness, mass, body.places()).map_err(StructureError::from)?;
        let modes = scenario.bodies[number].reduction.modes;
        Ok(ReducedBody::new(&body, &patterns, modes).map_err(StructureError::from)?)
    };
    ports.bodies.iter().enumerate().map(reduce).collect()
}

/// A patch as one contact of its whole area at its mean pressure.
fn whole(
    patch: &Patch,
    contacts: &[PreloadedContact],
) -> Result<PreloadedContact, SimulationError> {
    let cells = &contacts[patch.cells.clone()];
    let area: f64 = cells.iter().map(PreloadedContact::area).sum();
    let force: f64 = cells.iter().map(|cell| cell.area() * cell.pressure()).sum();
    Ok(PreloadedContact::new(&patch.name, area, Arc::clone(cells[0].law()), force / area)?)
}

fn load_case(
    scenario: &StructureScenario,
    port: usize,
    folder: &Path,
) -> Result<LoadCase, SimulationError> {
    if matches!(scenario.excitation, ExcitationSpec::BaseMotion { .. }) {
        let problem = "a motion of the base is not taken by structures of matrices";
        return Err(model("/excitation/kind", problem, "a force at a node"));
    }
    let load =
        scenario.excitation.load_case_at(Port::Number(port), |file| samples_of(file, folder))?;
    load.check()?;
    Ok(load)
}

fn model(place: &str, problem: impl Into<String>, accepted: impl Into<String>) -> SimulationError {
    SimulationError::Model {
        place: place.to_owned(),
        problem: problem.into(),
        accepted: accepted.into(),
    }
}

/// A body as its files have it.
struct Body {
    name: String,
    matrices: Matrices,
    deck: Option<Deck>,
}

impl Body {
    fn read(spec: &MatrixBodySpec, folder: &Path) -> Result<Self, SimulationError> {
        let MatrixBodySpec { name, matrices, mesh, units, .. } = spec;
        let format = match matrices.format {
            MatricesFormatSpec::Calculix => MatricesFormat::Calculix,
            MatricesFormatSpec::Abaqus => MatricesFormat::Abaqus,
            MatricesFormatSpec::MatrixMarket => MatricesFormat::MatrixMarket,
            MatricesFormatSpec::Nastran => MatricesFormat::Nastran,
            MatricesFormatSpec::Matlab => MatricesFormat::Matlab,
            MatricesFormatSpec::Npz => MatricesFormat::Npz,
        };
        let at = |file: &String| folder.join(file);
        let mut read = asperity_matrices::read(&MatrixFiles {
            format,
            stiffness: at(&matrices.stiffness),
            mass: matrices.mass.as_ref().map(at),
            rows: matrices.rows.as_ref().map(at),
        })?;
        let mut deck = mesh.as_ref().map(|file| Deck::read(&at(file))).transpose()?;
        let units = MatrixUnits::new(units.length_m, units.mass_kg, units.time_s)?;
        read.convert(units);
        if let Some(deck) = &mut deck {
            deck.convert(units);
        }
        let findings = read.findings(deck.as_ref().map(Deck::nodes));
        if let Some(fault) = findings.iter().find(|finding| finding.is_fault) {
            let accepted = "matrices of a structure without contact";
            return Err(model("/bodies", format!("{name}: {fault}"), accepted));
        }
        for finding in &findings {
            tracing::info!(body = name, "{finding}");
        }
        Ok(Self { name: name.clone(), matrices: read, deck })
    }

    fn row(&self, dof: Dof, place: &str) -> Result<usize, SimulationError> {
        self.matrices.row(dof).ok_or_else(|| {
            let problem = format!("body \"{}\" has no row of {dof}", self.name);
            let accepted =
                "degrees of freedom that are in the matrices: neither held nor dependent";
            model(place, problem, accepted)
        })
    }

    /// Rows of a node along a direction.
    fn along(
        &self,
        node: i64,
        direction: [f64; 3],
        place: &str,
    ) -> Result<PortPattern, SimulationError> {
        let length = direction.iter().map(|part| part * part).sum::<f64>().sqrt();
        if !(length.is_finite() && length > 0.0) {
            let at = format!("{place}/direction");
            return Err(model(&at, "the direction has no length", "three numbers, not all zero"));
        }
        let parts = direction.iter().zip(1_u8..).filter(|(part, _)| **part != 0.0);
        let row =
            |(part, axis): (&f64, u8)| Ok((self.row(Dof::new(node, axis), place)?, part / length));
        parts.map(row).collect()
    }

    /// Nodes of a set.
    fn set(&self, set: &str, place: &str) -> Result<Vec<i64>, SimulationError> {
        let Some(deck) = &self.deck else {
            let problem = format!("body \"{}\" has no mesh with sets", self.name);
            return Err(model(&format!("{place}/set"), problem, "a body with \"mesh\""));
        };
        let nodes = deck.node_set(set)?.to_vec();
        if nodes.is_empty() {
            return Err(model(&format!("{place}/set"), "the set has no nodes", "a set of nodes"));
        }
        Ok(nodes)
    }

    fn places(&self) -> Vec<Option<[f64; 3]>> {
        let Some(deck) = &self.deck else { return Vec::new() };
        self.matrices.dofs().iter().map(|dof| deck.nodes().get(dof.node)).collect()
    }
}

/// Ports of a structure, and what acts at them. Without bodies read, where their reduction is known, the patterns
/// are empty.
struct Ports<'a> {
    names: Vec<&'a str>,
    bodies: Vec<Body>,
    /// Body and pattern of each port.
    patterns: Vec<(usize, PortPattern)>,
    pairs: Vec<PortPair>,
    contacts: Vec<UnloadedContact>,
    patches: Vec<Patch>,
    /// Port and factor of each static load.
    loads: Vec<(usize, f64)>,
    load: usize,
    sensors: Vec<usize>,
}

impl<'a> Ports<'a> {
    fn new(
        scenario: &'a StructureScenario,
        folder: &Path,
        bodies: Vec<Body>,
    ) -> Result<Self, SimulationError> {
        let mut ports = Self {
            names: scenario.bodies.iter().map(|body| body.name.as_str()).collect(),
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
                let weight = ports.bodies.get(body).map(|Body { matrices, deck, .. }| {
                    let nodes = deck.as_ref().map(Deck::nodes);
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
                return Err(model("/excitation", "the force has no place \"at\"", accepted));
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

    /// Numbers of the ports of a body.
    fn of(&self, body: usize) -> Vec<usize> {
        (0..self.patterns.len()).filter(|&port| self.patterns[port].0 == body).collect()
    }

    fn body(&self, name: &str, place: &str) -> Result<usize, SimulationError> {
        self.names.iter().position(|known| *known == name).ok_or_else(|| {
            let problem = format!("no body is named \"{name}\"");
            model(place, problem, self.names.join(", "))
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
        let at = at.ok_or_else(|| model(&place, "the sensor has no place", accepted))?;
        self.add_place(at, &place)
    }

    fn add_place(&mut self, at: &PlaceSpec, place: &str) -> Result<usize, SimulationError> {
        let body = self.body(&at.body, &format!("{place}/body"))?;
        let Along::Node { node, direction } = at.along else {
            let problem = "the place is one of a bar";
            return Err(model(place, problem, "node and direction of a body of matrices"));
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
                        (None, set) => body.set(set.as_deref().unwrap_or_default(), &place)?,
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
                return Err(model(&place, "the load is given twice or not at all", accepted));
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
            return Err(model(&format!("{place}/law"), problem, accepted));
        }
        let cells = asperity_matrices::read_cells(&folder.join(&patch.cells))?;
        let first = self.contacts.len();
        if first + cells.len() > MOST_CELLS {
            let problem = format!("{} cells in all", first + cells.len());
            return Err(model(&format!("{place}/cells"), problem, format!("at most {MOST_CELLS}")));
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
        });
        Ok(())
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
                model(place, "the cells have no body", accepted)
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
                Err(model(&format!("{place}/cells"), problem, "cells of one or two bodies"))
            }
        }
    }
}

fn sparse(matrix: &asperity_matrices::SparseSymmetric) -> SparseColMat<usize, f64> {
    let size = matrix.size();
    let (starts, rows) = (matrix.column_starts().to_vec(), matrix.rows().to_vec());
    let symbolic = SymbolicSparseColMat::new_checked(size, size, starts, None, rows);
    SparseColMat::new(symbolic, matrix.values().to_vec())
}
