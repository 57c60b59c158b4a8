//! The numbers that a step depends on, and their derivatives.

use crate::difference::central_difference;
use crate::modal::load_steps::LoadSteps;
use crate::modal::oscillator::NODES;
use crate::modal::step_model::StepModel;

/// Coefficients of one mode in a step.
#[derive(Debug, Clone)]
pub(super) struct ModeInputs {
    pub(super) decay: f64,
    pub(super) spring: f64,
    pub(super) contact: [f64; NODES + 1],
    /// Participation of the sensor.
    pub(super) sensor: f64,
    /// Of the load's mean and rise in this step, and in the step before.
    pub(super) load: [f64; 4],
    pub(super) closure: Vec<f64>,
    pub(super) force: Vec<f64>,
}

/// Everything that the steps of a case depend on, except the laws; or the derivatives of it.
#[derive(Debug, Clone)]
pub(super) struct Inputs {
    pub(super) modes: Vec<ModeInputs>,
    pub(super) coupling: Vec<Vec<f64>>,
    pub(super) closure_per_load: Vec<f64>,
    pub(super) sensor_per_pressure: Vec<f64>,
    pub(super) sensor_per_load: f64,
    /// Static pressure at every interface \[Pa\].
    pub(super) pressure: Vec<f64>,
    /// Load at time zero.
    pub(super) start: f64,
    pub(super) load_steps: LoadSteps,
}

impl Inputs {
    pub(super) fn new(
        (model, sensor): (&StepModel, usize),
        pressure: Vec<f64>,
        start: f64,
        load_steps: LoadSteps,
    ) -> Self {
        let mode = |mode: &crate::modal::step_model::ModeStep| ModeInputs {
            decay: mode.recurrence.decay,
            spring: mode.recurrence.spring,
            contact: mode.recurrence.contact,
            sensor: mode.sensors[sensor],
            load: mode.recurrence.load.map(|tap| mode.load * tap),
            closure: mode.closure.clone(),
            force: mode.force.clone(),
        };
        Self {
            modes: model.modes.iter().map(mode).collect(),
            coupling: model.coupling.clone(),
            closure_per_load: model.residual.load.clone(),
            sensor_per_pressure: model.sensors_per_pressure[sensor].clone(),
            sensor_per_load: model.residual.sensors_per_load[sensor],
            pressure,
            start,
            load_steps,
        }
    }

    /// The derivatives of the inputs from four of them, of as many modes and interfaces.
    pub(super) fn difference(four: &[Self; 4], step: f64) -> Self {
        let [first, ..] = four;
        let slope = |of: &dyn Fn(&Self) -> f64| central_difference(four.each_ref().map(of), step);
        let row = |length: usize, of: &dyn Fn(&Self, usize) -> f64| -> Vec<f64> {
            (0..length).map(|i| slope(&|inputs| of(inputs, i))).collect()
        };
        let rows = first.coupling.len();
        let mode = |m: usize| ModeInputs {
            decay: slope(&|inputs| inputs.modes[m].decay),
            spring: slope(&|inputs| inputs.modes[m].spring),
            contact: std::array::from_fn(|k| slope(&|inputs| inputs.modes[m].contact[k])),
            sensor: slope(&|inputs| inputs.modes[m].sensor),
            load: std::array::from_fn(|k| slope(&|inputs| inputs.modes[m].load[k])),
            closure: row(rows, &|inputs, i| inputs.modes[m].closure[i]),
            force: row(rows, &|inputs, i| inputs.modes[m].force[i]),
        };
        // Beyond its last step a load is zero.
        let lasting = four.iter().map(|inputs| inputs.load_steps.steps()).max().unwrap_or(0);
        let at = |column: &[f64], n: usize| column.get(n).copied().unwrap_or(0.0);
        Self {
            modes: (0..first.modes.len()).map(mode).collect(),
            coupling: (0..rows).map(|i| row(rows, &|inputs, j| inputs.coupling[i][j])).collect(),
            closure_per_load: row(rows, &|inputs, i| inputs.closure_per_load[i]),
            sensor_per_pressure: row(rows, &|inputs, i| inputs.sensor_per_pressure[i]),
            sensor_per_load: slope(&|inputs| inputs.sensor_per_load),
            pressure: row(first.pressure.len(), &|inputs, i| inputs.pressure[i]),
            start: slope(&|inputs| inputs.start),
            load_steps: LoadSteps {
                mean: row(lasting, &|inputs, n| at(&inputs.load_steps.mean, n)),
                rise: row(lasting, &|inputs, n| at(&inputs.load_steps.rise, n)),
                end: row(lasting, &|inputs, n| at(&inputs.load_steps.end, n)),
            },
        }
    }

    /// Mean and rise of the load in step `n`, and in the step before, and its end.
    pub(super) fn load(&self, n: usize) -> StepLoad {
        let at = |column: &[f64], n: Option<usize>| {
            n.and_then(|n| column.get(n)).copied().unwrap_or(0.0)
        };
        let (now, before) = (Some(n), n.checked_sub(1));
        let LoadSteps { mean, rise, end } = &self.load_steps;
        let taps = [at(mean, now), at(rise, now), at(mean, before), at(rise, before)];
        StepLoad { taps, end: at(end, now) }
    }

    /// The load at steps 0 to `steps`.
    pub(super) fn loads(&self, steps: usize) -> Vec<f64> {
        let mut loads = vec![0.0; steps + 1];
        loads[0] = self.start;
        for (place, end) in loads[1..].iter_mut().zip(&self.load_steps.end) {
            *place = *end;
        }
        loads
    }
}

/// The load in one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepLoad {
    pub(super) taps: [f64; 4],
    pub(super) end: f64,
}

impl ModeInputs {
    /// Share of the load in the increment of a step.
    pub(super) fn pushed(&self, load: &StepLoad) -> f64 {
        self.load.iter().zip(&load.taps).map(|(b, tap)| b * tap).sum()
    }
}
