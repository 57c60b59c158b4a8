//! Nonlinear static equilibrium under weight.

use asperity_mesh::{Body, Stack, Support};

use crate::DynamicsError;

/// State of one interface at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticContact {
    /// Contact pressure p0 \[Pa\].
    pub pressure: f64,
    /// Contact stiffness per area K(p0) \[Pa/m\].
    pub stiffness: f64,
    /// Closure d0 = d(p0) \[m\], counted from the law's reference pressure.
    pub closure: f64,
}

/// Static equilibrium of a stack: the paper's "first static step".
///
/// A chain is statically determinate. The pressure under each body is the
/// weight above over the area, `p0 = sum(m) g / S`; the nonlinear law turns it
/// into a closure `d0 = d(p0)`; bars shorten under their load and weight by
/// `(N L + rho A g L^2 / 2) / (E A)`, N the force on their upper face.
#[derive(Debug, Clone, PartialEq)]
pub struct Equilibrium {
    contacts: Vec<StaticContact>,
    faces: Vec<(f64, f64)>,
    support: f64,
}

impl Equilibrium {
    /// The equilibrium of `stack`.
    ///
    /// # Errors
    /// [`DynamicsError::NoEquilibrium`] when a law cannot carry its static
    /// pressure: its closure or stiffness there is not finite.
    pub fn of(stack: &Stack) -> Result<Self, DynamicsError> {
        let mut contacts = Vec::with_capacity(stack.interfaces().len());
        for (interface, pressure) in stack.interfaces().iter().zip(stack.static_pressures()) {
            let law = interface.law();
            let state = StaticContact {
                pressure,
                stiffness: law.stiffness(pressure),
                closure: law.closure(pressure),
            };
            let carried = state.stiffness.is_finite() && state.closure.is_finite();
            if !carried || (pressure > 0.0 && state.stiffness <= 0.0) {
                return Err(DynamicsError::NoEquilibrium {
                    interface: interface.name().to_owned(),
                    pressure_pa: pressure,
                });
            }
            contacts.push(state);
        }
        let weight = stack.bodies().iter().map(Body::mass).sum::<f64>() * stack.gravity();
        let support = match *stack.support() {
            Support::Rigid => 0.0,
            Support::SpringMass { stiffness, mass, .. } => {
                (weight + mass * stack.gravity()) / stiffness
            }
        };
        let faces = face_displacements(stack, &contacts, support);
        Ok(Self { contacts, faces, support })
    }

    /// State of each interface, from the top down.
    pub fn contacts(&self) -> &[StaticContact] {
        &self.contacts
    }

    /// Static displacement \[m\] of the upper and lower face of each body, from
    /// the undeformed, just-touching state (closure zero at every interface).
    pub fn faces(&self) -> &[(f64, f64)] {
        &self.faces
    }

    /// Static displacement of the support \[m\]; zero if it is rigid.
    pub fn support(&self) -> f64 {
        self.support
    }
}

fn face_displacements(stack: &Stack, contacts: &[StaticContact], support: f64) -> Vec<(f64, f64)> {
    let mut faces = vec![(0.0, 0.0); stack.bodies().len()];
    let mut below = support;
    for (i, body) in stack.bodies().iter().enumerate().rev() {
        let load_on_top: f64 =
            stack.bodies()[..i].iter().map(Body::mass).sum::<f64>() * stack.gravity();
        let own_weight = body.mass() * stack.gravity();
        let shortening = (load_on_top + 0.5 * own_weight) * body.length() / body.axial_rigidity();
        let bottom = below + contacts[i].closure;
        faces[i] = (bottom + shortening, bottom);
        below = bottom + shortening;
    }
    faces
}
