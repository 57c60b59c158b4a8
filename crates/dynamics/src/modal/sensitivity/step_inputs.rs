//! The numbers that a step depends on, and their derivatives.

use crate::difference::central_difference;
use crate::modal::drive::DriveForce;
use crate::modal::oscillator::NODES;
use crate::modal::step_model::StepModel;

/// Coefficients of one mode in a step.
#[derive(Debug, Clone)]
pub(super) struct ModeInputs {
    pub(super) decay: f64,
    pub(super) spring: f64,
    pub(super) contact: [f64; NODES + 1],
    pub(super) output: f64,
    /// Of the drive's mean and rise in this step, and in the step before.
    pub(super) drive: [f64; 4],
    pub(super) closure: Vec<f64>,
    pub(super) force: Vec<f64>,
}

/// Everything that the steps of a hit depend on, except the laws; or the derivatives of it.
#[derive(Debug, Clone)]
pub(super) struct Inputs {
    pub(super) modes: Vec<ModeInputs>,
    pub(super) coupling: Vec<Vec<f64>>,
    pub(super) drive_closure: Vec<f64>,
    pub(super) output_pressure: Vec<f64>,
    pub(super) output_drive: f64,
    /// Static pressure at every interface \[Pa\].
    pub(super) pressure: Vec<f64>,
    /// Force at time zero \[N\].
    pub(super) start: f64,
    pub(super) drive_force: DriveForce,
}

impl Inputs {
    pub(super) fn new(
        model: &StepModel,
        pressure: Vec<f64>,
        start: f64,
        drive_force: DriveForce,
    ) -> Self {
        let mode = |mode: &crate::modal::step_model::ModeStep| ModeInputs {
            decay: mode.recurrence.decay,
            spring: mode.recurrence.spring,
            contact: mode.recurrence.contact,
            output: mode.output,
            drive: mode.recurrence.drive.map(|tap| mode.drive * tap),
            closure: mode.closure.clone(),
            force: mode.force.clone(),
        };
        Self {
            modes: model.modes.iter().map(mode).collect(),
            coupling: model.coupling.clone(),
            drive_closure: model.residual.drive.clone(),
            output_pressure: model.output_pressure.clone(),
            output_drive: model.residual.direct,
            pressure,
            start,
            drive_force,
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
            output: slope(&|inputs| inputs.modes[m].output),
            drive: std::array::from_fn(|k| slope(&|inputs| inputs.modes[m].drive[k])),
            closure: row(rows, &|inputs, i| inputs.modes[m].closure[i]),
            force: row(rows, &|inputs, i| inputs.modes[m].force[i]),
        };
        // Beyond its last step a force is zero.
        let lasting = four.iter().map(|inputs| inputs.drive_force.steps()).max().unwrap_or(0);
        let at = |column: &[f64], n: usize| column.get(n).copied().unwrap_or(0.0);
        Self {
            modes: (0..first.modes.len()).map(mode).collect(),
            coupling: (0..rows).map(|i| row(rows, &|inputs, j| inputs.coupling[i][j])).collect(),
            drive_closure: row(rows, &|inputs, i| inputs.drive_closure[i]),
            output_pressure: row(rows, &|inputs, i| inputs.output_pressure[i]),
            output_drive: slope(&|inputs| inputs.output_drive),
            pressure: row(first.pressure.len(), &|inputs, i| inputs.pressure[i]),
            start: slope(&|inputs| inputs.start),
            drive_force: DriveForce {
                mean: row(lasting, &|inputs, n| at(&inputs.drive_force.mean, n)),
                rise: row(lasting, &|inputs, n| at(&inputs.drive_force.rise, n)),
                end: row(lasting, &|inputs, n| at(&inputs.drive_force.end, n)),
            },
        }
    }

    /// Mean and rise of the force in step `n`, and in the step before, and its end \[N\].
    pub(super) fn drive(&self, n: usize) -> Drive {
        let at = |column: &[f64], n: Option<usize>| {
            n.and_then(|n| column.get(n)).copied().unwrap_or(0.0)
        };
        let (now, before) = (Some(n), n.checked_sub(1));
        let DriveForce { mean, rise, end } = &self.drive_force;
        let taps = [at(mean, now), at(rise, now), at(mean, before), at(rise, before)];
        Drive { taps, end: at(end, now) }
    }

    /// The force at steps 0 to `steps` \[N\].
    pub(super) fn force(&self, steps: usize) -> Vec<f64> {
        let mut force = vec![0.0; steps + 1];
        force[0] = self.start;
        for (place, end) in force[1..].iter_mut().zip(&self.drive_force.end) {
            *place = *end;
        }
        force
    }
}

/// The drive in one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drive {
    pub(super) taps: [f64; 4],
    pub(super) end: f64,
}

impl ModeInputs {
    /// Share of the drive in the increment of a step.
    pub(super) fn driven(&self, drive: &Drive) -> f64 {
        self.drive.iter().zip(&drive.taps).map(|(b, tap)| b * tap).sum()
    }
}
