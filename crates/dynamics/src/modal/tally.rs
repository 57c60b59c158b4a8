//! What a hit leaves behind besides its samples: extremes and time open.

use pulp::Simd;

use super::block::{Block, CHUNK, Coefficient, Numbers, Pair, Step, lane_of, set_lane};

/// Extremes of one interface in one lane, over all steps.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Extremes {
    /// Lowest and highest pressure gained, refined between steps \[Pa\].
    pub(super) lowest: f64,
    pub(super) highest: f64,
    /// Highest at a step \[Pa\].
    pub(super) highest_step: f64,
    lowest_step: f64,
    pub(super) open_steps: usize,
    /// Whether a pressure was not finite.
    pub(super) lost: bool,
}

/// One interface in every lane.
struct Watch<S: Simd> {
    extremes: Vec<Extremes>,
    /// The last two pressures.
    tail: [Numbers<S>; 2],
    /// Pressures at or beyond these are looked at one by one: new extremes, or ones that may be
    /// new between steps, or faces apart.
    look_below: Numbers<S>,
    look_above: Numbers<S>,
    open_below: Numbers<S>,
}

/// Extremes of every lane and interface of a block.
pub(super) struct Tally<S: Simd> {
    watches: Vec<Watch<S>>,
}

/// Share of the range of pressures so far within which a step may hide an extreme beside it.
const MARGIN: f64 = 0.02;

impl<S: Simd> Tally<S> {
    pub(super) fn new<C: Coefficient<S>, const N: usize>(
        simd: S,
        block: &Block<'_, S, C, N>,
    ) -> Self {
        let zero = Pair(simd).splat(0.0);
        let watch = |i: usize| {
            // Lanes without a hit are never looked at.
            let mut open_below = Pair(simd).splat(f64::NEG_INFINITY);
            let mut look_below = open_below;
            let mut look_above = Pair(simd).splat(f64::INFINITY);
            for (lane, hit) in block.lanes.iter().enumerate() {
                if let Some(hit) = hit {
                    set_lane::<S>(&mut open_below, lane, hit.open_below(i));
                    set_lane::<S>(&mut look_below, lane, 0.0);
                    set_lane::<S>(&mut look_above, lane, 0.0);
                }
            }
            Watch {
                extremes: vec![Extremes::default(); 2 * S::F64_LANES],
                tail: [zero; 2],
                look_below,
                look_above,
                open_below,
            }
        };
        Self { watches: (0..block.coupled).map(watch).collect() }
    }

    /// Takes in the steps of `chunk`.
    #[inline(always)]
    pub(super) fn take<const N: usize>(&mut self, simd: S, chunk: &[Step<Numbers<S>, N>]) {
        let pair = Pair(simd);
        for (i, watch) in self.watches.iter_mut().enumerate() {
            let mut lowest = pair.splat(f64::INFINITY);
            let mut highest = pair.splat(f64::NEG_INFINITY);
            for step in chunk {
                lowest = pair.min(lowest, step.pressure[i]);
                highest = pair.max(highest, step.pressure[i]);
            }
            let newest = chunk[chunk.len() - 1].pressure[i];
            // Written so that a pressure that is not a number is looked at too.
            let calm =
                pair.and(pair.less(watch.look_below, lowest), pair.less(highest, watch.look_above));
            let calm = pair.and(calm, pair.equal(newest, newest));
            if !pair.every(calm) {
                watch.look_at_lanes::<N>(chunk, i);
            }
            let before = match chunk.len().checked_sub(2) {
                Some(at) => chunk[at].pressure[i],
                None => watch.tail[1],
            };
            watch.tail = [before, newest];
        }
    }

    /// Pressure gained at the newest step \[Pa\].
    pub(super) fn newest(&self, i: usize, lane: usize) -> f64 {
        lane_of::<S>(&self.watches[i].tail[1], lane)
    }

    pub(super) fn extremes(&self, i: usize, lane: usize) -> Extremes {
        self.watches[i].extremes[lane]
    }
}

impl<S: Simd> Watch<S> {
    #[cold]
    #[inline(never)]
    fn look_at_lanes<const N: usize>(&mut self, chunk: &[Step<Numbers<S>, N>], i: usize) {
        for lane in 0..2 * S::F64_LANES {
            if lane_of::<S>(&self.look_above, lane) == f64::INFINITY {
                continue;
            }
            let mut pressures = [0.0; CHUNK + 2];
            for (pressure, tail) in pressures.iter_mut().zip(&self.tail) {
                *pressure = lane_of::<S>(tail, lane);
            }
            for (pressure, step) in pressures[2..].iter_mut().zip(chunk) {
                *pressure = lane_of::<S>(&step.pressure[i], lane);
            }
            let open_below = lane_of::<S>(&self.open_below, lane);
            let seen = &mut self.extremes[lane];
            seen.look(&pressures[..chunk.len() + 2], open_below);
            let margin = MARGIN * (seen.highest_step - seen.lowest_step);
            let below = (seen.lowest_step + margin).max(open_below);
            set_lane::<S>(&mut self.look_below, lane, below);
            set_lane::<S>(&mut self.look_above, lane, seen.highest_step - margin);
        }
    }
}

impl Extremes {
    /// Goes through pressures step by step, the first two being those before the chunk.
    fn look(&mut self, pressures: &[f64], open_below: f64) {
        for &pressure in &pressures[2..] {
            self.lowest_step = self.lowest_step.min(pressure);
            self.highest_step = self.highest_step.max(pressure);
            self.open_steps += usize::from(pressure <= open_below);
            self.lost |= !pressure.is_finite();
        }
        self.lowest = self.lowest.min(self.lowest_step);
        self.highest = self.highest.max(self.highest_step);
        for window in pressures.windows(3) {
            let &[a, b, c] = window else { continue };
            // The vertex of the parabola through three steps around an extreme.
            let bend = a - 2.0 * b + c;
            if bend == 0.0 || (b - a) * (b - c) < 0.0 {
                continue;
            }
            let vertex = b - 0.125 * (c - a) * (c - a) / bend;
            self.lowest = self.lowest.min(vertex);
            self.highest = self.highest.max(vertex);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the true extremes of a sampled sine: between samples, to the parabola's order.
    #[test]
    fn extremes_are_found_between_steps() {
        let course: Vec<f64> = (0..200).map(|n| 3.0 * (0.31 * f64::from(n)).sin()).collect();
        let mut seen = Extremes::default();
        seen.look(&course, -2.9);
        assert!((seen.lowest + 3.0).abs() < 2e-3 && (seen.highest - 3.0).abs() < 2e-3);
        assert_eq!(seen.open_steps, course[2..].iter().filter(|&&p| p <= -2.9).count());
        assert!(!seen.lost);
    }
}
