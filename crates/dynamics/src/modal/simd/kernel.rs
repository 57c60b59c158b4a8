//! One step of every lane.
//!
//! ```text
//! y + B p(y) = y*                          closures; Newton, all interfaces at once
//! d   = d* - t0 F(p),   q = q* - t0 F      modes, once the pressures are known
//! d*  = e d - k q + carried forces         and at once what the next step
//! q*  = q + d*,   y* = sum of g q*         has without its pressures
//! ```
//!
//! Every mode is loaded and stored once a step. The load, which acts during a small part of a
//! run, is added to `d*`, `q*` and `y*` when its step comes.
#![allow(
    clippy::needless_range_loop,
    reason = "loops over the few interfaces run over several arrays at once"
)]

mod contact_solve;
mod friction;
mod linear_solve;
mod viscous;

use super::block::{Block, Coefficient, LanePair, LaneVector, Load, PAST, Step};
use super::table_lookup::TableLookup;

impl<S: TableLookup, C: Coefficient<S>, const N: usize> Block<'_, S, C, N> {
    /// Rows: a constant in the form of two, so that loops over them are laid out. The second is without
    /// force where there is one.
    #[inline(always)]
    pub(super) fn interfaces(&self) -> usize {
        if N == 2 { N } else { self.coupled.min(N) }
    }

    /// Takes one step from the steps of `past`, oldest first.
    #[inline(always)]
    pub(super) fn step(
        &mut self,
        simd: S,
        past: &[Step<LaneVector<S>, N>; PAST],
        step: &mut Step<LaneVector<S>, N>,
    ) {
        let interfaces = self.interfaces();
        let pair = LanePair(simd);
        let (closure, pressure) = self.solve(simd, past);
        let mut predicted = [pair.splat(0.0); N];
        let mut reading = pair.splat(0.0);
        let mut loss = self.loss;
        for mode in &mut self.modes {
            let mut force = pair.mul(mode.force[0].all(simd), pressure[0]);
            for i in 1..interfaces {
                force = pair.mul_add(mode.force[i].all(simd), pressure[i], force);
            }
            let [t0, t1, t2, t3, t4, t5] = mode.contact;
            let pushed = pair.mul(t0.all(simd), force);
            let increment = pair.add(mode.predicted_increment, pushed);
            let reached = pair.add(mode.predicted, pushed);
            reading = pair.mul_add(mode.sensor.all(simd), reached, reading);
            let change = pair.mul(mode.loss[1].all(simd), mode.increment);
            let change = pair.mul_add(mode.loss[0].all(simd), increment, change);
            loss = pair.mul_add(increment, change, loss);
            mode.increment = increment;
            let carried = pair.mul_add(t1.all(simd), force, mode.carry[0]);
            if mode.carries {
                mode.carry[0] = pair.mul_add(t2.all(simd), force, mode.carry[1]);
                mode.carry[1] = pair.mul_add(t3.all(simd), force, mode.carry[2]);
                mode.carry[2] = pair.mul_add(t4.all(simd), force, mode.carry[3]);
                mode.carry[3] = pair.mul(t5.all(simd), force);
            } else {
                mode.carry[0] = pair.mul(t2.all(simd), force);
            }
            let sprung = pair.mul_add(mode.spring.all(simd), reached, carried);
            let predicted_increment = pair.mul_add(mode.decay.all(simd), increment, sprung);
            let next_predicted = pair.add(reached, predicted_increment);
            mode.predicted_increment = predicted_increment;
            mode.predicted = next_predicted;
            for i in 0..interfaces {
                predicted[i] =
                    pair.mul_add(mode.closure[i].all(simd), next_predicted, predicted[i]);
            }
        }
        self.loss = loss;
        for i in 0..interfaces {
            let contact = &mut self.contacts[i];
            reading = pair.less_mul(contact.sensor.all(simd), pressure[i], reading);
            contact.predicted = predicted[i];
            step.closure[i] = closure[i];
            step.pressure[i] = pressure[i];
        }
        self.reading = reading;
        step.reading = reading;
    }

    /// Adds the load of the next step to the prediction without it.
    #[inline(always)]
    pub(super) fn push(&mut self, simd: S, load: &Load<LaneVector<S>>) {
        let interfaces = self.interfaces();
        let pair = LanePair(simd);
        let Load([mean, rise, end]) = *load;
        let [mean_before, rise_before] = self.load_before;
        let mut predicted = [pair.splat(0.0); N];
        for i in 0..interfaces {
            let contact = &self.contacts[i];
            predicted[i] = pair.mul_add(contact.load.all(simd), end, contact.predicted);
        }
        for mode in &mut self.modes {
            let [b0, b1, b2, b3] = mode.load;
            let past = pair.mul(b2.all(simd), mean_before);
            let past = pair.mul_add(b3.all(simd), rise_before, past);
            let pushed = pair.mul_add(b1.all(simd), rise, past);
            let pushed = pair.mul_add(b0.all(simd), mean, pushed);
            mode.predicted_increment = pair.add(mode.predicted_increment, pushed);
            mode.predicted = pair.add(mode.predicted, pushed);
            for i in 0..interfaces {
                predicted[i] = pair.mul_add(mode.closure[i].all(simd), pushed, predicted[i]);
            }
        }
        for i in 0..interfaces {
            self.contacts[i].predicted = predicted[i];
        }
    }

    /// Increment of the load port by the modes in the last step.
    #[inline(always)]
    pub(super) fn load_port_increment(&self, simd: S) -> LaneVector<S> {
        let pair = LanePair(simd);
        let mut change = pair.splat(0.0);
        for mode in &self.modes {
            change = pair.mul_add(mode.load_port.all(simd), mode.increment, change);
        }
        change
    }

    /// Completes the reading of a loaded step, and counts the work of the load; `change_before` is
    /// the increment of the load port in the step before.
    #[inline(always)]
    pub(super) fn count_work(
        &mut self,
        simd: S,
        load: &Load<LaneVector<S>>,
        change_before: LaneVector<S>,
        step: &mut Step<LaneVector<S>, N>,
    ) {
        let pair = LanePair(simd);
        let Load([mean, rise, end]) = *load;
        let reading = pair.mul_add(self.sensor_per_load.all(simd), end, self.reading);
        self.reading = reading;
        step.reading = reading;
        let mut displacement = pair.mul(self.load_port.all(simd), end);
        for i in 0..self.interfaces() {
            let yielding = self.contacts[i].load_port.all(simd);
            displacement = pair.less_mul(yielding, step.pressure[i], displacement);
        }
        for mode in &self.modes {
            let reached = pair.sub(mode.predicted, mode.predicted_increment);
            displacement = pair.mul_add(mode.load_port.all(simd), reached, displacement);
        }
        // The velocity of the load port changes over the step by about `change` divided by the step.
        let change = pair.sub(self.load_port_increment(simd), change_before);
        let moved = pair.sub(displacement, self.load_displacement);
        let twelfth = pair.mul(pair.splat(1.0 / 12.0), rise);
        let work = pair.mul_add(twelfth, change, self.work);
        self.work = pair.mul_add(mean, moved, work);
        self.load_displacement = displacement;
        self.load_before = [mean, rise];
    }
}
