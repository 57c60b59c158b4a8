//! From a scenario to the structure at rest, its force and its integrator.

use std::path::Path;

use asperity_dynamics::{ContactForm, FiniteDifference, Integrator, Modal, Sampling};
use asperity_law::Friction;
use asperity_mesh::{Body, Interface, Port, Stack, Support};
use asperity_structure::{
    LoadCase, PreloadedContact, PreloadedStructure, SampledFunction, SensorKind, StructureError,
};

use crate::error::SimulationError;
use crate::shared_laws::shared_law;
use asperity_scenario::{
    BodySpec, ContactScheme, DampingSpec, ExcitationSpec, FrictionSpec, LoadSamples, MethodSpec,
    ModalSpec, SamplesError, SamplesFile, Scenario, SectionSpec, SensorSpec, SupportSpec,
};

/// Relative accuracy of a run that asks for none.
pub const DEFAULT_ACCURACY: f64 = 1e-3;

/// A scenario turned into the objects that compute.
#[derive(Debug, Clone)]
pub struct Assembly<S = PreloadedStructure> {
    /// Bodies, interfaces and support at rest, with their damping.
    pub structure: S,
    /// The force, or the motion of the base.
    pub load: LoadCase,
    /// The sensors; without any in the scenario one at the top, without a name.
    pub sensors: Vec<Sensor>,
    /// Duration and output rate of the record.
    pub sampling: Sampling,
    /// The integrator and its settings.
    pub method: Integrator,
    /// Relative accuracy of a modal response's observables.
    pub accuracy: f64,
}

/// A place at which responses are read.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Name; none for the top of a scenario without sensors.
    pub name: Option<String>,
    /// Place.
    pub port: Port,
    /// Quantity that it reads.
    pub kind: SensorKind,
    /// Part of a motion of the base that it reads: the cosine of the angle between both directions; 1 for bars.
    pub base_share: f64,
}

/// Structures whose interfaces are contacts at rest.
pub trait Interfaces {
    /// The interfaces, in the order of the results.
    fn interfaces(&self) -> &[PreloadedContact];

    /// True if friction may hold the structure away from its equilibrium.
    fn has_friction(&self) -> bool {
        false
    }
}

impl<M> Interfaces for PreloadedStructure<M> {
    fn interfaces(&self) -> &[PreloadedContact] {
        self.contacts()
    }

    fn has_friction(&self) -> bool {
        self.friction().is_some()
    }
}

impl<S> Assembly<S> {
    /// Ports of the sensors.
    pub fn sensor_ports(&self) -> Vec<Port> {
        self.sensors.iter().map(|sensor| sensor.port).collect()
    }
}

impl Assembly {
    /// Assembles `scenario`; sample files are looked for in `folder`.
    ///
    /// # Errors
    /// [`SimulationError`] when a part cannot be built or there is no static equilibrium.
    pub fn new(scenario: &Scenario, folder: &Path) -> Result<Self, SimulationError> {
        let (damping, internal) = scenario.damping.of_bodies()?;
        let stack = stack(scenario)?.with_body_damping(internal);
        let mut structure = PreloadedStructure::new(stack, damping)?;
        if let DampingSpec::Modal(modal) = &scenario.damping {
            structure = structure.with_modal_damping(&modal.ratios, modal.other())?;
        }
        Ok(Self {
            load: load_case(&scenario.excitation, structure.stack().bodies(), folder)?,
            sensors: sensors(scenario, structure.stack().bodies())?,
            structure,
            sampling: Sampling::new(scenario.duration_s, scenario.output_rate_hz)?,
            method: integrator(scenario.method),
            accuracy: match scenario.method {
                MethodSpec::Modal(ModalSpec { accuracy: Some(accuracy), .. }) => accuracy,
                _ => DEFAULT_ACCURACY,
            },
        })
    }
}

fn integrator(method: MethodSpec) -> Integrator {
    match method {
        MethodSpec::FiniteDifference(settings) => Integrator::from(FiniteDifference {
            cell: settings.cell_m,
            courant: settings.courant,
            contact: match settings.contact {
                ContactScheme::Centred => ContactForm::Centred,
                ContactScheme::NewLevel => ContactForm::NewLevel,
            },
        }),
        MethodSpec::Modal(settings) => Integrator::from(Modal {
            step: settings.step_s,
            modes_per_body: settings.modes_per_body,
            ..Modal::default()
        }),
    }
}

fn stack(scenario: &Scenario) -> Result<Stack, SimulationError> {
    let bodies = scenario.bodies.iter().map(body).collect::<Result<Vec<_>, _>>()?;
    let areas = scenario.interfaces.iter().map(|interface| interface.area_m2);
    let pressures = asperity_mesh::static_pressures(&bodies, areas, scenario.gravity_m_per_s2);
    let mut interfaces = Vec::with_capacity(scenario.interfaces.len());
    for (spec, &pressure) in scenario.interfaces.iter().zip(&pressures) {
        let law = shared_law(&scenario.laws, &spec.law, pressure).map_err(|source| {
            let (law, interface) = (spec.law.name().to_owned(), Some(spec.name.clone()));
            SimulationError::Law { law, interface, pressure_pa: pressure, source }
        })?;
        let interface = Interface::new(&spec.name, spec.area_m2, law);
        let interface = interface.map_err(StructureError::from)?;
        let interface = match spec.damping {
            None => interface,
            Some(damping) => interface.with_damping(damping.build().map_err(|source| {
                SimulationError::ContactDamping { interface: spec.name.clone(), source }
            })?),
        };
        interfaces.push(match spec.friction {
            None => interface,
            Some(one) => interface.with_friction(friction(&spec.name, one)?),
        });
    }
    let support = match scenario.support {
        SupportSpec::Rigid => Support::Rigid,
        SupportSpec::SpringMass { stiffness_n_per_m, mass_kg, damping_ratio } => {
            Support::SpringMass { stiffness: stiffness_n_per_m, mass: mass_kg, damping_ratio }
        }
    };
    let stack = Stack::new(bodies, interfaces, support, scenario.gravity_m_per_s2);
    Ok(stack.map_err(StructureError::from)?)
}

/// The friction element of the contact or body `name`.
fn friction(name: &str, spec: FrictionSpec) -> Result<Friction, SimulationError> {
    let element = name.to_owned();
    spec.build().map_err(|source| SimulationError::Friction { element, source })
}

/// The body that `spec` describes.
///
/// # Errors
/// [`SimulationError::Structure`] and [`SimulationError::Friction`] for values out of range.
pub fn body(spec: &BodySpec) -> Result<Body, SimulationError> {
    let BodySpec { name, length_m, youngs_modulus_pa, density_kg_per_m3, .. } = spec;
    let body = match spec.section {
        SectionSpec::AreaM2(area) => {
            Body::new(name, *length_m, area, *youngs_modulus_pa, *density_kg_per_m3)
        }
        SectionSpec::MassKg(mass) => {
            Body::with_mass(name, *length_m, mass, *youngs_modulus_pa, *density_kg_per_m3)
        }
    };
    let body = body.map_err(StructureError::from)?;
    Ok(match spec.friction {
        None => body,
        Some(one) => body.with_friction(friction(name, one)?),
    })
}

/// The load that `spec` describes on a stack of `bodies`; sample files are looked for in `folder`.
///
/// # Errors
/// [`SimulationError`] for samples that cannot be read or values out of range.
pub fn load_case(
    spec: &ExcitationSpec,
    bodies: &[Body],
    folder: &Path,
) -> Result<LoadCase, SimulationError> {
    let load = spec.load_case(bodies, |file| samples_of(file, folder))?;
    load.check()?;
    Ok(load)
}

/// The load that `spec` describes at a `port`; sample files are looked for in `folder`.
///
/// # Errors
/// As [`load_case`].
pub fn load_case_at(
    spec: &ExcitationSpec,
    port: Port,
    folder: &Path,
) -> Result<LoadCase, SimulationError> {
    let load = spec.load_case_at(port, |file| samples_of(file, folder))?;
    load.check()?;
    Ok(load)
}

/// The function of time in a file of samples as measured, which is looked for in `folder`.
fn samples_of(file: SamplesFile<'_>, folder: &Path) -> Result<SampledFunction, SimulationError> {
    let path = folder.join(file.file);
    let samples = LoadSamples::read(&path, file.column).and_then(|samples| {
        // What is zero throughout has no other peak.
        let is_scaled = file.peak.is_none() || samples.peak() != 0.0;
        if is_scaled { Ok(samples) } else { Err(SamplesError::ZeroForce) }
    });
    let samples = samples.map_err(|source| SimulationError::Samples { path, source })?;
    Ok(SampledFunction::new(samples.time_s, samples.values)?)
}

/// The sensors of `scenario`.
fn sensors(scenario: &Scenario, bodies: &[Body]) -> Result<Vec<Sensor>, SimulationError> {
    if scenario.sensors.is_empty() {
        let kind = SensorKind::Displacement;
        return Ok(vec![Sensor { name: None, port: Port::TOP, kind, base_share: 1.0 }]);
    }
    let sensor = |spec: &SensorSpec| {
        let port = spec.at.as_ref().map_or(Ok(Port::TOP), |at| at.port(bodies))?;
        Ok(Sensor { name: Some(spec.name.clone()), port, kind: spec.kind, base_share: 1.0 })
    };
    scenario.sensors.iter().map(sensor).collect()
}
