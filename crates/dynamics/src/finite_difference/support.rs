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
    /// Displacement \[m\] at the state that the latest step reached, and one and two steps earlier.
    next: f64,
    now: f64,
    before: f64,
    own: f64,
    past: f64,
    /// Displacement per force and step \[m/N\].
    pub(super) compliance: f64,
    stiffness: f64,
    /// Mass \[kg\], zero for a rigid support.
    pub(super) mass: f64,
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

    /// A step under `acceleration` \[m/s2\], without the contact force.
    pub(super) fn advance(&mut self, acceleration: f64) {
        (self.before, self.now) = (self.now, self.next);
        self.next = self.own * self.now - self.past * self.before;
        self.push(self.mass * acceleration);
    }

    /// Adds what `force` \[N\] does in this step.
    pub(super) fn push(&mut self, force: f64) {
        self.next += force * self.compliance;
    }

    /// Displacement at the state that the latest step reached \[m\].
    pub(super) fn reached(&self) -> f64 {
        self.next
    }

    /// Travel \[m\] over the last two steps.
    pub(super) fn travel(&self) -> f64 {
        self.next - self.before
    }

    /// Counts the viscous loss of a step whose forces have all been taken up.
    pub(super) fn complete(&mut self) {
        self.loss += self.loss_factor * self.travel() * self.travel();
    }

    /// Kinetic and elastic energy \[J\] half a step before the newest state.
    pub(super) fn energy(&self, step: f64) -> (f64, f64) {
        let velocity = (self.next - self.now) / step;
        (0.5 * self.mass * velocity * velocity, 0.5 * self.stiffness * self.next * self.now)
    }
}
