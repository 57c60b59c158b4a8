//! Friction of a body in its guide.

use asperity_structure::Guide;

use super::bar::Bar;
use crate::DynamicsError;
use crate::friction_force::FrictionForce;

/// Square of the radians a step up to which the stuck element may turn its body: explicit steps
/// are unstable from 4 on.
const LARGEST_SQUARE: f64 = 1.0;

/// The friction f(u) of a body in its guide, u being the displacement of its centre of mass.
///
/// The force is spread over the nodes by their mass, so that it moves the bar as a whole: each node of
/// Eq. (4) has the acceleration `-f(u) / m` more. A slip force that is a share of a contact force
/// takes the pressure from the step before.
pub(super) struct GuideStep {
    /// Number of the guided body, and of the contact of a coefficient.
    pub(super) body: usize,
    pub(super) contact: usize,
    friction: FrictionForce,
    mass: f64,
    /// u at the newest state and before.
    mean: [f64; 2],
}

impl GuideStep {
    /// The guide of body `body` with the nodes of `bar`.
    pub(super) fn new(
        guide: &Guide,
        body: usize,
        bar: &Bar,
        step: f64,
    ) -> Result<Self, DynamicsError> {
        let mass = bar.mass();
        let square = guide.friction().stiffness() * step * step / mass;
        if square > LARGEST_SQUARE {
            return Err(DynamicsError::Setting {
                quantity: "stiffness of the friction in a guide times the square of the step over the mass of the body",
                value: square,
                accepted: "at most 1 with finite differences (the modal method takes any)",
            });
        }
        let friction = FrictionForce::new(guide.friction());
        Ok(Self { body, contact: guide.contact(), friction, mass, mean: [0.0; 2] })
    }

    /// Acceleration \[m/s2\] that friction gives the nodes in the step from the newest state, where the
    /// contact carries `contact_force` \[N\].
    pub(super) fn acceleration(&mut self, contact_force: f64) -> f64 {
        let limit = self.friction.limit(contact_force);
        let force = self.friction.at(self.mean[0], limit);
        self.friction.advance(self.mean[0], force);
        -force / self.mass
    }

    /// Completes the step that brought the centre of mass to `reached` \[m\].
    pub(super) fn complete(&mut self, reached: f64) {
        self.friction.count(0.5 * (reached - self.mean[1]));
        self.mean = [reached, self.mean[0]];
    }

    /// Energy of the spring, and loss so far \[J\].
    pub(super) fn energy(&self) -> (f64, f64) {
        self.friction.energy()
    }
}
