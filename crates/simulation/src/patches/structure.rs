//! A structure of matrices at rest, from the files of its scenario.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use asperity_dynamics::{ContactsState, Integrator, Sampling};
use asperity_mesh::{ComponentModes, Port, PortPattern, ReducedBody, RowShapes, massless_forces};
use asperity_scenario::{Along, DampingSpec, SensorSpec, StructureBodySpec, StructureScenario};
use asperity_structure::{
    PreloadedContact, PreloadedStructure, StaticState, StructureError, static_state,
};
use faer::Mat;
use tracing::info_span;

use super::bar::{axis, dot};
use super::body::unit;
use super::kept_reduction::{self, BodyShapes, FOLDER, ReductionKey};
use super::ports::{Patch, PortMap, Ports, base_direction};
use crate::assemble::{Assembly, DEFAULT_ACCURACY, Interfaces, Sensor, load_case_at};
use crate::error::SimulationError;
use crate::static_state::{StaticInterface, StaticSummary};

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
    /// Static displacement of each sensor by all loads \[m\].
    pub static_displacements: Vec<f64>,
    /// The rest as a motion of each body by all loads.
    pub(super) rest: Vec<BodyMotion>,
    /// Ports of each body.
    pub(super) own_ports: Vec<Vec<usize>>,
}

/// Displacements of the modes kept of a body \[m kg^1/2\], and the static forces at its ports that bend it as much as the modes
/// left out are \[N\].
#[derive(Debug, Clone)]
pub(super) struct BodyMotion {
    pub(super) coordinates: Vec<f64>,
    pub(super) port_forces: Vec<f64>,
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

    /// The motion of each body at an instant, from rest and relative to the base.
    pub(super) fn motions(&self, state: &ContactsState) -> Vec<BodyMotion> {
        let component = self.structure.component_modes();
        let mut forces = vec![0.0; component.ports()];
        forces[self.load] += state.load;
        for (pair, force) in component.contacts().iter().zip(&state.forces) {
            forces[pair.upper] -= force;
            if let Some(lower) = pair.lower {
                forces[lower] += force;
            }
        }
        let mut modes = component.modes().iter().zip(&state.coordinates).peekable();
        let bodies = self.modes_per_body.iter().zip(&self.own_ports);
        let motion = |(&count, own): (&usize, &Vec<usize>)| {
            let coordinates = modes.by_ref().take(count).map(|(_, q)| *q).collect();
            // Of a body with retardation the modes left out follow behind the forces.
            let (mut massless, mut behind) = (Vec::new(), Vec::new());
            while let Some((mode, q)) = modes.next_if(|(mode, _)| mode.massless) {
                massless.push(mode);
                behind.push(*q);
            }
            let all =
                if massless.is_empty() { &forces } else { &massless_forces(&massless, &behind) };
            BodyMotion { coordinates, port_forces: own.iter().map(|&port| all[port]).collect() }
        };
        bodies.map(motion).collect()
    }
}

/// The bodies of a structure in their modes, with the flexibility at its ports. They serve all scenarios that differ in
/// laws, gaps, springs, damping, sizes of loads and gravity, and the function of time of the force.
#[derive(Debug)]
pub struct ReducedStructure {
    folder: PathBuf,
    key: ReductionKey,
    ports: PortMap,
    bodies: Vec<ReducedBody>,
    /// Ports of each body.
    own: Vec<Vec<usize>>,
}

impl ReducedStructure {
    /// The reduction of the structure of `scenario`, whose files are looked for in `folder`: as it is kept there, or
    /// else made and kept.
    ///
    /// # Errors
    /// [`SimulationError::Matrices`] for files that cannot be read; [`SimulationError::Model`] for places, bodies and
    /// directions that do not exist; [`SimulationError::Structure`] for matrices that cannot be reduced.
    pub fn new(scenario: &StructureScenario, folder: &Path) -> Result<Self, SimulationError> {
        Self::of_key(ReductionKey::new(folder, scenario)?, scenario, folder)
    }

    fn of_key(
        key: ReductionKey,
        scenario: &StructureScenario,
        folder: &Path,
    ) -> Result<Self, SimulationError> {
        // The files of a kept reduction were checked when it was made.
        let (ports, bodies) = if kept_reduction::exists(folder, &key)
            && let (Some(found), ports) = rayon::join(
                || kept_reduction::find(folder, &key),
                || Ports::read(scenario, folder, false),
            ) {
            (ports?, found)
        } else {
            let (ports, made, _) = reduced(scenario, folder, &key)?;
            (ports, made)
        };
        let own: Vec<Vec<usize>> = (0..scenario.bodies.len()).map(|body| ports.of(body)).collect();
        let fits = |(body, own): (&ReducedBody, &Vec<usize>)| body.residual.ports() == own.len();
        if bodies.len() != own.len() || !bodies.iter().zip(&own).all(fits) {
            let problem = "the kept reduction is not one of this structure";
            return Err(SimulationError::model(
                "/bodies",
                problem,
                format!("a folder {FOLDER} that is removed"),
            ));
        }
        Ok(Self { folder: folder.to_owned(), key, ports: ports.map, bodies, own })
    }

    /// The structure at rest with the laws, gaps, springs, damping, loads and force of `scenario`, which has this
    /// reduction; files of samples are looked for in `folder`.
    ///
    /// # Errors
    /// [`SimulationError::Law`] and [`SimulationError::Model`] for laws and damping that do not fit;
    /// [`SimulationError::Structure`] without static equilibrium.
    pub fn assemble(
        &self,
        scenario: &StructureScenario,
        folder: &Path,
    ) -> Result<Assembly<PatchStructure>, SimulationError> {
        let Self { ports, bodies, own, .. } = self;
        let (damping, internal) = scenario.damping.of_bodies()?;
        if !matches!(scenario.damping, DampingSpec::MassProportional(_) | DampingSpec::Rayleigh(_))
        {
            return Err(SimulationError::model(
                "/damping",
                "the kind is not one of a structure of matrices",
                "mass_proportional or rayleigh",
            ));
        }
        let time = internal.retardation_time().unwrap_or(0.0);
        let count = ports.count;
        let joined: Vec<(&ReducedBody, &[usize])> =
            bodies.iter().zip(own).map(|(body, own)| (body, own.as_slice())).collect();
        let modes = ReducedBody::joined(&joined, count, time, ports.pairs.clone());
        let modes = modes.map_err(StructureError::from)?;
        let state = static_state(&modes, &ports.contacts(scenario)?, &ports.loads(scenario))?;
        let displacement = |&port: &usize| state.displacement(&modes, port);
        let static_displacements = ports.sensors.iter().map(displacement).collect();
        let StaticState { contacts, coordinates, port_forces } = state;
        let modes_per_body: Vec<usize> =
            bodies.iter().map(|body| body.angular_frequencies.len()).collect();
        let inert = modes.modes().iter().zip(coordinates).filter(|(mode, _)| !mode.massless);
        let mut inert = inert.map(|(_, q)| q);
        let rest = modes_per_body.iter().zip(own).map(|(&count, own)| BodyMotion {
            coordinates: inert.by_ref().take(count).collect(),
            port_forces: own.iter().map(|&port| port_forces[port]).collect(),
        });
        let rest = rest.collect();
        let rigid_motions = bodies.iter().map(ReducedBody::rigid_count).collect();
        let structure = PreloadedStructure::of_components(modes, contacts, damping)?;
        let interfaces = ports.patches.iter().map(|patch| whole(patch, structure.contacts()));
        let structure = PatchStructure {
            interfaces: interfaces.collect::<Result<_, _>>()?,
            structure: Arc::new(structure),
            patches: ports.patches.clone(),
            load: ports.load,
            sensors: ports.sensors.clone(),
            modes_per_body,
            rigid_motions,
            static_displacements,
            rest,
            own_ports: own.clone(),
        };
        let direction = base_direction(scenario)?;
        let named = |(spec, &port): (&SensorSpec, &usize)| Sensor {
            name: Some(spec.name.clone()),
            port: Port::Number(port),
            kind: spec.kind,
            base_share: direction.map_or(0.0, |direction| share(scenario, spec, direction)),
        };
        Ok(Assembly {
            load: load_case_at(&scenario.excitation, Port::Number(structure.load), folder)?,
            sensors: scenario.sensors.iter().zip(&structure.sensors).map(named).collect(),
            structure,
            sampling: Sampling::new(scenario.duration_s, scenario.output_rate_hz)?,
            method: Integrator::default(),
            accuracy: scenario.accuracy.unwrap_or(DEFAULT_ACCURACY),
        })
    }
}

/// Assembles the structure of `scenario`; its files are looked for in `folder`.
///
/// # Errors
/// Those of [`ReducedStructure::new`] and [`ReducedStructure::assemble`].
pub fn assemble_patches(
    scenario: &StructureScenario,
    folder: &Path,
) -> Result<Assembly<PatchStructure>, SimulationError> {
    ReducedStructure::new(scenario, folder)?.assemble(scenario, folder)
}

/// Reductions in memory, for scenarios many of which have the same.
#[derive(Debug, Default)]
pub struct ReducedStructures {
    known: Mutex<Vec<Arc<ReducedStructure>>>,
}

impl ReducedStructures {
    /// As [`assemble_patches`], with a reduction that is read or made once.
    ///
    /// # Errors
    /// Those of [`assemble_patches`].
    pub fn assemble(
        &self,
        scenario: &StructureScenario,
        folder: &Path,
    ) -> Result<Assembly<PatchStructure>, SimulationError> {
        let key = ReductionKey::new(folder, scenario)?;
        let all = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = |one: &&Arc<ReducedStructure>| one.folder == folder && one.key == key;
        let known = all().iter().find(is_it).map(Arc::clone);
        let found = if let Some(found) = known {
            found
        } else {
            // Not under the lock: threads that help with a reduction may come here.
            let made = Arc::new(ReducedStructure::of_key(key, scenario, folder)?);
            let mut known = all();
            if known.len() >= MOST_KEPT {
                known.remove(0);
            }
            known.push(Arc::clone(&made));
            made
        };
        found.assemble(scenario, folder)
    }
}

/// Most reductions in memory.
const MOST_KEPT: usize = 64;

/// The ports, and the bodies in their modes, with the flexibility at their ports and the shapes at their rows; both are
/// kept.
pub(super) fn reduced<'a>(
    scenario: &'a StructureScenario,
    folder: &Path,
    key: &ReductionKey,
) -> Result<(Ports<'a>, Vec<ReducedBody>, Vec<BodyShapes>), SimulationError> {
    let read = info_span!("read matrices");
    let ports = read.in_scope(|| Ports::read(scenario, folder, true))?;
    let reduce = |(number, spec): (usize, &StructureBodySpec)| {
        let own = ports.of(number).into_iter();
        let patterns: Vec<PortPattern> = own.map(|port| ports.pattern(port, number)).collect();
        let modes = spec.reduction.modes;
        if let Some(bar) = &ports.bars[number] {
            let reduced = bar.reduced(&patterns, modes)?;
            let modes = Mat::zeros(0, reduced.angular_frequencies.len());
            let flexible = Mat::zeros(0, patterns.len());
            let shapes = BodyShapes::new(Vec::new(), RowShapes { modes, flexible });
            return Ok((reduced, shapes));
        }
        let Some(body) = &ports.bodies[number] else {
            let place = format!("/bodies/{number}");
            return Err(SimulationError::model(&place, "the body is missing", "\"matrices\""));
        };
        let dofs = body.matrices.dofs().to_vec();
        let body = body.sparse(ports.decks[number].as_ref())?;
        let (reduced, shapes) =
            ReducedBody::with_shapes(&body, &patterns, modes).map_err(StructureError::from)?;
        Ok((reduced, BodyShapes::new(dofs, shapes)))
    };
    let (made, shapes): (Vec<_>, Vec<_>) = info_span!("reduce").in_scope(|| {
        let all = scenario.bodies.iter().enumerate().map(reduce);
        let all = all.collect::<Result<Vec<_>, SimulationError>>()?;
        Ok::<_, SimulationError>(all.into_iter().unzip())
    })?;
    kept_reduction::keep(folder, key, &made);
    kept_reduction::keep_shapes(folder, key, &shapes);
    Ok((ports, made, shapes))
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

/// Cosine of the angle between the direction of a sensor and one of unit length.
fn share(scenario: &StructureScenario, sensor: &SensorSpec, direction: [f64; 3]) -> f64 {
    let Some(at) = &sensor.at else { return 0.0 };
    let own = match at.along {
        Along::Node { direction, .. } => unit(direction),
        Along::End(_) | Along::PositionM(_) => {
            scenario.bodies.iter().find(|body| body.name == at.body).and_then(axis)
        }
        Along::Response(_) => None,
    };
    own.map_or(0.0, |own| dot(own, direction))
}
