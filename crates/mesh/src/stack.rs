//! The chain of bodies and interfaces on its support.

use std::sync::Arc;

use asperity_law::{ContactDamping, ContactLaw, Friction};

use crate::error::{MeshError, not_negative, positive};
use crate::{Body, BodyDamping};

/// A rough contact: name, nominal area, the law of its pressure, and damping and friction, if it has
/// any.
#[derive(Debug, Clone)]
pub struct Interface {
    name: String,
    area: f64,
    law: Arc<dyn ContactLaw>,
    damping: Option<ContactDamping>,
    friction: Option<Friction>,
}

impl Interface {
    /// An interface of nominal contact `area` \[m2\] that follows `law`.
    ///
    /// # Errors
    /// [`MeshError::NotPositive`] for an area that is not positive and finite.
    pub fn new(name: &str, area: f64, law: Arc<dyn ContactLaw>) -> Result<Self, MeshError> {
        let area = positive(name, "area [m2]", area)?;
        Ok(Self { name: name.to_owned(), area, law, damping: None, friction: None })
    }

    /// The interface with viscous `damping`.
    #[must_use]
    pub fn with_damping(self, damping: ContactDamping) -> Self {
        Self { damping: Some(damping), ..self }
    }

    /// The interface with a friction element across its closure; a coefficient is one of its own
    /// contact force.
    #[must_use]
    pub fn with_friction(self, friction: Friction) -> Self {
        Self { friction: Some(friction), ..self }
    }

    /// Name, for messages and outputs.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Nominal contact area S \[m2\].
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The contact law.
    pub fn law(&self) -> &Arc<dyn ContactLaw> {
        &self.law
    }

    /// The viscous damping, if there is any.
    pub fn damping(&self) -> Option<ContactDamping> {
        self.damping
    }

    /// The friction element, if there is any.
    pub fn friction(&self) -> Option<Friction> {
        self.friction
    }
}

/// Support of the lowest interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support {
    /// An immovable face: the paper's massive disc.
    Rigid,
    /// A mass on a spring and a viscous damper: a compliant disc.
    SpringMass {
        /// Stiffness k \[N/m\].
        stiffness: f64,
        /// Mass m \[kg\].
        mass: f64,
        /// Damping ratio of the support alone, `c / (2 sqrt(k m))`.
        damping_ratio: f64,
    },
}

impl Support {
    /// Viscous coefficient of the support's own damper, `2 zeta sqrt(k m)` \[N s/m\].
    pub fn damping(&self) -> f64 {
        match *self {
            Self::Rigid => 0.0,
            Self::SpringMass { stiffness, mass, damping_ratio } => {
                2.0 * damping_ratio * (stiffness * mass).sqrt()
            }
        }
    }

    fn check(&self) -> Result<(), MeshError> {
        if let Self::SpringMass { stiffness, mass, damping_ratio } = *self {
            positive("support", "stiffness [N/m]", stiffness)?;
            positive("support", "mass [kg]", mass)?;
            not_negative("support", "damping ratio", damping_ratio)?;
            not_negative("support", "damping coefficient [N s/m]", self.damping())?;
        }
        Ok(())
    }
}

/// Bodies from the free top down, an interface below each, the last on the support.
///
/// ```
/// use std::sync::Arc;
///
/// use asperity_law::Constant;
/// use asperity_mesh::{Body, Interface, Stack, Support};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let guide = Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0)?;
/// let contact = Interface::new("guide-disc", 1.15e-4, Arc::new(Constant::new(8.5e11)?))?;
/// let stack = Stack::new(vec![guide], vec![contact], Support::Rigid, 9.81)?;
/// assert!((stack.static_pressures()[0] / (1.61 * 9.81 / 1.15e-4) - 1.0).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Stack {
    bodies: Vec<Body>,
    interfaces: Vec<Interface>,
    support: Support,
    gravity: f64,
}

impl Stack {
    /// The same stack with this internal damping of every body.
    #[must_use]
    pub fn with_body_damping(self, damping: BodyDamping) -> Self {
        let bodies = self.bodies.into_iter().map(|body| body.with_damping(damping)).collect();
        Self { bodies, ..self }
    }

    /// A stack under `gravity` \[m/s2\], bodies and interfaces from the top down.
    ///
    /// # Errors
    /// [`MeshError`] when there is no body, when interfaces and bodies are not
    /// equally many, or when gravity or a support value is out of range.
    pub fn new(
        bodies: Vec<Body>,
        interfaces: Vec<Interface>,
        support: Support,
        gravity: f64,
    ) -> Result<Self, MeshError> {
        if bodies.is_empty() {
            return Err(MeshError::NoBodies);
        }
        if bodies.len() != interfaces.len() {
            return Err(MeshError::InterfaceCount {
                bodies: bodies.len(),
                interfaces: interfaces.len(),
            });
        }
        not_negative("stack", "gravity [m/s2]", gravity)?;
        support.check()?;
        Ok(Self { bodies, interfaces, support, gravity })
    }

    /// Bodies, from the top down.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Interfaces, from the top down; interface `i` lies below body `i`.
    pub fn interfaces(&self) -> &[Interface] {
        &self.interfaces
    }

    /// The support below the last interface.
    pub fn support(&self) -> &Support {
        &self.support
    }

    /// Gravity g \[m/s2\].
    pub fn gravity(&self) -> f64 {
        self.gravity
    }

    /// Pressure that the weight above each interface exerts on it, `sum(m) g / S` \[Pa\].
    ///
    /// A chain is statically determinate: these are the static pressures,
    /// whatever the laws. For the paper's rig both are about 0.14 MPa.
    pub fn static_pressures(&self) -> Vec<f64> {
        static_pressures(&self.bodies, self.interfaces.iter().map(Interface::area), self.gravity)
    }
}

/// The static pressures of [`Stack::static_pressures`] without laws, for laws that count their
/// closure from the static pressure.
pub fn static_pressures(
    bodies: &[Body],
    areas: impl IntoIterator<Item = f64>,
    gravity: f64,
) -> Vec<f64> {
    let carried = bodies.iter().scan(0.0, |mass, body| {
        *mass += body.mass();
        Some(*mass)
    });
    carried.zip(areas).map(|(mass, area)| mass * gravity / area).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_law::Constant;

    fn rig() -> (Vec<Body>, Vec<Interface>) {
        let law: Arc<dyn ContactLaw> = Arc::new(Constant::new(8.5e11).unwrap());
        (
            vec![
                Body::with_mass("guide", 0.229, 1.61, 71e9, 2710.0).unwrap(),
                Body::new("sample", 0.015, 1.15e-4, 71e9, 2710.0).unwrap(),
            ],
            vec![
                Interface::new("guide-sample", 1.15e-4, Arc::clone(&law)).unwrap(),
                Interface::new("sample-disc", 1.15e-4, law).unwrap(),
            ],
        )
    }

    /// The paper's 0.14 MPa: 1.61 kg on 1.15e-4 m2, and 4.7 g more below the sample.
    #[test]
    fn the_weight_above_sets_the_static_pressure() {
        let (bodies, interfaces) = rig();
        let stack = Stack::new(bodies, interfaces, Support::Rigid, 9.81).unwrap();
        let pressures = stack.static_pressures();
        assert!((pressures[0] - 1.61 * 9.81 / 1.15e-4).abs() < 1e-6);
        let sample = 2710.0 * 0.015 * 1.15e-4;
        assert!((pressures[1] - (1.61 + sample) * 9.81 / 1.15e-4).abs() < 1e-6);
    }

    #[test]
    fn incomplete_stacks_are_errors() {
        let (bodies, interfaces) = rig();
        assert_eq!(
            Stack::new(vec![], vec![], Support::Rigid, 9.81).unwrap_err(),
            MeshError::NoBodies
        );
        assert_eq!(
            Stack::new(bodies.clone(), interfaces[..1].to_vec(), Support::Rigid, 9.81).unwrap_err(),
            MeshError::InterfaceCount { bodies: 2, interfaces: 1 }
        );
        assert!(Stack::new(bodies.clone(), interfaces.clone(), Support::Rigid, f64::NAN).is_err());
        for (stiffness, mass, damping_ratio) in
            [(0.0, 1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, -0.1), (f64::INFINITY, 1.0, 0.0)]
        {
            let support = Support::SpringMass { stiffness, mass, damping_ratio };
            assert!(Stack::new(bodies.clone(), interfaces.clone(), support, 9.81).is_err());
        }
    }
}
