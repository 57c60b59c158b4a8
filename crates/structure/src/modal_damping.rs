//! Damping ratios of linearised modes.

use std::f64::consts::TAU;

use asperity_mesh::{Body, BodyDamping, ComponentModes, Port, Stack, Support};

use crate::{LinearisedMode, PreloadedStructure, StructureError};

/// One linearised mode with a damping of its own, mass-normalised.
///
/// Beside mass-proportional damping h the structure has the dampers
/// `sum_r (2 zeta_r w_r - h) M phi_r phi_r^T M`, so that mode r has the ratio `zeta_r` and the others
/// the rate h.
#[derive(Debug, Clone, PartialEq)]
pub struct DampedMode {
    /// Natural frequency w \[rad/s\].
    pub angular_frequency: f64,
    /// Damping rate `2 zeta w` \[1/s\].
    pub damping_rate: f64,
    /// Participation of each closure, and after them of the displacement in each guide with friction
    /// \[kg^-1/2\].
    pub closure: Vec<f64>,
    /// Participation of each port of component modes \[kg^-1/2\]; none for a stack, whose ports have
    /// those of the [`shape`](Self::shape).
    pub ports: Vec<f64>,
    /// Shape of the mode.
    pub shape: LinearisedMode,
}

impl DampedMode {
    /// The mode with its participations of the ports of `modes`, the component modes of `stack` with the
    /// ports `given` first.
    pub(crate) fn at_ports(&self, stack: &Stack, modes: &ComponentModes, given: &[Port]) -> Self {
        let mut ports = vec![0.0; modes.ports()];
        let mut put = |number: usize, port| ports[number] = self.shape.participation(stack, port);
        for (number, port) in given.iter().enumerate() {
            put(number, *port);
        }
        for (i, pair) in modes.contacts().iter().enumerate() {
            put(pair.upper, Port::Point { body: i, position: stack.bodies()[i].length() });
            if let Some(lower) = pair.lower {
                let next = i + 1 < stack.bodies().len();
                let below = Port::Point { body: i + 1, position: 0.0 };
                put(lower, if next { below } else { Port::Support });
            }
        }
        for (guide, (body, _)) in modes.guides().iter().zip(guided(stack)) {
            put(guide.upper, Port::Mean { body });
        }
        Self { ports, ..self.clone() }
    }
}

/// The bodies in guides with friction, with their numbers.
fn guided(stack: &Stack) -> impl Iterator<Item = (usize, &Body)> {
    stack.bodies().iter().enumerate().filter(|(_, body)| body.friction().is_some())
}

/// Ratios of the lowest modes, and that of the next.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct ModalRatios {
    pub(crate) ratios: Vec<f64>,
    pub(crate) other: f64,
}

impl PreloadedStructure {
    /// The structure with these damping ratios of its lowest modes linearised at rest, and the ratio
    /// `other` of the next one, whose damping rate all modes above have. They replace the
    /// mass-proportional damping.
    ///
    /// Ratios are those of the whole structure without friction and the damping of contacts, which
    /// are added to them.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use asperity_law::Constant;
    /// # use asperity_mesh::{Body, Interface, Stack, Support};
    /// # use asperity_structure::{Damping, PreloadedStructure};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
    /// # let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Constant::new(4.25e11)?))?;
    /// # let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
    /// let structure = PreloadedStructure::new(stack, Damping::Rate(0.0))?;
    /// let structure = structure.with_modal_damping(&[0.03, 0.005], 0.01)?;
    /// let ratios: Vec<f64> = structure.modes(3)?.iter().map(|mode| mode.damping_ratio).collect();
    /// assert!((ratios[0] - 0.03).abs() < 1e-9 && (ratios[2] - 0.01).abs() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`StructureError::Setting`] for no ratio, one that is negative or not finite, or a support or
    /// body with damping of its own, which the ratios would count twice; those of
    /// [`modes`](Self::modes).
    pub fn with_modal_damping(self, ratios: &[f64], other: f64) -> Result<Self, StructureError> {
        let setting =
            |quantity, value, accepted| StructureError::Setting { quantity, value, accepted };
        if ratios.is_empty() {
            return Err(setting("number of damping ratios", 0.0, "at least 1"));
        }
        for &value in ratios.iter().chain([&other]) {
            if !(value.is_finite() && value >= 0.0) {
                return Err(setting("damping ratio of a mode", value, "finite and not negative"));
            }
        }
        let own = self.stack().support().damping();
        if own != 0.0 {
            let accepted = "0: ratios of modes are those of the whole structure";
            return Err(setting("damper of the support [N s/m]", own, accepted));
        }
        if self.stack().bodies().iter().any(|body| body.damping() != BodyDamping::NONE) {
            let accepted = "0: ratios of modes are those of the whole structure";
            return Err(setting("number of bodies with internal damping", 1.0, accepted));
        }
        let modes = self.modes(ratios.len() + 1)?;
        let rate = 2.0 * other * TAU * modes[ratios.len()].frequency_hz;
        // The rate of the others is one of all masses, that of the support included.
        let stack = with_damped_support(self.stack(), rate)?;
        let damped = |(mode, ratio): (&LinearisedMode, &f64)| damped_mode(&stack, mode, *ratio);
        let damped = modes.iter().zip(ratios).map(damped).collect();
        let ratios = ModalRatios { ratios: ratios.to_vec(), other };
        Ok(self.with_damped_modes(stack, rate, damped, ratios))
    }
}

/// The stack with the damping `rate` \[1/s\] of its support's mass.
fn with_damped_support(stack: &Stack, rate: f64) -> Result<Stack, StructureError> {
    let Support::SpringMass { stiffness, mass, .. } = *stack.support() else {
        return Ok(stack.clone());
    };
    let damping_ratio = 0.5 * rate * (mass / stiffness).sqrt();
    let support = Support::SpringMass { stiffness, mass, damping_ratio };
    let (bodies, interfaces) = (stack.bodies().to_vec(), stack.interfaces().to_vec());
    Ok(Stack::new(bodies, interfaces, support, stack.gravity())?)
}

fn damped_mode(stack: &Stack, mode: &LinearisedMode, ratio: f64) -> DampedMode {
    let (w, scale) = (TAU * mode.frequency_hz, mode.modal_mass_kg.sqrt().recip());
    let below = |i: usize| mode.faces.get(i + 1).map_or(mode.support, |(top, _)| *top);
    let faces = mode.faces.iter().enumerate();
    let mut closure: Vec<f64> = faces.map(|(i, (_, bottom))| scale * (bottom - below(i))).collect();
    closure.extend(guided(stack).map(|(body, _)| mode.participation(stack, Port::Mean { body })));
    DampedMode {
        angular_frequency: w,
        damping_rate: 2.0 * ratio * w,
        closure,
        ports: Vec::new(),
        shape: mode.clone(),
    }
}
