//! Parts of a run: modes with their steps, the flexibility of modes left out, and extremes of contacts.

use asperity_mesh::{ComponentModes, NormalMode, PortPair};
use faer::Mat;

use crate::ContactExtremes;
use crate::modal::oscillator::{Dynamics, Propagator};

/// A mode and its step.
pub(super) struct SteppedMode {
    pub(super) closures: Vec<f64>,
    pub(super) load: f64,
    pub(super) sensors: Vec<f64>,
    pub(super) dynamics: Dynamics,
    pub(super) propagator: Propagator,
    /// Of the force at the old and the new end, in the new displacement and velocity.
    pub(super) old: [f64; 2],
    pub(super) new: [f64; 2],
}

impl SteppedMode {
    /// The step of `mode` \[s\] under a mass-proportional `rate` \[1/s\], with the closures of `pairs`, under a load and at sensors
    /// at these ports.
    pub(super) fn new(
        mode: &NormalMode,
        (rate, step): (f64, f64),
        pairs: &[PortPair],
        (load, sensors): (usize, &[usize]),
    ) -> Self {
        let dynamics = Dynamics {
            angular_frequency: mode.angular_frequency,
            rate: mode.total_damping(rate),
            massless: mode.massless,
        };
        let propagator = dynamics.propagator(step);
        let [constant, linear] = [propagator.moments[0], propagator.moments[1]];
        let (old, new) = if mode.massless {
            ([constant[0] - linear[0], 0.0], [linear[0], 0.0])
        } else {
            let half = constant.map(|moment| 0.5 * moment);
            (half, half)
        };
        Self {
            closures: pairs.iter().map(|&pair| mode.closure(pair)).collect(),
            load: mode.ports[load],
            sensors: sensors.iter().map(|&sensor| mode.ports[sensor]).collect(),
            dynamics,
            propagator,
            old,
            new,
        }
    }
}

/// Flexibility of the modes left out.
pub(super) struct Residual {
    pub(super) closures: Mat<f64>,
    pub(super) load: Vec<f64>,
    pub(super) sensors: Vec<Vec<f64>>,
    pub(super) sensors_load: Vec<f64>,
    pub(super) own: f64,
}

impl Residual {
    pub(super) fn new(modes: &ComponentModes, load: usize, sensors: &[usize]) -> Self {
        let (pairs, residual) = (modes.contacts(), modes.residual());
        let of = |port: usize| {
            let ground = PortPair::on_ground(port);
            pairs.iter().map(|&pair| residual.closure(ground, pair)).collect::<Vec<f64>>()
        };
        Self {
            closures: Mat::from_fn(pairs.len(), pairs.len(), |i, j| {
                residual.closure(pairs[i], pairs[j])
            }),
            load: of(load),
            sensors: sensors.iter().map(|&sensor| of(sensor)).collect(),
            sensors_load: sensors.iter().map(|&sensor| residual.get(sensor, load)).collect(),
            own: residual.get(load, load),
        }
    }
}

/// Extremes of a contact so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extremes {
    pub(super) pressure_min: f64,
    pub(super) pressure_max: f64,
    pub(super) lost: f64,
    pub(super) stiffness_sum: f64,
}

impl Extremes {
    /// Nothing seen but the rest at `pressure` \[Pa\].
    pub(super) fn at(pressure: f64) -> Self {
        Self { pressure_min: pressure, pressure_max: pressure, lost: 0.0, stiffness_sum: 0.0 }
    }

    pub(super) fn finished(&self, steps: usize) -> ContactExtremes {
        ContactExtremes {
            pressure_min: self.pressure_min,
            pressure_max: self.pressure_max,
            lost: self.lost,
            stiffness_average: self.stiffness_sum / steps.max(1) as f64,
        }
    }
}

/// Part of a line from `old` to `new` that is below zero.
pub(super) fn share_below_zero(old: f64, new: f64) -> f64 {
    match (old < 0.0, new < 0.0) {
        (true, true) => 1.0,
        (false, false) => 0.0,
        (true, false) => old / (old - new),
        (false, true) => new / (new - old),
    }
}
