//! Component modes as a step sees them: closures of rows, one load, sensors.
//!
//! The rows of a step are the contacts and, behind them, the guides with friction. An element across
//! the closure of a contact adds to the traction there. A guide is a row without pressure: its
//! closure is the displacement in the guide, and its traction, on an area of 1 m2, the force of the
//! element.

use asperity_mesh::{ComponentModes, NormalMode, PortPair};

/// One mode and its participations \[kg^-1/2\].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RowMode {
    pub(super) angular_frequency: f64,
    /// True if the mass-proportional damping of the bodies acts on it.
    pub(super) mass_damped: bool,
    /// Damping rate of its own \[1/s\].
    pub(super) damping_rate: f64,
    /// True if its inertia is neglected.
    pub(super) massless: bool,
    /// Of the closure of each row.
    pub(super) closure: Vec<f64>,
    /// Of the port that is loaded.
    pub(super) load: f64,
    /// Of each sensor.
    pub(super) sensors: Vec<f64>,
}

impl RowMode {
    /// Damping rate of the mode \[1/s\] under the mass-proportional damping `mass_damping` \[1/s\].
    pub(super) fn total_damping(&self, mass_damping: f64) -> f64 {
        self.damping_rate + if self.mass_damped { mass_damping } else { 0.0 }
    }
}

/// Flexibility of the modes left out \[m/N\].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RowFlexibility {
    /// Closure of row i per force at row j.
    pub(super) closure: Vec<Vec<f64>>,
    /// Closure of each row per load, and load port per force at each row.
    pub(super) load: Vec<f64>,
    /// Each sensor per force at each row.
    pub(super) sensors: Vec<Vec<f64>>,
    /// Each sensor per load.
    pub(super) sensors_per_load: Vec<f64>,
    /// Load port per load.
    pub(super) load_port: f64,
}

impl RowFlexibility {
    /// Adds the static flexibility of `mode`, which must not be rigid: the mode is left out then.
    pub(super) fn add(&mut self, mode: &RowMode) {
        let yielding = mode.angular_frequency.powi(-2);
        for (row, g) in self.closure.iter_mut().zip(&mode.closure) {
            for (entry, other) in row.iter_mut().zip(&mode.closure) {
                *entry += g * other * yielding;
            }
        }
        for (entry, g) in self.load.iter_mut().zip(&mode.closure) {
            *entry += g * mode.load * yielding;
        }
        let sensors = self.sensors.iter_mut().zip(&mut self.sensors_per_load);
        for ((row, per_load), sensor) in sensors.zip(&mode.sensors) {
            for (entry, g) in row.iter_mut().zip(&mode.closure) {
                *entry += g * sensor * yielding;
            }
            *per_load += mode.load * sensor * yielding;
        }
        self.load_port += mode.load * mode.load * yielding;
    }
}

/// The modes of a structure in the rows of its steps, with one loaded port and its sensors.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RowModes {
    pub(super) modes: Vec<RowMode>,
    pub(super) residual: RowFlexibility,
}

impl RowModes {
    /// The rows of `structure` under a load at port `load`, read at the ports `sensors`.
    pub(super) fn new(structure: &ComponentModes, load: usize, sensors: &[usize]) -> Self {
        let pairs = structure.pairs();
        let mode = |mode: &NormalMode| RowMode {
            angular_frequency: mode.angular_frequency,
            mass_damped: mode.mass_damped,
            damping_rate: mode.damping_rate,
            massless: mode.massless,
            closure: pairs.iter().map(|&pair| mode.closure(pair)).collect(),
            load: mode.ports[load],
            sensors: sensors.iter().map(|&sensor| mode.ports[sensor]).collect(),
        };
        let residual = structure.residual();
        let per_row = |port: usize| -> Vec<f64> {
            let port = PortPair::on_ground(port);
            pairs.iter().map(|&pair| residual.closure(port, pair)).collect()
        };
        let closure =
            |&row: &PortPair| pairs.iter().map(|&column| residual.closure(row, column)).collect();
        Self {
            modes: structure.modes().iter().map(mode).collect(),
            residual: RowFlexibility {
                closure: pairs.iter().map(closure).collect(),
                load: per_row(load),
                sensors: sensors.iter().map(|&sensor| per_row(sensor)).collect(),
                sensors_per_load: sensors.iter().map(|&s| residual.get(s, load)).collect(),
                load_port: residual.get(load, load),
            },
        }
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.residual.closure.len()
    }
}
