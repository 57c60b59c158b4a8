//! Extremes of pressure and steps with lost contact, over all steps of a hit.

use pulp::Simd;

use super::block::{Block, CHUNK, Coefficient, Numbers, Pair, Step, lane_of, set_lane};

/// Extremes of one interface in one lane, over all steps.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::modal) struct LaneExtremes {
    /// Lowest and highest pressure increment, refined between steps \[Pa\].
    pub(in crate::modal) lowest: f64,
    pub(in crate::modal) highest: f64,
    /// Highest at a step \[Pa\].
    pub(in crate::modal) highest_step: f64,
    lowest_step: f64,
    pub(in crate::modal) open_steps: usize,
    /// True once a pressure was not finite.
    pub(in crate::modal) lost: bool,
}

/// One interface in every lane.
struct InterfaceExtremes<S: Simd> {
    extremes: Vec<LaneExtremes>,
    /// The last two pressures.
    tail: [Numbers<S>; 2],
    /// Pressures at or beyond these are examined one by one: new extremes, or ones that may be
    /// new between steps, or faces apart.
    check_below: Numbers<S>,
    check_above: Numbers<S>,
    open_below: Numbers<S>,
}

/// Extremes of every lane and interface of a block.
pub(super) struct BlockExtremes<S: Simd> {
    interfaces: Vec<InterfaceExtremes<S>>,
}

/// Share of the range of pressures so far within which a step may hide an extreme beside it.
const MARGIN: f64 = 0.02;

impl<S: Simd> BlockExtremes<S> {
    pub(super) fn new<C: Coefficient<S>, const N: usize>(
        simd: S,
        block: &Block<'_, S, C, N>,
    ) -> Self {
        let zero = Pair(simd).splat(0.0);
        let interface = |i: usize| {
            // Lanes without a hit are never examined.
            let mut open_below = Pair(simd).splat(f64::NEG_INFINITY);
            let mut check_below = open_below;
            let mut check_above = Pair(simd).splat(f64::INFINITY);
            for (lane, hit) in block.lanes.iter().enumerate() {
                if let Some(hit) = hit {
                    set_lane::<S>(&mut open_below, lane, hit.open_below(i));
                    set_lane::<S>(&mut check_below, lane, 0.0);
                    set_lane::<S>(&mut check_above, lane, 0.0);
                }
            }
            InterfaceExtremes {
                extremes: vec![LaneExtremes::default(); 2 * S::F64_LANES],
                tail: [zero; 2],
                check_below,
                check_above,
                open_below,
            }
        };
        Self { interfaces: (0..block.coupled).map(interface).collect() }
    }

    /// Takes in the steps of `chunk`.
    #[inline(always)]
    pub(super) fn take<const N: usize>(&mut self, simd: S, chunk: &[Step<Numbers<S>, N>]) {
        let pair = Pair(simd);
        for (i, interface) in self.interfaces.iter_mut().enumerate() {
            let mut lowest = pair.splat(f64::INFINITY);
            let mut highest = pair.splat(f64::NEG_INFINITY);
            for step in chunk {
                lowest = pair.min(lowest, step.pressure[i]);
                highest = pair.max(highest, step.pressure[i]);
            }
            let newest = chunk[chunk.len() - 1].pressure[i];
            // Written so that a pressure that is not a number is examined too.
            let calm = pair.and(
                pair.less(interface.check_below, lowest),
                pair.less(highest, interface.check_above),
            );
            let calm = pair.and(calm, pair.equal(newest, newest));
            if !pair.every(calm) {
                interface.update_lanes::<N>(chunk, i);
            }
            let before = match chunk.len().checked_sub(2) {
                Some(at) => chunk[at].pressure[i],
                None => interface.tail[1],
            };
            interface.tail = [before, newest];
        }
    }

    /// Pressure increment at the newest step \[Pa\].
    pub(super) fn newest(&self, i: usize, lane: usize) -> f64 {
        lane_of::<S>(&self.interfaces[i].tail[1], lane)
    }

    pub(super) fn extremes(&self, i: usize, lane: usize) -> LaneExtremes {
        self.interfaces[i].extremes[lane]
    }
}

impl<S: Simd> InterfaceExtremes<S> {
    #[cold]
    #[inline(never)]
    fn update_lanes<const N: usize>(&mut self, chunk: &[Step<Numbers<S>, N>], i: usize) {
        for lane in 0..2 * S::F64_LANES {
            if lane_of::<S>(&self.check_above, lane) == f64::INFINITY {
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
            seen.update(&pressures[..chunk.len() + 2], open_below);
            let margin = MARGIN * (seen.highest_step - seen.lowest_step);
            let below = (seen.lowest_step + margin).max(open_below);
            set_lane::<S>(&mut self.check_below, lane, below);
            set_lane::<S>(&mut self.check_above, lane, seen.highest_step - margin);
        }
    }
}

impl LaneExtremes {
    /// Goes through pressures step by step, the first two being those before the chunk.
    fn update(&mut self, pressures: &[f64], open_below: f64) {
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
        let samples: Vec<f64> = (0..200).map(|n| 3.0 * (0.31 * f64::from(n)).sin()).collect();
        let mut seen = LaneExtremes::default();
        seen.update(&samples, -2.9);
        assert!((seen.lowest + 3.0).abs() < 2e-3 && (seen.highest - 3.0).abs() < 2e-3);
        assert_eq!(seen.open_steps, samples[2..].iter().filter(|&&p| p <= -2.9).count());
        assert!(!seen.lost);
    }
}
