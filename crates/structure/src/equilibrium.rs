//! Static equilibrium of a stack under its weight: the paper's "first static step".

use std::sync::Arc;

use asperity_mesh::{Body, Stack, Support};

use crate::{PreloadedContact, StructureError};

/// Static displacements \[m\] from the undeformed, just-touching state (closure zero everywhere).
#[derive(Debug, Clone, PartialEq)]
pub struct StaticDisplacement {
    /// Upper and lower face of each body, from the top down.
    pub faces: Vec<(f64, f64)>,
    /// The support; zero if it is rigid.
    pub support: f64,
}

/// Contacts of `stack` at rest.
///
/// A chain of bodies is statically determinate: the pressure under each is the weight above over
/// the area, `p0 = sum(m) g / S`, and the nonlinear law turns it into a closure.
pub(crate) fn contacts(stack: &Stack) -> Result<Vec<PreloadedContact>, StructureError> {
    let interfaces = stack.interfaces().iter().zip(stack.static_pressures());
    interfaces
        .map(|(interface, pressure)| {
            let law = Arc::clone(interface.law());
            let contact = PreloadedContact::new(interface.name(), interface.area(), law, pressure);
            Ok(contact?.with_damping(interface.damping()).with_friction(interface.friction()))
        })
        .collect()
}

/// Bars shorten under their load and weight by `(N L + rho A g L^2 / 2) / (E A)`, N the force on
/// their upper face.
pub(crate) fn displacement(stack: &Stack, contacts: &[PreloadedContact]) -> StaticDisplacement {
    let gravity = stack.gravity();
    let weight = stack.bodies().iter().map(Body::mass).sum::<f64>() * gravity;
    let support = match *stack.support() {
        Support::Rigid => 0.0,
        Support::SpringMass { stiffness, mass, .. } => (weight + mass * gravity) / stiffness,
    };
    let mut faces = vec![(0.0, 0.0); stack.bodies().len()];
    let mut below = support;
    for (i, body) in stack.bodies().iter().enumerate().rev() {
        let load_on_top = stack.bodies()[..i].iter().map(Body::mass).sum::<f64>() * gravity;
        let own_weight = body.mass() * gravity;
        let shortening = (load_on_top + 0.5 * own_weight) * body.length() / body.axial_rigidity();
        let bottom = below + contacts[i].closure();
        faces[i] = (bottom + shortening, bottom);
        below = bottom + shortening;
    }
    StaticDisplacement { faces, support }
}
