//! Lanes that go on from a state.

use pulp::Simd;

use super::work::start_work;
use super::{Block, LaneVector, set_lane};
use crate::modal::lane_start::LaneStart;
use crate::modal::prepared_case::PreparedCase;

impl<S: Simd, C, const N: usize> Block<'_, S, C, N> {
    /// Takes each lane whose case has a start from rest to it.
    pub(in crate::modal) fn start(&mut self) {
        for lane in 0..self.lanes.len() {
            let started = self.lanes[lane].and_then(|case| Some((case, case.start.as_deref()?)));
            if let Some((case, start)) = started {
                self.start_lane(lane, case, start);
            }
        }
    }

    fn start_lane(&mut self, lane: usize, case: &PreparedCase, start: &LaneStart) {
        let set = |numbers: &mut LaneVector<S>, number: f64| set_lane::<S>(numbers, lane, number);
        let (tabulated, model) = (&case.tabulated, &case.tabulated.step_model);
        for (m, mode) in self.modes.iter_mut().enumerate() {
            let state = start.mode(model, m);
            set(&mut mode.predicted, state.predicted);
            set(&mut mode.predicted_increment, state.predicted_increment);
            set(&mut mode.increment, state.increment);
            for (carry, number) in mode.carry.iter_mut().zip(state.carry) {
                set(carry, number);
            }
        }
        for (i, contact) in self.contacts.iter_mut().enumerate().take(self.coupled) {
            let predicted = start.predicted_closure(model, i);
            set(&mut contact.predicted, tabulated.cells_per_metre(i) * predicted);
        }
        for (i, damper) in self.dampers.iter_mut().enumerate().take(tabulated.damped.len()) {
            let impulses = start.impulses(i, &tabulated.damped[i], &tabulated.tables[i]);
            for (impulse, number) in damper.impulse.iter_mut().zip(impulses) {
                set(impulse, number);
            }
            let [now, before] = start.viscous[i];
            let moved = start.closure[i][0] - start.closure[i][1];
            let increments = [now - before, moved * tabulated.cells_per_metre(i)];
            start_work::<S>(&mut damper.work, lane, now, increments);
        }
        for (before, column) in self.load_before.iter_mut().zip([&case.load.mean, &case.load.rise])
        {
            set(before, case.amplitude * start.load_before(column));
        }
        set(&mut self.reading, start.readings.last().copied().unwrap_or(0.0));
        set(&mut self.load_displacement, start.load_port);
        set(&mut self.loss, start.first_loss(model));
    }
}
