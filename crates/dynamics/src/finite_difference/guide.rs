//! Friction of a body in its guide.

use asperity_mesh::BarGrid;
use asperity_structure::Guide;

use crate::DynamicsError;
use crate::friction_force::FrictionForce;

/// Square of the radians a step up to which the stuck element may turn its body: explicit steps
/// are unstable from 4 on.
const LARGEST_SQUARE: f64 = 1.0;

/// A body in its guide: the mean displacement u of the bar, with the friction force at it, and the
/// part r of the displacement that friction causes.
///
/// The force is spread over the nodes by their mass, so that it moves the bar as a whole. Eq. (4)
/// is linear: the displacement of a node is that without friction and r, where
///
/// ```text
/// r+ = ((2 + a2) r - r- - dt^2 f(u) / m) / (1 + a2),
/// u+ = ((2 + a2) u - u- + dt^2 (F - f(u)) / m) / (1 + a2)
/// ```
///
/// with F the force on the ends. A slip force that is a share of that of a contact takes its
/// pressure from the step before.
pub(super) struct GuideStep {
    /// Number of the guided body, and of the contact of a coefficient.
    pub(super) body: usize,
    pub(super) contact: usize,
    friction: FrictionForce,
    mass: f64,
    own: f64,
    past: f64,
    /// Displacement of the bar per force and step \[m/N\].
    compliance: f64,
    /// u at the newest state and before, r likewise.
    mean: [f64; 2],
    shift: [f64; 3],
}

impl GuideStep {
    /// The guide of body `body` with the nodes of `grid` under the damping `rate` \[1/s\].
    pub(super) fn new(
        guide: &Guide,
        body: usize,
        grid: &BarGrid,
        step: f64,
        rate: f64,
    ) -> Result<Self, DynamicsError> {
        let mass = grid.cell_mass() * (grid.nodes() - 1) as f64;
        let square = guide.friction().stiffness() * step * step / mass;
        if square > LARGEST_SQUARE {
            return Err(DynamicsError::Setting {
                quantity: "stiffness of the friction in a guide times the square of the step over the mass of the body",
                value: square,
                accepted: "at most 1 with finite differences (the modal method takes any)",
            });
        }
        let a2 = rate * step;
        Ok(Self {
            body,
            contact: guide.contact(),
            friction: FrictionForce::new(guide.friction()),
            mass,
            own: (2.0 + a2) / (1.0 + a2),
            past: -1.0 / (1.0 + a2),
            compliance: step * step / (mass * (1.0 + a2)),
            mean: [0.0; 2],
            shift: [0.0; 3],
        })
    }

    /// Takes up the force at the newest state, where the contact carries `contact_force` \[N\], and
    /// moves r on to the next.
    pub(super) fn begin(&mut self, contact_force: f64) {
        let limit = self.friction.limit(contact_force);
        let force = self.friction.at(self.mean[0], limit);
        self.friction.advance(self.mean[0], force);
        let next = self.own * self.shift[0] + self.past * self.shift[1];
        let next = next - self.compliance * force;
        self.shift = [next, self.shift[0], self.shift[1]];
    }

    /// r at the state that the step leads to, and at two before \[m\].
    pub(super) fn shift(&self) -> [f64; 3] {
        self.shift
    }

    /// Completes the step under `force` \[N\] on the ends.
    pub(super) fn advance(&mut self, force: f64) {
        let next = self.own * self.mean[0] + self.past * self.mean[1];
        let next = next + self.compliance * (force - self.friction.force);
        self.friction.count(0.5 * (next - self.mean[1]));
        self.mean = [next, self.mean[0]];
    }

    /// Kinetic energy half a step before the newest state beyond that of the nodes without friction
    /// \[J\].
    pub(super) fn kinetic(&self, step: f64) -> f64 {
        let mean = (self.mean[0] - self.mean[1]) / step;
        let shift = (self.shift[0] - self.shift[1]) / step;
        self.mass * shift * (mean - 0.5 * shift)
    }

    /// Energy of the spring, and loss so far \[J\].
    pub(super) fn energy(&self) -> (f64, f64) {
        self.friction.energy()
    }
}
