//! The force of a friction element along a motion known at steps.

use asperity_law::Friction;

/// A friction element on its way: force and displacement at the last step, loss so far.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrictionForce {
    element: Friction,
    /// Force at the last step \[N\].
    pub(crate) force: f64,
    displacement: f64,
    /// Work done on the element \[J\].
    work: f64,
}

impl FrictionForce {
    /// The element at rest, without force.
    pub(crate) fn new(element: Friction) -> Self {
        Self { element, force: 0.0, displacement: 0.0, work: 0.0 }
    }

    /// Slip force \[N\] where the contact carries `contact_force` \[N\].
    pub(crate) fn limit(&self, contact_force: f64) -> f64 {
        self.element.limit(contact_force)
    }

    /// Force \[N\] at `displacement` \[m\] under the slip force `limit` \[N\].
    pub(crate) fn at(&self, displacement: f64, limit: f64) -> f64 {
        self.element.force(self.force, displacement - self.displacement, limit)
    }

    /// Goes on to a displacement \[m\] with its force \[N\].
    pub(crate) fn advance(&mut self, displacement: f64, force: f64) {
        (self.displacement, self.force) = (displacement, force);
    }

    /// Counts a `travel` \[m\] under the force of the last step.
    pub(crate) fn count(&mut self, travel: f64) {
        self.work += self.force * travel;
    }

    /// Energy of the spring, and loss so far \[J\].
    pub(crate) fn energy(&self) -> (f64, f64) {
        let stored = 0.5 * self.force * self.force / self.element.stiffness();
        (stored, self.work - stored)
    }
}
