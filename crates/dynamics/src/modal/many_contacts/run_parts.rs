//! Parts of a run: the flexibility of modes left out, and extremes of contacts.

use asperity_mesh::{ComponentModes, PortPair};
use faer::Mat;

use crate::ContactExtremes;

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
