//! The step of a spring-mass support.

use asperity_mesh::Support;

/// A mass on a spring and a damper, by centred differences:
///
/// ```text
/// m (w+ - 2 w + w-) / dt^2 + c (w+ - w-) / (2 dt) + k w = push
/// ```
///
/// A rigid support is the same with every coefficient zero.
#[derive(Debug, Default)]
pub(super) struct SupportStep {
    now: f64,
    before: f64,
    own: f64,
    past: f64,
    /// Displacement per force and step \[m/N\].
    pub(super) compliance: f64,
    stiffness: f64,
    mass: f64,
    /// `c / (4 dt)`: loss per square of the travel over two steps \[J/m2\].
    loss_factor: f64,
    /// Viscous loss so far \[J\].
    pub(super) loss: f64,
}

impl SupportStep {
    pub(super) fn new(support: &Support, step: f64) -> Self {
        let Support::SpringMass { stiffness, mass, .. } = *support else {
            return Self::default();
        };
        let damping = support.damping();
        let a = 0.5 * damping * step / mass;
        Self {
            own: (2.0 - stiffness * step * step / mass) / (1.0 + a),
            past: (1.0 - a) / (1.0 + a),
            compliance: step * step / (mass * (1.0 + a)),
            stiffness,
            mass,
            loss_factor: 0.25 * damping / step,
            ..Self::default()
        }
    }

    /// The displacement \[m\] that a step would reach without the contact force.
    #[inline(always)]
    pub(super) fn unloaded(&self) -> f64 {
        self.own * self.now - self.past * self.before
    }

    /// Moves on to the displacement `reached` \[m\], and counts the viscous loss.
    #[inline(always)]
    pub(super) fn advance(&mut self, reached: f64) {
        let travel = reached - self.before;
        self.loss += self.loss_factor * travel * travel;
        (self.now, self.before) = (reached, self.now);
    }

    /// Kinetic and elastic energy \[J\] half a step before the newest state.
    pub(super) fn energy(&self, step: f64) -> (f64, f64) {
        let velocity = (self.now - self.before) / step;
        (0.5 * self.mass * velocity * velocity, 0.5 * self.stiffness * self.now * self.before)
    }
}
