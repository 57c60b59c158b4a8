//! The oscillators of a case, and of its derivatives.

use super::step_inputs::{Inputs, ModeInputs, StepLoad};
use crate::modal::oscillator::NODES;

/// One oscillator between two steps.
#[derive(Debug, Clone, Copy, Default)]
struct State {
    /// Displacement and increment at the end of the next step without its new pressures.
    predicted: f64,
    predicted_increment: f64,
    /// Shares of the contact forces so far in the steps after next.
    carry: [f64; NODES - 1],
    /// Increment of this step, displacement and modal force at its end.
    increment: f64,
    displacement: f64,
    force: f64,
}

/// All oscillators.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    states: Vec<State>,
}

/// Shares in the steps to come, one step on, less the shares of a new force.
fn carried_on(carry: &[f64; NODES - 1], new: [f64; NODES - 1]) -> [f64; NODES - 1] {
    std::array::from_fn(|k| carry.get(k + 1).copied().unwrap_or(0.0) - new[k])
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Motion {
    pub(super) fn at_rest(modes: usize) -> Self {
        Self { states: vec![State::default(); modes] }
    }

    /// Adds the load of a step, and gives the closures without its new pressures in `target`.
    pub(super) fn predict(&mut self, inputs: &Inputs, load: &StepLoad, target: &mut [f64]) {
        for (place, of) in target.iter_mut().zip(&inputs.closure_per_load) {
            *place = of * load.end;
        }
        for (state, mode) in self.states.iter_mut().zip(&inputs.modes) {
            let pushed = mode.pushed(load);
            state.predicted_increment += pushed;
            state.predicted += pushed;
            for (place, g) in target.iter_mut().zip(&mode.closure) {
                *place += g * state.predicted;
            }
        }
    }

    /// Completes the step with its new `pressure`; the reading of the sensor.
    pub(super) fn correct(&mut self, inputs: &Inputs, load: &StepLoad, pressure: &[f64]) -> f64 {
        let mut reading =
            inputs.sensor_per_load * load.end - dot(&inputs.sensor_per_pressure, pressure);
        for (state, mode) in self.states.iter_mut().zip(&inputs.modes) {
            let force = dot(&mode.force, pressure);
            let [t0, t1, later @ ..] = mode.contact;
            let increment = state.predicted_increment - t0 * force;
            let displacement = state.predicted - t0 * force;
            reading += mode.sensor * displacement;
            let carried = state.carry[0] - t1 * force;
            let predicted_increment = mode.decay * increment - mode.spring * displacement + carried;
            *state = State {
                predicted: displacement + predicted_increment,
                predicted_increment,
                carry: carried_on(&state.carry, later.map(|tap| tap * force)),
                increment,
                displacement,
                force,
            };
        }
        reading
    }

    /// [`predict`](Self::predict) of a derivative, `base` having been predicted already.
    pub(super) fn predict_derivative(
        &mut self,
        (inputs, derivatives): (&Inputs, &Inputs),
        (load, load_derivative): (&StepLoad, &StepLoad),
        base: &Self,
        target: &mut [f64],
    ) {
        let residual = target
            .iter_mut()
            .zip(inputs.closure_per_load.iter().zip(&derivatives.closure_per_load));
        for (place, (of, derivative)) in residual {
            *place = derivative * load.end + of * load_derivative.end;
        }
        let modes = inputs.modes.iter().zip(&derivatives.modes);
        for ((state, moved), (mode, derivative)) in
            self.states.iter_mut().zip(&base.states).zip(modes)
        {
            let pushed = derivative.pushed(load) + mode.pushed(load_derivative);
            state.predicted_increment += pushed;
            state.predicted += pushed;
            let shapes = mode.closure.iter().zip(&derivative.closure);
            for (place, (g, g_derivative)) in target.iter_mut().zip(shapes) {
                *place += g * state.predicted + g_derivative * moved.predicted;
            }
        }
    }

    /// [`correct`](Self::correct) of a derivative, `base` having been corrected already.
    pub(super) fn correct_derivative(
        &mut self,
        (inputs, derivatives): (&Inputs, &Inputs),
        (load, load_derivative): (&StepLoad, &StepLoad),
        base: &Self,
        (pressure, pressure_derivative): (&[f64], &[f64]),
    ) -> f64 {
        let mut reading = derivatives.sensor_per_load * load.end
            + inputs.sensor_per_load * load_derivative.end
            - dot(&derivatives.sensor_per_pressure, pressure)
            - dot(&inputs.sensor_per_pressure, pressure_derivative);
        let modes = inputs.modes.iter().zip(&derivatives.modes);
        for ((state, moved), (mode, derivative)) in
            self.states.iter_mut().zip(&base.states).zip(modes)
        {
            let force = dot(&derivative.force, pressure) + dot(&mode.force, pressure_derivative);
            reading += state.correct(force, (mode, derivative), moved);
        }
        reading
    }
}

impl State {
    /// The derivative of a corrected state under the derivative of its modal `force`; its share in the
    /// derivative of the reading of the sensor.
    fn correct(
        &mut self,
        force: f64,
        (mode, derivative): (&ModeInputs, &ModeInputs),
        moved: &Self,
    ) -> f64 {
        let taps = |k: usize| mode.contact[k] * force + derivative.contact[k] * moved.force;
        let pressed = taps(0);
        let increment = self.predicted_increment - pressed;
        let displacement = self.predicted - pressed;
        let carried = self.carry[0] - taps(1);
        let predicted_increment = mode.decay * increment + derivative.decay * moved.increment
            - mode.spring * displacement
            - derivative.spring * moved.displacement
            + carried;
        *self = Self {
            predicted: displacement + predicted_increment,
            predicted_increment,
            carry: carried_on(&self.carry, std::array::from_fn(|k| taps(k + 2))),
            increment,
            displacement,
            force,
        };
        mode.sensor * displacement + derivative.sensor * moved.displacement
    }
}
