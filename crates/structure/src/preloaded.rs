//! A structure about its rest, ready for any solver.

use std::f64::consts::TAU;

use asperity_mesh::{Body, ComponentModes, ModeCount, Port, Stack};

use crate::equilibrium::{self, StaticDisplacement};
use crate::linearised::lowest_frequency;
use crate::modal_damping::ModalRatios;
use crate::modes::Chain;
use crate::{DampedMode, Damping, Guide, LinearisedMode, PreloadedContact, StructureError};

/// Most work of a computation of modes, their number times the cube of the number of faces: some
/// minutes.
const MOST_MODE_WORK: f64 = 1e11;

/// A structure in static equilibrium: mesh, contacts at rest, guides with friction, and
/// mass-proportional damping beside the internal damping of its bodies.
///
/// Friction carries nothing at rest. Linearised modes and natural frequencies are those without it:
/// of elements that slip all the time.
///
/// The mesh is a [`Stack`] of bars, or the [`ComponentModes`] of any structure. The first is
/// [reduced](PreloadedStructure::reduced) to the second where a solver works with modes.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_law::Constant;
/// use asperity_mesh::{Body, Interface, Stack, Support};
/// use asperity_structure::{Damping, PreloadedStructure};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
/// let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Constant::new(4.25e11)?))?;
/// let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
///
/// let structure = PreloadedStructure::new(stack, Damping::Ratio(0.035))?;
/// assert!((structure.contacts()[0].pressure() - 1.61 * 9.81 / 1.15e-4).abs() < 1e-6);
/// let lowest = &structure.modes(1)?[0];
/// assert!((lowest.damping_ratio - 0.035).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct PreloadedStructure<M = Stack> {
    mesh: M,
    contacts: Vec<PreloadedContact>,
    guides: Vec<Guide>,
    damping_rate: f64,
    damped_modes: Vec<DampedMode>,
    ratios: ModalRatios,
    natural: Option<f64>,
}

impl<M> PreloadedStructure<M> {
    /// The contacts at rest, in the order of the mesh: from the top down for a stack.
    pub fn contacts(&self) -> &[PreloadedContact] {
        &self.contacts
    }

    /// The guides with friction, in the order of the mesh: from the top down for a stack.
    pub fn guides(&self) -> &[Guide] {
        &self.guides
    }

    /// Name of the first friction element, across a closure or in a guide, if there is one.
    pub fn friction(&self) -> Option<&str> {
        let mut contacts = self.contacts.iter().filter(|contact| contact.friction().is_some());
        let guide = self.guides.first().map(Guide::name);
        contacts.next().map(PreloadedContact::name).or(guide)
    }

    /// Mass-proportional damping h of the bodies \[1/s\].
    pub fn damping_rate(&self) -> f64 {
        self.damping_rate
    }

    /// The modes with a damping of their own, from the lowest on; none without
    /// [ratios of modes](PreloadedStructure::with_modal_damping).
    pub fn damped_modes(&self) -> &[DampedMode] {
        &self.damped_modes
    }

    /// Lowest natural frequency linearised at rest \[Hz\]: exact for a stack, of the modes kept for
    /// component modes; none where a contact has no stiffness at rest.
    pub fn natural_frequency(&self) -> Option<f64> {
        self.natural
    }

    fn with(
        mesh: M,
        contacts: Vec<PreloadedContact>,
        guides: Vec<Guide>,
        damping: Damping,
        natural: Result<f64, StructureError>,
    ) -> Result<Self, StructureError> {
        let lowest = natural.as_ref().ok().copied();
        let damping_rate = damping.rate(natural)?;
        let (damped_modes, ratios) = (Vec::new(), ModalRatios::default());
        Ok(Self { mesh, contacts, guides, damping_rate, damped_modes, ratios, natural: lowest })
    }
}

impl PreloadedStructure {
    /// The rest of `stack` under its weight, with `damping`.
    ///
    /// # Errors
    /// [`StructureError::NoEquilibrium`] when a law cannot carry its static pressure;
    /// [`StructureError::Setting`] for damping that is negative or not finite;
    /// [`StructureError::NoFrequency`] for a positive damping ratio when a contact has no stiffness
    /// at rest.
    pub fn new(stack: Stack, damping: Damping) -> Result<Self, StructureError> {
        let contacts = equilibrium::contacts(&stack)?;
        let natural = Chain::new(&stack, &contacts).and_then(|chain| Ok(chain.frequency(1)? / TAU));
        let guides = guides_of(&stack);
        Self::with(stack, contacts, guides, damping, natural)
    }

    /// The bodies, interfaces and support.
    pub fn stack(&self) -> &Stack {
        &self.mesh
    }

    /// Displacements of faces and support under weight.
    pub fn static_displacement(&self) -> StaticDisplacement {
        equilibrium::displacement(&self.mesh, &self.contacts)
    }

    /// The lowest `count` modes linearised at rest, exact for elastic bars.
    ///
    /// The contacts are springs of stiffness `K(p0) S`. The dynamic stiffness of the faces is
    /// tridiagonal, and the Wittrick-Williams count (J. Sound Vib. 1971, 16, 419) brackets every
    /// frequency, so none is missed; bisection then finds it to the last bits. For the paper's rig
    /// with K = 8.5e11 Pa/m: 831.98, 11229.3, 22351.6, 31863.6 Hz.
    ///
    /// # Errors
    /// [`StructureError::NoFrequency`] when a contact has no stiffness at rest;
    /// [`StructureError::Eigenvalues`] if a shape cannot be found.
    pub fn modes(&self, count: usize) -> Result<Vec<LinearisedMode>, StructureError> {
        let chain = Chain::new(&self.mesh, &self.contacts)?;
        let work = count as f64 * ((2 * self.contacts.len() + 1) as f64).powi(3);
        if work > MOST_MODE_WORK {
            let quantity = "number of modes times the cube of the number of faces";
            let accepted = "at most 1e11";
            return Err(StructureError::Setting { quantity, value: work, accepted });
        }
        let mode = |number: usize| {
            let mode = chain.mode(chain.frequency(number)?, self.damping_rate)?;
            let own = self.damped_modes.get(number - 1).map_or(0.0, |damped| {
                0.5 * (damped.damping_rate - self.damping_rate) / damped.angular_frequency
            });
            Ok(LinearisedMode { damping_ratio: mode.damping_ratio + own, ..mode })
        };
        (1..=count).map(mode).collect()
    }

    /// The structure in free-interface modes of its bars with residual flexibility, at these `ports`
    /// and those of its contacts and guides.
    ///
    /// # Errors
    /// [`StructureError::Mesh`] when `modes` asks for none or too many, or for a port that is not on
    /// the stack.
    pub fn reduced(
        &self,
        modes: ModeCount,
        ports: &[Port],
    ) -> Result<PreloadedStructure<ComponentModes>, StructureError> {
        self.with_modes(ComponentModes::of_stack(&self.mesh, modes, ports)?, ports)
    }

    /// [`reduced`](Self::reduced) with a count of modes, the rigid one included, of each body.
    ///
    /// # Errors
    /// [`StructureError::Mesh`] for no modes of a body or too many, or a port that is not on the stack.
    pub fn reduced_to(
        &self,
        counts: &[usize],
        ports: &[Port],
    ) -> Result<PreloadedStructure<ComponentModes>, StructureError> {
        self.with_modes(ComponentModes::with_counts(&self.mesh, counts, ports)?, ports)
    }

    fn with_modes(
        &self,
        modes: ComponentModes,
        ports: &[Port],
    ) -> Result<PreloadedStructure<ComponentModes>, StructureError> {
        let at_ports = |mode: &DampedMode| mode.at_ports(&self.mesh, &modes, ports);
        let damped_modes = self.damped_modes.iter().map(at_ports).collect();
        let damping = Damping::Rate(self.damping_rate);
        let structure = PreloadedStructure::of_components(modes, self.contacts.clone(), damping)?;
        let structure = structure.with_guides(self.guides.clone())?;
        Ok(PreloadedStructure { damped_modes, ratios: self.ratios.clone(), ..structure })
    }

    /// The ratios of modes that the structure was [given](Self::with_modal_damping), and that of the
    /// next, if it was.
    pub fn modal_ratios(&self) -> Option<(&[f64], f64)> {
        (!self.damped_modes.is_empty()).then_some((&self.ratios.ratios, self.ratios.other))
    }

    pub(crate) fn with_damped_modes(
        self,
        mesh: Stack,
        damping_rate: f64,
        damped_modes: Vec<DampedMode>,
        ratios: ModalRatios,
    ) -> Self {
        Self { mesh, damping_rate, damped_modes, ratios, ..self }
    }
}

impl PreloadedStructure<ComponentModes> {
    /// Any structure in component modes, with a contact at rest for each of its contact pairs.
    ///
    /// # Errors
    /// [`StructureError::ContactCount`] unless there is one contact per pair, and at least one;
    /// [`StructureError::Setting`] for damping that is negative or not finite;
    /// [`StructureError::NoFrequency`] for a positive damping ratio when a contact has no stiffness
    /// at rest.
    pub fn of_components(
        modes: ComponentModes,
        contacts: Vec<PreloadedContact>,
        damping: Damping,
    ) -> Result<Self, StructureError> {
        let (pairs, given) = (modes.contacts().len(), contacts.len());
        if given != pairs || given == 0 {
            return Err(StructureError::ContactCount { pairs, contacts: given });
        }
        let natural = lowest_frequency(&modes, &contacts);
        Self::with(modes, contacts, Vec::new(), damping, natural)
    }

    /// The structure with a guide for each of those in its modes.
    ///
    /// # Errors
    /// [`StructureError::GuideCount`] unless there are as many, [`StructureError::GuideContact`] for
    /// a guide under a contact that is none of the structure's.
    pub fn with_guides(self, guides: Vec<Guide>) -> Result<Self, StructureError> {
        let (expected, given) = (self.mesh.guides().len(), guides.len());
        if given != expected {
            return Err(StructureError::GuideCount { expected, given });
        }
        let contacts = self.contacts.len();
        if let Some(guide) = guides.iter().find(|guide| guide.contact() >= contacts) {
            let (guide, contact) = (guide.name().to_owned(), guide.contact());
            return Err(StructureError::GuideContact { guide, contact, contacts });
        }
        Ok(Self { guides, ..self })
    }

    /// The modes and their residual flexibility.
    pub fn component_modes(&self) -> &ComponentModes {
        &self.mesh
    }
}

/// The guides of a stack: a coefficient of friction is one of the contact below the body.
fn guides_of(stack: &Stack) -> Vec<Guide> {
    let bodies = stack.bodies().iter().enumerate();
    let guide = |(i, body): (usize, &Body)| Some(Guide::new(body.name(), body.friction()?, i));
    bodies.filter_map(guide).collect()
}
