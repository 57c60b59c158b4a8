//! A linear structure with its contacts.

use std::sync::Arc;

use asperity_law::Friction;
use asperity_structure::{Guide, PreloadedContact, PreloadedStructure};

use crate::pressure_increments::PressureIncrements;
use crate::{HarmonicError, LinearSystem, SystemPort};

/// Evaluation of the laws at the samples of a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LawEvaluation {
    /// By the law itself.
    Exact,
    /// By a table, and by the law itself outside it, which is several times faster: of a law that separates with a
    /// relative error of some 1e-11, of another with this error over the static pressure; amplitudes are off by about as
    /// much.
    Tabulated(f64),
}

impl Default for LawEvaluation {
    /// A table to 1e-8 of the static pressure.
    fn default() -> Self {
        Self::Tabulated(1e-8)
    }
}

/// A linear structure and the contacts between its faces, with a load and sensors: the system whose
/// periodic responses are sought.
///
/// The load and one sensor are at the top of a stack, or at port 0 of component modes, unless
/// [`with_ports`](Self::with_ports) gives others. A load is a force \[N\]; at
/// [`Port::Base`](asperity_mesh::Port::Base) it is a base acceleration \[m/s2\], displacements
/// are relative to the base, and the displacement of the load's own port is the moment `-sum m u`
/// \[kg m\].
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_harmonic::{ContactSystem, LawEvaluation};
/// use asperity_law::Power;
/// use asperity_mesh::{Body, Interface, Stack, Support};
/// use asperity_structure::{Damping, PreloadedStructure};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
/// let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Power::new(0.9e10, 0.35, 0.0)?))?;
/// let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
/// let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035))?;
///
/// let system = ContactSystem::of_structure(&structure, LawEvaluation::default())?;
/// assert_eq!(system.contacts()[0].name(), "guide-disc");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct ContactSystem {
    linear: Arc<dyn LinearSystem>,
    contacts: Vec<PreloadedContact>,
    increments: Vec<PressureIncrements>,
    /// The load, and after it the sensors.
    ports: Vec<SystemPort>,
}

impl ContactSystem {
    /// A structure with a contact at each of its interfaces.
    ///
    /// # Errors
    /// [`HarmonicError::ContactCount`] unless there is one contact per interface, and at least one;
    /// [`HarmonicError::NoStiffness`] for a contact that touches without stiffness at rest;
    /// [`HarmonicError::Law`] for a law that cannot be tabulated to the tolerance.
    pub fn new(
        linear: Arc<dyn LinearSystem>,
        contacts: Vec<PreloadedContact>,
        evaluation: LawEvaluation,
    ) -> Result<Self, HarmonicError> {
        if contacts.len() != linear.interfaces() || contacts.is_empty() {
            return Err(HarmonicError::ContactCount {
                interfaces: linear.interfaces(),
                contacts: contacts.len(),
            });
        }
        let increments = contacts.iter().map(|one| PressureIncrements::new(one, evaluation));
        let increments = increments.collect::<Result<_, _>>()?;
        let ports = vec![linear.default_port(); 2];
        Ok(Self { linear, contacts, increments, ports })
    }

    /// The system with its load and its sensors at other ports.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use asperity_harmonic::{
    /// #     ContactSystem, Continuation, HarmonicSettings, LawEvaluation, SystemPort, trace,
    /// # };
    /// # use asperity_law::Power;
    /// # use asperity_mesh::{Body, Interface, Port, Stack, Support};
    /// # use asperity_structure::{Damping, PreloadedStructure};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
    /// # let law = Arc::new(Power::new(0.9e10, 0.35, 0.0)?);
    /// # let contact = Interface::new("guide-disc", 1.15e-4, law)?;
    /// # let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
    /// # let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035))?;
    /// let system = ContactSystem::of_structure(&structure, LawEvaluation::default())?;
    /// let middle = Port::Point { body: 0, position: 0.1 };
    /// let system = system.with_ports(Port::Base, &[middle])?;
    /// // 0.3 m/s2 of the base.
    /// let sweep = Continuation::Frequency { force: 0.3, from: 800.0, to: 900.0 };
    /// let branch = trace(&system, &sweep, &HarmonicSettings::default())?;
    /// let first = &branch.points[0];
    /// let sensor = first.sensors[0].clone().absolute(first.force);
    /// assert!(sensor.acceleration(1).norm() > 0.3);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`HarmonicError::Structure`] or [`HarmonicError::ForeignPort`] for a port that the structure does
    /// not have.
    pub fn with_ports<P: Into<SystemPort> + Copy>(
        mut self,
        load: P,
        sensors: &[P],
    ) -> Result<Self, HarmonicError> {
        self.ports = [load].iter().chain(sensors).map(|&port| port.into()).collect();
        self.ports.iter().try_for_each(|&port| self.linear.check_port(port))?;
        Ok(self)
    }

    /// A preloaded structure, of elastic bars or in component modes, with its contacts.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn of_structure<M: Clone>(
        structure: &PreloadedStructure<M>,
        evaluation: LawEvaluation,
    ) -> Result<Self, HarmonicError>
    where
        PreloadedStructure<M>: LinearSystem + 'static,
    {
        Self::new(Arc::new(structure.clone()), structure.contacts().to_vec(), evaluation)
    }

    /// The linear structure.
    pub fn linear(&self) -> &dyn LinearSystem {
        &*self.linear
    }

    /// The port of the load, and after it those of the sensors.
    pub fn ports(&self) -> &[SystemPort] {
        &self.ports
    }

    /// The port of the load.
    pub(crate) fn load(&self) -> &[SystemPort] {
        &self.ports[..1]
    }

    /// The contacts at rest.
    pub fn contacts(&self) -> &[PreloadedContact] {
        &self.contacts
    }

    /// Number of pairs: the contacts, and after them the guides of the linear structure.
    pub(crate) fn pairs(&self) -> usize {
        self.contacts.len() + self.linear.guides().len()
    }

    /// The friction elements, each with the pair whose closure it follows and the contact whose force
    /// bounds it.
    pub(crate) fn friction_elements(&self) -> impl Iterator<Item = (Friction, usize, usize)> {
        let own = |(i, contact): (usize, &PreloadedContact)| Some((contact.friction()?, i, i));
        let count = self.contacts.len();
        let guided =
            move |(i, guide): (usize, &Guide)| (guide.friction(), count + i, guide.contact());
        let guides = self.linear.guides().iter().enumerate().map(guided);
        self.contacts.iter().enumerate().filter_map(own).chain(guides)
    }

    /// Name of the first friction element, if there is one.
    pub fn friction(&self) -> Option<&str> {
        let mut contacts = self.contacts.iter().filter(|contact| contact.friction().is_some());
        let guide = self.linear.guides().first().map(Guide::name);
        contacts.next().map(PreloadedContact::name).or(guide)
    }

    /// True if the equations of many contacts are written in the modes of the structure, and solved by iteration: it is
    /// given by component modes, without friction and without ratios of linearised modes.
    pub fn is_modal(&self) -> bool {
        self.friction().is_none() && self.linear.as_component_modes().is_some()
    }

    /// True if a contact is damped.
    pub(crate) fn is_damped(&self) -> bool {
        self.contacts.iter().any(|contact| contact.damping().is_some())
    }

    /// The [`forces`](Self::forces) of a contact with its damping at closure increments that grow at
    /// `rates` \[m/s\]: tractions times area, not below loss of contact where the law separates, and
    /// their derivatives with respect to closures \[N/m\] and `rates`, `dampers` \[N s/m\].
    pub(crate) fn damped_forces(
        &self,
        interface: usize,
        (closures, rates): (&[f64], &[f64]),
        (forces, tangents, dampers): (&mut [f64], &mut [f64], &mut [f64]),
    ) {
        self.forces(interface, closures, forces, tangents);
        let contact = &self.contacts[interface];
        let Some(damping) = contact.damping() else { return dampers.fill(0.0) };
        let (area, at_rest) = (contact.area(), contact.pressure());
        let separates = contact.law().domain().separates();
        let samples = forces.iter_mut().zip(tangents).zip(dampers).zip(rates);
        for (((force, tangent), damper), rate) in samples {
            let (pressure, stiffness) = (at_rest + *force / area, *tangent / area);
            let coefficient = damping.coefficient(pressure, stiffness);
            let traction = *force + area * coefficient * rate;
            if separates && traction < -area * at_rest {
                (*force, *tangent, *damper) = (-area * at_rest, 0.0, 0.0);
                continue;
            }
            let slope = contact.law().stiffness_slope(pressure);
            let change = stiffness * damping.coefficient_slope(pressure, stiffness, slope) * rate;
            *force = traction;
            *damper = area * coefficient;
            // Infinite next to a loss of contact with a vertical tangent.
            *tangent += if change.is_finite() { area * change } else { 0.0 };
        }
    }

    /// Force increments `S (p - p0)` \[N\] and tangents `S K` \[N/m\] of one contact at closure
    /// increments from rest \[m\]; all three slices have one length.
    pub(crate) fn forces(
        &self,
        interface: usize,
        closures: &[f64],
        forces: &mut [f64],
        tangents: &mut [f64],
    ) {
        let contact = &self.contacts[interface];
        let area = contact.area();
        let increments = &self.increments[interface];
        for (&x, (force, tangent)) in closures.iter().zip(forces.iter_mut().zip(tangents)) {
            let found = increments.at(contact, x);
            (*force, *tangent) = (area * found.value, area * found.tangent);
        }
    }

    /// The tangents alone of [`forces`](Self::forces).
    pub(crate) fn tangents(&self, interface: usize, closures: &[f64], tangents: &mut [f64]) {
        let contact = &self.contacts[interface];
        let area = contact.area();
        let increments = &self.increments[interface];
        for (&x, tangent) in closures.iter().zip(tangents) {
            *tangent = area * increments.at(contact, x).tangent;
        }
    }
}
