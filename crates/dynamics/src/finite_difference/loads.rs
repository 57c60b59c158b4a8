//! Loads on the bodies and places where their motion is sampled.

use super::bar::Bar;
use crate::Excitation;

/// A place along a body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// Number of the body, from the top down.
    pub(crate) body: usize,
    /// Distance from the upper end over the length of the body, from 0 to 1.
    pub(crate) fraction: f64,
}

impl Place {
    /// The top of the stack.
    pub(crate) const TOP: Self = Self { body: 0, fraction: 0.0 };

    /// The two nodes of `bar` around the place with their weights, linear in the distance: one of them
    /// is 1 at a node.
    pub(super) fn nodes(self, bar: &Bar) -> [(usize, f64); 2] {
        let along = self.fraction * bar.last() as f64;
        let left = (along as usize).min(bar.last() - 1);
        let right = along - left as f64;
        [(left, 1.0 - right), (left + 1, right)]
    }
}

/// The loads of a run: forces at places, and a motion of the base.
#[derive(Debug, Clone)]
pub(crate) struct Loads<'a> {
    /// Forces \[N\] at places, positive ones down.
    pub(crate) forces: Vec<(Place, &'a Excitation)>,
    /// Acceleration of the base \[m/s2\], positive down: each node and the mass of the support carries
    /// `-m a(t)`, and displacements are relative to the base.
    pub(crate) base_acceleration: Option<&'a Excitation>,
}

impl Loads<'_> {
    /// Largest force \[N\] on the `bars` and a support of `support_mass` \[kg\] together.
    pub(super) fn peak(&self, bars: &[Bar], support_mass: f64) -> f64 {
        let forces: f64 = self.forces.iter().map(|(_, force)| force.peak()).sum();
        let mass = support_mass + bars.iter().map(Bar::mass).sum::<f64>();
        forces + self.base_acceleration.map_or(0.0, |acceleration| mass * acceleration.peak())
    }
}

/// Samples of the motion at one place.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct SensorHistory {
    /// Displacement from rest, relative to the base \[m\].
    pub(crate) displacement: Vec<f64>,
    /// Velocity \[m/s\], `(w+ - w-) / (2 dt)`.
    pub(crate) velocity: Vec<f64>,
    /// Acceleration \[m/s2\], `(w+ - 2 w + w-) / dt^2`.
    pub(crate) acceleration: Vec<f64>,
}

impl SensorHistory {
    /// Adds a sample of three successive displacements \[m\], the last first, `step` \[s\] apart.
    pub(super) fn push(&mut self, [after, now, before]: [f64; 3], step: f64) {
        self.displacement.push(now);
        self.velocity.push((after - before) / (2.0 * step));
        self.acceleration.push((after - 2.0 * now + before) / (step * step));
    }

    /// The motion starts at rest: its image before t = 0 is w(-dt) = w(dt).
    pub(super) fn start_at_rest(&mut self) {
        self.velocity[0] = 0.0;
        self.acceleration[0] *= 2.0;
    }
}
