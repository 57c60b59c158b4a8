//! The work of a traction on a closure.

use pulp::Simd;

use super::pair::{LanePair, LaneVector, lane_of, set_lane};

/// The work of a traction along a closure known at steps, `integral of t dx`: the mean of both ends
/// times the increment of x, plus a sixth of the increment of t times the change of the increment of
/// x. Summed by parts, that is of fourth order.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(in crate::modal) struct Work<V> {
    /// At the end of the last step \[Pa\].
    pub(in crate::modal) traction: V,
    traction_increment: V,
    closure_increment: V,
    /// \[Pa cells\]
    sum: V,
}

impl<V: Copy> Work<V> {
    /// No work, from rest; `zero` in every lane.
    pub(in crate::modal) fn none(zero: V) -> Self {
        Self { traction: zero, traction_increment: zero, closure_increment: zero, sum: zero }
    }
}

impl<S: Simd> LanePair<S> {
    /// Adds a step that ends with `traction` \[Pa\] after an `increment` of the closure, in cells.
    #[inline(always)]
    pub(in crate::modal) fn add_work(
        self,
        work: &mut Work<LaneVector<S>>,
        traction: LaneVector<S>,
        increment: LaneVector<S>,
    ) {
        let change = self.sub(increment, work.closure_increment);
        let traction_increment = self.sub(traction, work.traction);
        let mean = self.mul(self.splat(0.5), self.add(traction, work.traction));
        let sixth = self.mul(self.splat(1.0 / 6.0), traction_increment);
        let sum = self.mul_add(sixth, change, work.sum);
        work.sum = self.mul_add(mean, increment, sum);
        work.traction = traction;
        work.traction_increment = traction_increment;
        work.closure_increment = increment;
    }
}

/// No work in a lane yet, after a step that ended with `traction` and had these increments of traction and
/// closure.
pub(in crate::modal) fn start_work<S: Simd>(
    work: &mut Work<LaneVector<S>>,
    lane: usize,
    traction: f64,
    [traction_increment, closure_increment]: [f64; 2],
) {
    set_lane::<S>(&mut work.traction, lane, traction);
    set_lane::<S>(&mut work.traction_increment, lane, traction_increment);
    set_lane::<S>(&mut work.closure_increment, lane, closure_increment);
    // Summing by parts leaves this at the start.
    set_lane::<S>(&mut work.sum, lane, traction_increment * closure_increment / 12.0);
}

/// The whole work in a lane \[Pa cells\].
pub(in crate::modal) fn total_work<S: Simd>(work: &Work<LaneVector<S>>, lane: usize) -> f64 {
    let of = |numbers: &LaneVector<S>| lane_of::<S>(numbers, lane);
    // Summing by parts leaves the last term at the end.
    of(&work.sum) - of(&work.traction_increment) * of(&work.closure_increment) / 12.0
}
