//! The oscillators of a hit, and of its derivatives.

use super::step_inputs::{Drive, Inputs, ModeInputs};

/// One oscillator between two steps.
#[derive(Debug, Clone, Copy, Default)]
struct State {
    /// Displacement and increment that the next step would reach without its new pressures.
    ahead: f64,
    increment_ahead: f64,
    carry: [f64; 2],
    /// Gain of this step, what it reached, and the modal force at its end.
    increment: f64,
    reached: f64,
    force: f64,
}

/// All oscillators.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    states: Vec<State>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Motion {
    pub(super) fn at_rest(modes: usize) -> Self {
        Self { states: vec![State::default(); modes] }
    }

    /// Adds the drive of a step, and gives the closures without its new pressures.
    pub(super) fn reach(&mut self, inputs: &Inputs, drive: &Drive, target: &mut [f64]) {
        for (place, of) in target.iter_mut().zip(&inputs.drive_closure) {
            *place = of * drive.end;
        }
        for (state, mode) in self.states.iter_mut().zip(&inputs.modes) {
            let driven = mode.driven(drive);
            state.increment_ahead += driven;
            state.ahead += driven;
            for (place, g) in target.iter_mut().zip(&mode.closure) {
                *place += g * state.ahead;
            }
        }
    }

    /// Takes the step under its new `pressure`; the output.
    pub(super) fn settle(&mut self, inputs: &Inputs, drive: &Drive, pressure: &[f64]) -> f64 {
        let mut output = inputs.output_drive * drive.end - dot(&inputs.output_pressure, pressure);
        for (state, mode) in self.states.iter_mut().zip(&inputs.modes) {
            let force = dot(&mode.force, pressure);
            let [t0, t1, t2, t3] = mode.contact;
            let increment = state.increment_ahead - t0 * force;
            let reached = state.ahead - t0 * force;
            output += mode.output * reached;
            let carried = state.carry[0] - t1 * force;
            let increment_ahead = mode.decay * increment - mode.spring * reached + carried;
            *state = State {
                ahead: reached + increment_ahead,
                increment_ahead,
                carry: [state.carry[1] - t2 * force, -t3 * force],
                increment,
                reached,
                force,
            };
        }
        output
    }

    /// [`reach`](Self::reach) of a derivative, `base` having been driven already.
    pub(super) fn reach_derivative(
        &mut self,
        (inputs, derivatives): (&Inputs, &Inputs),
        (drive, drive_derivative): (&Drive, &Drive),
        base: &Self,
        target: &mut [f64],
    ) {
        let residual =
            target.iter_mut().zip(inputs.drive_closure.iter().zip(&derivatives.drive_closure));
        for (place, (of, derivative)) in residual {
            *place = derivative * drive.end + of * drive_derivative.end;
        }
        let modes = inputs.modes.iter().zip(&derivatives.modes);
        for ((state, moved), (mode, derivative)) in
            self.states.iter_mut().zip(&base.states).zip(modes)
        {
            let driven = derivative.driven(drive) + mode.driven(drive_derivative);
            state.increment_ahead += driven;
            state.ahead += driven;
            let shapes = mode.closure.iter().zip(&derivative.closure);
            for (place, (g, g_derivative)) in target.iter_mut().zip(shapes) {
                *place += g * state.ahead + g_derivative * moved.ahead;
            }
        }
    }

    /// [`settle`](Self::settle) of a derivative, `base` having settled already.
    pub(super) fn settle_derivative(
        &mut self,
        (inputs, derivatives): (&Inputs, &Inputs),
        (drive, drive_derivative): (&Drive, &Drive),
        base: &Self,
        (pressure, pressure_derivative): (&[f64], &[f64]),
    ) -> f64 {
        let mut output = derivatives.output_drive * drive.end
            + inputs.output_drive * drive_derivative.end
            - dot(&derivatives.output_pressure, pressure)
            - dot(&inputs.output_pressure, pressure_derivative);
        let modes = inputs.modes.iter().zip(&derivatives.modes);
        for ((state, moved), (mode, derivative)) in
            self.states.iter_mut().zip(&base.states).zip(modes)
        {
            let force = dot(&derivative.force, pressure) + dot(&mode.force, pressure_derivative);
            output += state.settle(force, (mode, derivative), moved);
        }
        output
    }
}

impl State {
    /// The derivative of a settled state under the derivative of its modal `force`; its share in
    /// that of the output.
    fn settle(
        &mut self,
        force: f64,
        (mode, derivative): (&ModeInputs, &ModeInputs),
        moved: &Self,
    ) -> f64 {
        let taps = |k: usize| mode.contact[k] * force + derivative.contact[k] * moved.force;
        let pressed = taps(0);
        let increment = self.increment_ahead - pressed;
        let reached = self.ahead - pressed;
        let carried = self.carry[0] - taps(1);
        let increment_ahead = mode.decay * increment + derivative.decay * moved.increment
            - mode.spring * reached
            - derivative.spring * moved.reached
            + carried;
        *self = Self {
            ahead: reached + increment_ahead,
            increment_ahead,
            carry: [self.carry[1] - taps(2), -taps(3)],
            increment,
            reached,
            force,
        };
        mode.output * reached + derivative.output * moved.reached
    }
}
