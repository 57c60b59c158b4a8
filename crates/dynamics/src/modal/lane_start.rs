//! The state from which a case goes on at equal steps.

use asperity_law::CompiledLaw;

use super::damped_table::{DampedTable, PAST};
use super::oscillator::NODES;
use super::step_model::{ModeStep, StepModel};

/// A case after some steps, known at the last few of them: newest first.
#[derive(Debug, Clone)]
pub(super) struct LaneStart {
    /// Number of steps so far.
    pub(super) step: usize,
    /// Displacements of every mode of the structure at the last two steps.
    pub(super) modes: Vec<[f64; 2]>,
    /// Velocity of every mode of the structure.
    pub(super) velocities: Vec<f64>,
    /// Closure increments \[m\], and traction increments \[Pa\], of each row.
    pub(super) closure: Vec<[f64; NODES]>,
    pub(super) traction: Vec<[f64; NODES]>,
    /// Viscous parts of the tractions at the last two steps \[Pa\].
    pub(super) viscous: Vec<[f64; 2]>,
    /// Stiffness of each row \[Pa/m\].
    pub(super) stiffness: Vec<f64>,
    /// Displacement of the load port \[m\].
    pub(super) load_port: f64,
    /// Output at every step so far, the one at rest first \[m\].
    pub(super) readings: Vec<f64>,
    /// Energy stored at the start, where the balance begins there \[J\]; zero where it has begun before.
    pub(super) stored: f64,
}

/// One mode in the form in which the kernel steps it.
#[derive(Debug, Clone, Copy)]
pub(super) struct ModeStart {
    /// Displacement and increment at the end of the next step without its load and its new pressures.
    pub(super) predicted: f64,
    pub(super) predicted_increment: f64,
    /// Shares of the contact forces so far in the steps after next.
    pub(super) carry: [f64; NODES - 1],
    /// Increment of the last step.
    pub(super) increment: f64,
}

impl LaneStart {
    /// The first of the steps whose closures and tractions are known.
    pub(super) fn first_known(&self) -> usize {
        self.step + 1 - NODES
    }

    /// Displacements at the last two steps, and velocity, of each mode that `model` steps.
    pub(super) fn stepped(&self, model: &StepModel) -> impl Iterator<Item = ([f64; 2], f64)> {
        let all = self.modes.iter().copied().zip(self.velocities.iter().copied());
        let is_stepped = model.interpolations.iter().map(Option::is_some);
        all.zip(is_stepped).filter_map(|(mode, is_stepped)| is_stepped.then_some(mode))
    }

    /// Mode `m` of `model`.
    pub(super) fn mode(&self, model: &StepModel, m: usize) -> ModeStart {
        let ([now, before], _) = self.stepped(model).nth(m).unwrap_or_default();
        let mode = &model.modes[m];
        let forces: [f64; NODES] = std::array::from_fn(|age| self.force(mode, age));
        let taps = &mode.recurrence.contact;
        // Of the forces so far in the step so many steps ahead.
        let share = |ahead: usize| -> f64 {
            -taps[ahead..].iter().zip(&forces).map(|(tap, force)| tap * force).sum::<f64>()
        };
        let increment = now - before;
        let predicted_increment =
            mode.recurrence.decay * increment - mode.recurrence.spring * now + share(1);
        ModeStart {
            predicted: now + predicted_increment,
            predicted_increment,
            carry: std::array::from_fn(|k| share(2 + k)),
            increment,
        }
    }

    /// The modal contact force at the end of a step, its sign left out.
    fn force(&self, mode: &ModeStep, age: usize) -> f64 {
        mode.force.iter().zip(&self.traction).map(|(force, traction)| force * traction[age]).sum()
    }

    /// Closure of row `i` at the end of the next step without its load and its new pressures \[m\].
    pub(super) fn predicted_closure(&self, model: &StepModel, i: usize) -> f64 {
        let modes = model.modes.iter().enumerate();
        modes.map(|(m, mode)| mode.closure[i] * self.mode(model, m).predicted).sum()
    }

    /// The number of the last step in a column of a load.
    pub(super) fn load_before(&self, column: &[f64]) -> f64 {
        self.step.checked_sub(1).and_then(|step| column.get(step)).copied().unwrap_or(0.0)
    }

    /// Term that summing the viscous loss by parts leaves at the start \[J\].
    pub(super) fn first_loss(&self, model: &StepModel) -> f64 {
        let term = |(m, mode): (usize, &ModeStep)| {
            mode.dynamics.rate / (12.0 * model.step) * self.mode(model, m).increment.powi(2)
        };
        model.modes.iter().enumerate().map(term).sum()
    }

    /// Viscous impulses of row `i` since rest at the last steps \[Pa s\].
    pub(super) fn impulses(
        &self,
        i: usize,
        damped: &DampedTable,
        table: &CompiledLaw,
    ) -> [f64; PAST] {
        let scale = table.scales()[1];
        let at = |age: usize| {
            let closure = self.closure.get(i).map_or(0.0, |closure| closure[age]);
            damped.impulse(closure * scale.cells_per_metre + scale.offset)
        };
        std::array::from_fn(at)
    }
}
