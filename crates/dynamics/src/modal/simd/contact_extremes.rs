//! Extremes of closure and time without contact, over all steps of a case.

use pulp::Simd;

use super::block::{Block, CHUNK, Coefficient, LanePair, LaneVector, Step, lane_of, set_lane};

/// Extremes of the closure of one interface in one lane, over all steps, in cells of its table.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::modal) struct LaneExtremes {
    /// Lowest and highest increment, refined between steps.
    pub(in crate::modal) lowest: f64,
    pub(in crate::modal) highest: f64,
    /// Highest at a step.
    pub(in crate::modal) highest_step: f64,
    lowest_step: f64,
    /// Number of steps, and parts of them, without contact.
    pub(in crate::modal) open_steps: f64,
    /// `open_steps` less the number of steps that end without contact.
    pub(in crate::modal) open_excess: f64,
    /// True once a closure was not finite.
    pub(in crate::modal) lost: bool,
}

/// One interface in every lane.
struct InterfaceExtremes<S: Simd> {
    extremes: Vec<LaneExtremes>,
    /// The last two closures.
    tail: [LaneVector<S>; 2],
    /// Closures at or beyond these are examined one by one: new extremes, or ones that may be
    /// new between steps, or faces apart.
    check_below: LaneVector<S>,
    check_above: LaneVector<S>,
    open_below: LaneVector<S>,
}

/// Extremes of every lane and interface of a block.
pub(super) struct BlockExtremes<S: Simd> {
    interfaces: Vec<InterfaceExtremes<S>>,
}

/// Share of the range of closures so far within which a step may hide an extreme beside it.
const MARGIN: f64 = 0.02;

impl<S: Simd> BlockExtremes<S> {
    pub(super) fn new<C: Coefficient<S>, const N: usize>(
        simd: S,
        block: &Block<'_, S, C, N>,
    ) -> Self {
        let zero = LanePair(simd).splat(0.0);
        let interface = |i: usize| {
            // Lanes without a case are never examined.
            let mut open_below = LanePair(simd).splat(f64::NEG_INFINITY);
            let mut check_below = open_below;
            let mut check_above = LanePair(simd).splat(f64::INFINITY);
            for (lane, case) in block.lanes.iter().enumerate() {
                if let Some(case) = case {
                    let per_metre = case.tabulated.cells_per_metre(i);
                    set_lane::<S>(&mut open_below, lane, case.open_below(i) * per_metre);
                    set_lane::<S>(&mut check_below, lane, 0.0);
                    set_lane::<S>(&mut check_above, lane, 0.0);
                }
            }
            let mut tail = [zero; 2];
            for (lane, case) in block.lanes.iter().enumerate() {
                let Some((case, start)) = case.and_then(|case| Some((case, case.start.as_ref()?)))
                else {
                    continue;
                };
                let per_metre = case.tabulated.cells_per_metre(i);
                for (age, numbers) in tail.iter_mut().rev().enumerate() {
                    set_lane::<S>(numbers, lane, start.closure[i][age] * per_metre);
                }
            }
            InterfaceExtremes {
                extremes: vec![LaneExtremes::default(); 2 * S::F64_LANES],
                tail,
                check_below,
                check_above,
                open_below,
            }
        };
        Self { interfaces: (0..block.coupled).map(interface).collect() }
    }

    /// Takes in the steps of `chunk`.
    #[inline(always)]
    pub(super) fn take<const N: usize>(&mut self, simd: S, chunk: &[Step<LaneVector<S>, N>]) {
        let pair = LanePair(simd);
        for (i, interface) in self.interfaces.iter_mut().enumerate() {
            // An interface that was open before may close about the first step.
            let mut lowest = pair.min(interface.tail[0], interface.tail[1]);
            let mut highest = interface.tail[1];
            for step in chunk {
                lowest = pair.min(lowest, step.closure[i]);
                highest = pair.max(highest, step.closure[i]);
            }
            let newest = chunk[chunk.len() - 1].closure[i];
            // Written so that a closure that is not a number is examined too.
            let calm = pair.and(
                pair.less(interface.check_below, lowest),
                pair.less(highest, interface.check_above),
            );
            let calm = pair.and(calm, pair.equal(newest, newest));
            if !pair.every(calm) {
                interface.update_lanes::<N>(chunk, i);
            }
            let before = match chunk.len().checked_sub(2) {
                Some(at) => chunk[at].closure[i],
                None => interface.tail[1],
            };
            interface.tail = [before, newest];
        }
    }

    pub(super) fn extremes(&self, i: usize, lane: usize) -> LaneExtremes {
        self.interfaces[i].extremes[lane]
    }
}

impl<S: Simd> InterfaceExtremes<S> {
    #[cold]
    #[inline(never)]
    fn update_lanes<const N: usize>(&mut self, chunk: &[Step<LaneVector<S>, N>], i: usize) {
        for lane in 0..2 * S::F64_LANES {
            if lane_of::<S>(&self.check_above, lane) == f64::INFINITY {
                continue;
            }
            let mut closures = [0.0; CHUNK + 2];
            for (closure, tail) in closures.iter_mut().zip(&self.tail) {
                *closure = lane_of::<S>(tail, lane);
            }
            for (closure, step) in closures[2..].iter_mut().zip(chunk) {
                *closure = lane_of::<S>(&step.closure[i], lane);
            }
            let open_below = lane_of::<S>(&self.open_below, lane);
            let seen = &mut self.extremes[lane];
            seen.update(&closures[..chunk.len() + 2], open_below);
            let margin = MARGIN * (seen.highest_step - seen.lowest_step);
            let below = seen.lowest_step.max(open_below) + margin;
            set_lane::<S>(&mut self.check_below, lane, below);
            set_lane::<S>(&mut self.check_above, lane, seen.highest_step - margin);
        }
    }
}

impl LaneExtremes {
    /// The extremes in a unit of so many `metres` a cell.
    pub(super) fn scaled(self, metres: f64) -> Self {
        Self {
            lowest: self.lowest * metres,
            highest: self.highest * metres,
            highest_step: self.highest_step * metres,
            lowest_step: self.lowest_step * metres,
            ..self
        }
    }

    /// Goes through closures step by step, the first two being those before the chunk. Contact is
    /// lost at and below `open_below`.
    fn update(&mut self, closures: &[f64], open_below: f64) {
        for &closure in &closures[2..] {
            self.lowest_step = self.lowest_step.min(closure);
            self.highest_step = self.highest_step.max(closure);
            self.lost |= !closure.is_finite();
        }
        self.lowest = self.lowest.min(self.lowest_step);
        self.highest = self.highest.max(self.highest_step);
        for window in closures.windows(3) {
            let &[a, b, c] = window else { continue };
            let open = open_part([a, b, c], open_below);
            self.open_steps += open;
            self.open_excess += open - if b <= open_below { 1.0 } else { 0.0 };
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

/// Part of the step about the middle of three closures in which their parabola is at or below
/// `open`.
fn open_part([a, b, c]: [f64; 3], open: f64) -> f64 {
    let (bend, slope, above) = (0.5 * (a - 2.0 * b + c), 0.5 * (c - a), b - open);
    let discriminant = slope * slope - 4.0 * bend * above;
    if discriminant <= 0.0 || above == f64::INFINITY {
        return if above <= 0.0 { 1.0 } else { 0.0 };
    }
    let sum = -0.5 * (slope + discriminant.sqrt().copysign(slope));
    let roots = [sum / bend, above / sum].map(|root| root.clamp(-0.5, 0.5));
    let between = (roots[1] - roots[0]).abs();
    if bend >= 0.0 { between } else { 1.0 - between }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the true extremes of a sampled sine, between samples, to the parabola's order, and
    /// the time that it spends below a level: entered and left within steps, or not seen at any.
    #[test]
    fn extremes_and_open_time_are_found_between_steps() {
        let samples: Vec<f64> = (0..190).map(|n| 3.0 * (0.31 * f64::from(n)).sin()).collect();
        for (level, share) in [(-1.5, 3e-3), (-2.95, 0.03), (-2.999, 0.2)] {
            let mut seen = LaneExtremes::default();
            seen.update(&samples, level);
            assert!((seen.lowest + 3.0).abs() < 2e-3 && (seen.highest - 3.0).abs() < 2e-3);
            // Nine minima.
            let exact = 9.0 * 2.0 * (-level / 3.0_f64).acos() / 0.31;
            assert!((seen.open_steps / exact - 1.0).abs() < share, "{} {exact}", seen.open_steps);
            assert!(!seen.lost);
        }
    }
}
