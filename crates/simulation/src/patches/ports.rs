//! Ports of a structure of matrices: cells of patches, springs, loads, the excitation and sensors.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use asperity_law::{Constant, ContactDamping, ContactLaw, LawError};
use asperity_matrices::{Deck, Dof, ReducedModel};
use asperity_mesh::{PortPair, PortPattern};
use asperity_scenario::{
    Along, ContactDampingSpec, ExcitationSpec, PatchSpec, PlaceSpec, SpringSpec, StaticLoadSpec,
    StructureBodySpec, StructureScenario,
};
use asperity_structure::UnloadedContact;

use super::bar::Bar;
use super::body::{Body, read_deck, read_model, unit};
use crate::error::SimulationError;
use crate::shared_laws::shared_law;

/// A place of a body of matrices.
const PLACE: &str = "{\"body\": NAME, \"node\": NUMBER, \"direction\": [x, y, z]}, or \"response\" of a reduced model";

/// Area of a spring as a contact \[m2\].
const SPRING_AREA: f64 = 1e-6;

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

/// Ports of a structure by number. Laws, gaps, springs and sizes of loads are not in it: they change no reduction.
#[derive(Debug, Default)]
pub(super) struct PortMap {
    /// Ports that join the cells, and after them the springs.
    pub(super) pairs: Vec<PortPair>,
    pub(super) patches: Vec<Patch>,
    /// Area of each cell \[m2\].
    pub(super) areas: Vec<f64>,
    /// Port of the weight of each body along each axis of gravity.
    weights: Vec<(usize, usize)>,
    /// Port of each static load.
    loads: Vec<usize>,
    /// Port of the excitation.
    pub(super) load: usize,
    pub(super) sensors: Vec<usize>,
    /// Number of ports.
    pub(super) count: usize,
}

/// Ports of a structure with its files. Without bodies read, where their reduction is known, the patterns are empty.
pub(super) struct Ports<'a> {
    names: Vec<&'a str>,
    /// The mesh of each body, where it was read.
    pub(super) decks: Vec<Option<Deck>>,
    /// The reduced model of each body that is one.
    models: Vec<Option<ReducedModel>>,
    /// The bar of each body that is one.
    pub(super) bars: Vec<Option<Bar>>,
    /// Each body of matrices, where it was read.
    pub(super) bodies: Vec<Option<Body>>,
    /// Body and pattern of each port.
    pub(super) patterns: Vec<(usize, PortPattern)>,
    /// Port of the motion of the base, which all bodies share: forces of an acceleration of 1 m/s2 on the rows of each
    /// \[kg\].
    base: Option<(usize, Vec<PortPattern>)>,
    pub(super) map: PortMap,
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
        let deck = |spec: &StructureBodySpec| {
            if whole || is_side(&spec.name) { read_deck(spec, folder) } else { Ok(None) }
        };
        let decks = scenario.bodies.iter().map(deck).collect::<Result<Vec<_>, _>>()?;
        let model = |(number, spec): (usize, &StructureBodySpec)| {
            read_model(spec, folder, &format!("/bodies/{number}"))
        };
        let models = scenario.bodies.iter().enumerate().map(model);
        let models = models.collect::<Result<Vec<_>, _>>()?;
        let bar = |(number, spec)| Bar::of(spec, &format!("/bodies/{number}"));
        let bars = scenario.bodies.iter().enumerate().map(bar).collect::<Result<Vec<_>, _>>()?;
        let mut ports = Self {
            names: scenario.bodies.iter().map(|body| body.name.as_str()).collect(),
            decks,
            models,
            bars,
            bodies: scenario.bodies.iter().map(|_| None).collect(),
            patterns: Vec::new(),
            base: None,
            map: PortMap::default(),
        };
        // A kept reduction is one with the displacements that are held.
        let held = if whole { ports.held(scenario)? } else { Vec::new() };
        let direction = base_direction(scenario)?;
        let gravity = scenario.gravity_m_per_s2;
        let pulled = [0, 1, 2].map(|axis| {
            gravity[axis] != 0.0 || direction.is_some_and(|direction| direction[axis] != 0.0)
        });
        for ((number, spec), held) in scenario.bodies.iter().enumerate().zip(&held) {
            ports.bodies[number] = match (&ports.models[number], &spec.matrices) {
                (Some(model), _) => Some(Body::of_model(&spec.name, model)?),
                (None, Some(matrices)) => {
                    let deck = ports.decks[number].as_ref();
                    Some(Body::read((spec, matrices), folder, deck, pulled, held)?)
                }
                (None, None) => None,
            };
        }
        for (number, patch) in scenario.interfaces.iter().enumerate() {
            ports.add_patch(patch, number, folder)?;
        }
        for body in 0..ports.names.len() {
            for (axis, _) in (0..).zip(scenario.gravity_m_per_s2).filter(|(_, g)| *g != 0.0) {
                let along = [0, 1, 2].map(|other| f64::from(u8::from(other == axis)));
                let weight = ports.weight(body, along);
                let port = ports.add(body, weight);
                ports.map.weights.push((axis, port));
            }
        }
        for (number, spring) in scenario.springs.iter().enumerate() {
            ports.add_spring(spring, number)?;
        }
        for (number, load) in scenario.loads.iter().enumerate() {
            ports.add_load(load, number, folder)?;
        }
        ports.map.load = match (scenario.excitation.at(), direction) {
            (None, Some(direction)) => ports.add_base(direction)?,
            (Some(at), _) => ports.add_place(at, "/excitation/at")?,
            (None, None) if matches!(scenario.excitation, ExcitationSpec::None) => {
                // No force acts; the first sensor's port stands in for one.
                ports.add_sensor(scenario, 0)?
            }
            (None, None) => {
                let accepted = PLACE;
                return Err(SimulationError::model(
                    "/excitation",
                    "the force has no place \"at\"",
                    accepted,
                ));
            }
        };
        for number in 0..scenario.sensors.len() {
            let port = ports.add_sensor(scenario, number)?;
            ports.map.sensors.push(port);
        }
        ports.map.count = ports.patterns.len();
        Ok(ports)
    }

    pub(super) fn add(&mut self, body: usize, pattern: PortPattern) -> usize {
        self.patterns.push((body, pattern));
        self.patterns.len() - 1
    }

    /// The mesh of a body.
    pub(super) fn deck(&self, body: usize, place: &str) -> Result<&Deck, SimulationError> {
        self.decks[body].as_ref().ok_or_else(|| {
            let problem =
                format!("body \"{}\" has no mesh with sets and surfaces", self.names[body]);
            SimulationError::model(place, problem, "a body with \"mesh\"")
        })
    }

    /// Nodes of a set of a body.
    pub(super) fn set(
        &self,
        body: usize,
        set: &str,
        place: &str,
    ) -> Result<Vec<i64>, SimulationError> {
        let place = format!("{place}/set");
        let nodes = self.deck(body, &place)?.node_set(set)?.to_vec();
        if nodes.is_empty() {
            return Err(SimulationError::model(&place, "the set has no nodes", "a set of nodes"));
        }
        Ok(nodes)
    }

    /// Mean displacement of nodes of a body along a direction.
    pub(super) fn mean_along(
        &self,
        body: usize,
        nodes: &[i64],
        direction: [f64; 3],
        place: &str,
    ) -> Result<PortPattern, SimulationError> {
        let mut pattern = PortPattern::new();
        let share = 1.0 / nodes.len() as f64;
        if let Some(body) = &self.bodies[body] {
            for &node in nodes {
                let rows = body.along(node, direction, place)?;
                pattern.extend(rows.into_iter().map(|(row, part)| (row, share * part)));
            }
        }
        Ok(pattern)
    }

    /// Numbers of the ports of a body.
    pub(super) fn of(&self, body: usize) -> Vec<usize> {
        let is_base = |port: usize| self.base.as_ref().is_some_and(|(base, _)| *base == port);
        let is_own = |port: &usize| self.patterns[*port].0 == body || is_base(*port);
        (0..self.patterns.len()).filter(is_own).collect()
    }

    /// Pattern of a port on a body.
    pub(super) fn pattern(&self, port: usize, body: usize) -> PortPattern {
        match &self.base {
            Some((base, patterns)) if *base == port => patterns[body].clone(),
            _ => self.patterns[port].1.clone(),
        }
    }

    /// Forces on the rows of a body of an acceleration of 1 m/s2 along `direction`, on whose axes the weights of bodies were
    /// read \[kg\].
    fn weight(&mut self, body: usize, direction: [f64; 3]) -> PortPattern {
        match (&mut self.bars[body], &self.bodies[body]) {
            (Some(bar), _) => bar.weight(direction),
            (None, Some(body)) => {
                let axes = body.weights.iter().zip(direction).filter(|(_, part)| *part != 0.0);
                let parts = axes.flat_map(|(weight, part)| {
                    weight.iter().map(move |&(row, mass)| (row, part * mass))
                });
                parts.collect()
            }
            (None, None) => PortPattern::new(),
        }
    }

    /// The port of a motion of the base along a direction of unit length: the load is its acceleration, which acts
    /// on all bodies against it.
    fn add_base(&mut self, direction: [f64; 3]) -> Result<usize, SimulationError> {
        if let Some(number) = self.models.iter().position(Option::is_some) {
            let problem = format!("body \"{}\" is a reduced model", self.names[number]);
            let accepted = "a motion of the base with bodies of matrices alone";
            return Err(SimulationError::model("/excitation/kind", problem, accepted));
        }
        let back = direction.map(|part| -part);
        let patterns = (0..self.names.len()).map(|body| self.weight(body, back)).collect();
        // A number that no body has.
        let port = self.add(self.names.len(), PortPattern::new());
        self.base = Some((port, patterns));
        Ok(port)
    }

    pub(super) fn body(&self, name: &str, place: &str) -> Result<usize, SimulationError> {
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
        let accepted = PLACE;
        let at =
            at.ok_or_else(|| SimulationError::model(&place, "the sensor has no place", accepted))?;
        self.add_place(at, &place)
    }

    fn add_place(&mut self, at: &PlaceSpec, place: &str) -> Result<usize, SimulationError> {
        let body = self.body(&at.body, &format!("{place}/body"))?;
        if let Some(bar) = &mut self.bars[body] {
            let pattern = bar.at(at).map_err(|error| {
                SimulationError::model(place, error.to_string(), "an end or a position of the bar")
            })?;
            return Ok(self.add(body, pattern));
        }
        let pattern = match at.along {
            Along::Node { node, direction } if self.models[body].is_none() => {
                let along = |body: &Body| body.along(node, direction, place);
                self.bodies[body].as_ref().map(along).transpose()?.unwrap_or_default()
            }
            Along::Response(response) => {
                let responses = &self.model(&at.body, &format!("{place}/body"))?.responses;
                if response >= responses.rows() {
                    let problem = format!("the reduced model has no response {response}");
                    let accepted = match responses.rows() {
                        0 => "a model with an array R".to_owned(),
                        rows => format!("0 to {}", rows - 1),
                    };
                    let at = format!("{place}/response");
                    return Err(SimulationError::model(&at, problem, accepted));
                }
                (0..responses.columns()).map(|k| (k, responses.get(response, k))).collect()
            }
            _ => {
                let problem = "the place is none of this body";
                let accepted = "node and direction of a body of matrices, response of a reduced model, or end or position_m of a bar";
                return Err(SimulationError::model(place, problem, accepted));
            }
        };
        Ok(self.add(body, pattern))
    }

    /// The reduced model of a body.
    pub(super) fn model(&self, body: &str, place: &str) -> Result<&ReducedModel, SimulationError> {
        self.models[self.body(body, place)?].as_ref().ok_or_else(|| {
            let problem = format!("body \"{body}\" is no reduced model");
            SimulationError::model(place, problem, "a body with the format \"reduced\"")
        })
    }

    /// Displacements of each body that are held.
    fn held(&self, scenario: &StructureScenario) -> Result<Vec<Vec<Dof>>, SimulationError> {
        let mut held = vec![Vec::new(); self.names.len()];
        for (number, spec) in scenario.held.iter().enumerate() {
            let place = format!("/held/{number}");
            let body = self.body(&spec.body, &format!("{place}/body"))?;
            let axes = (1..).zip(spec.direction).filter(|(_, part)| *part != 0.0);
            let axes: Vec<u8> = axes.map(|(axis, _)| axis).collect();
            let [axis] = axes[..] else {
                let problem = "the direction is not along x, y or z";
                let accepted = "one number that is not zero; a stiff spring holds other directions";
                return Err(SimulationError::model(
                    &format!("{place}/direction"),
                    problem,
                    accepted,
                ));
            };
            if self.models[body].is_some() || self.bars[body].is_some() {
                let problem = "reduced models and bars have no nodes";
                return Err(SimulationError::model(&place, problem, "a body of matrices"));
            }
            match (spec.node, &spec.set) {
                (Some(node), None) => held[body].push(Dof::new(node, axis)),
                (None, Some(set)) => {
                    let nodes = self.set(body, set, &place)?;
                    held[body].extend(nodes.into_iter().map(|node| Dof::new(node, axis)));
                }
                _ => {
                    let problem = "the displacement is given twice or not at all";
                    return Err(SimulationError::model(&place, problem, "\"node\" or \"set\""));
                }
            }
        }
        Ok(held)
    }

    fn add_spring(&mut self, spring: &SpringSpec, number: usize) -> Result<(), SimulationError> {
        let place = format!("/springs/{number}");
        let from = self.add_place(&spring.from, &format!("{place}/from"))?;
        let to = spring.to.as_ref();
        let to = to.map(|to| self.add_place(to, &format!("{place}/to"))).transpose()?;
        self.map.pairs.push(PortPair { upper: from, lower: to });
        Ok(())
    }

    fn add_load(
        &mut self,
        load: &StaticLoadSpec,
        number: usize,
        folder: &Path,
    ) -> Result<(), SimulationError> {
        let place = format!("/loads/{number}");
        let body = self.body(&load.body, &format!("{place}/body"))?;
        let pattern = match load {
            StaticLoadSpec {
                array: Some(_),
                factor: _,
                file: None,
                node: None,
                set: None,
                end: None,
                direction: None,
                force_n: None,
                ..
            } => {
                let loads = &self.model(&load.body, &format!("{place}/body"))?.loads;
                loads.iter().copied().enumerate().collect()
            }
            StaticLoadSpec {
                file: Some(file),
                array: None,
                factor: _,
                node: None,
                set: None,
                end: None,
                direction: None,
                force_n: None,
                ..
            } => {
                let read = |read: &Body| {
                    let forces = asperity_matrices::read_loads(&folder.join(file))?;
                    let own = forces
                        .iter()
                        .filter(|one| one.body.as_ref().is_none_or(|name| *name == load.body));
                    let mut pattern = PortPattern::new();
                    for one in own {
                        // The support takes a force on a row that is held.
                        let row = read.row(one.dof, &format!("{place}/file"))?;
                        pattern.extend(row.map(|row| (row, one.force_n)));
                    }
                    Ok::<_, SimulationError>(pattern)
                };
                self.bodies[body].as_ref().map(read).transpose()?.unwrap_or_default()
            }
            StaticLoadSpec {
                file: None,
                array: None,
                factor: None,
                direction: Some(direction),
                force_n: Some(_),
                node,
                set,
                end: None,
                ..
            } if node.is_some() != set.is_some() => {
                let nodes = match (node, set) {
                    (Some(node), _) => vec![*node],
                    // A set is read where its body was.
                    (None, set) if self.bodies[body].is_some() => {
                        self.set(body, set.as_deref().unwrap_or_default(), &place)?
                    }
                    _ => Vec::new(),
                };
                self.mean_along(body, &nodes, *direction, &place)?
            }
            StaticLoadSpec {
                end: Some(end),
                force_n: Some(_),
                file: None,
                array: None,
                factor: None,
                node: None,
                set: None,
                direction: None,
                ..
            } => {
                let bar = self.bars[body].as_mut().ok_or_else(|| no_bar(&load.body, &place))?;
                bar.at(&PlaceSpec { body: load.body.clone(), along: Along::End(*end) })?
            }
            _ => {
                let accepted = "\"file\" or \"array\" with or without \"factor\", \"node\" or \"set\" with \"direction\" and \"force_n\", or \"end\" of a bar with \"force_n\"";
                return Err(SimulationError::model(
                    &place,
                    "the load is given twice or not at all",
                    accepted,
                ));
            }
        };
        let port = self.add(body, pattern);
        self.map.loads.push(port);
        Ok(())
    }
}

impl PortMap {
    /// The contacts of `scenario` before the loads are on: the cells of its patches with their laws, and its springs.
    pub(super) fn contacts(
        &self,
        scenario: &StructureScenario,
    ) -> Result<Vec<UnloadedContact>, SimulationError> {
        let mut contacts = Vec::with_capacity(self.pairs.len());
        for (number, (spec, patch)) in scenario.interfaces.iter().zip(&self.patches).enumerate() {
            let law = law(scenario, spec, number)?;
            let damping = spec.damping.map(ContactDampingSpec::build).transpose();
            let damping = damping.map_err(|source| SimulationError::ContactDamping {
                interface: spec.name.clone(),
                source,
            })?;
            let cell = |(name, contact): (&String, usize)| UnloadedContact {
                name: format!("{}, cell {name}", spec.name),
                area: spec.area_m2.unwrap_or(self.areas[contact]),
                law: Arc::clone(&law),
                gap: spec.initial_gap_m,
                damping,
            };
            contacts.extend(patch.cell_names.iter().zip(patch.cells.clone()).map(cell));
        }
        for (number, one) in scenario.springs.iter().enumerate() {
            contacts.push(spring(one, number)?);
        }
        Ok(contacts)
    }

    /// Port and size of each static load of `scenario`: in N, or a factor on the forces of a file.
    pub(super) fn loads(&self, scenario: &StructureScenario) -> Vec<(usize, f64)> {
        let gravity = scenario.gravity_m_per_s2;
        let weights = self.weights.iter().map(|&(axis, port)| (port, gravity[axis]));
        let size = |load: &StaticLoadSpec| load.force_n.or(load.factor).unwrap_or(1.0);
        let others = self.loads.iter().zip(&scenario.loads);
        weights.chain(others.map(|(&port, load)| (port, size(load)))).collect()
    }
}

/// The error of an end of a body that is no bar.
pub(super) fn no_bar(body: &str, place: &str) -> SimulationError {
    let problem = format!("body \"{body}\" is no bar");
    SimulationError::model(&format!("{place}/end"), problem, "an end of a bar")
}

/// Direction of a motion of the base, of unit length; none for a force.
pub(super) fn base_direction(
    scenario: &StructureScenario,
) -> Result<Option<[f64; 3]>, SimulationError> {
    if !matches!(scenario.excitation, ExcitationSpec::BaseMotion { .. }) {
        return Ok(None);
    }
    let direction = scenario.excitation.base_direction().unwrap_or_default();
    unit(direction).map(Some).ok_or_else(|| {
        let problem = "the motion of the base has no direction";
        let accepted = "[x, y, z], not all zero";
        SimulationError::model("/excitation/direction", problem, accepted)
    })
}

/// The law of an interface.
fn law(
    scenario: &StructureScenario,
    spec: &PatchSpec,
    number: usize,
) -> Result<Arc<dyn ContactLaw>, SimulationError> {
    let law = shared_law(&scenario.laws, &spec.law, LAW_PRESSURE);
    let law: Arc<dyn ContactLaw> = law.map_err(|source: LawError| SimulationError::Law {
        law: spec.law.name().to_owned(),
        interface: Some(spec.name.clone()),
        pressure_pa: LAW_PRESSURE,
        source,
    })?;
    if !(law.domain().separates() || law.domain().is_bilateral()) {
        let problem = "the law never separates, so the faces have no first contact to count from";
        let accepted = "a law with a closure at zero pressure, or a constant stiffness";
        return Err(SimulationError::model(
            &format!("/interfaces/{number}/law"),
            problem,
            accepted,
        ));
    }
    Ok(law)
}

/// A spring as a contact of constant stiffness that carries tension.
fn spring(spring: &SpringSpec, number: usize) -> Result<UnloadedContact, SimulationError> {
    let fault =
        |source| SimulationError::ContactDamping { interface: format!("spring {number}"), source };
    let law = Constant::new(spring.stiffness_n_per_m / SPRING_AREA).map_err(fault)?;
    let time = |damping: f64| ContactDamping::kelvin_voigt(damping / spring.stiffness_n_per_m);
    Ok(UnloadedContact {
        name: format!("spring {number}"),
        area: SPRING_AREA,
        law: Arc::new(law),
        gap: 0.0,
        damping: spring.damping_n_s_per_m.map(time).transpose().map_err(fault)?,
    })
}
