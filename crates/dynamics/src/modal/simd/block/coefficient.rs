//! Constants of a block: uniform, or per lane.

use pulp::Simd;

use super::pair::{LaneVector, lane_of, lane_vector};

/// A constant of every lane.
///
/// In the usual sweep many forces act on one structure: then all lanes share every constant, and a
/// number in memory, a whole vector of it in a register, is all there is to load.
pub(in crate::modal) trait Coefficient<S: Simd>: Copy {
    /// True if the block has damped contacts or friction: the kernel of others does without them.
    const DISSIPATIVE: bool = false;

    /// The constant that `of` gives lane by lane; a uniform one takes the first lane.
    fn new(simd: S, of: &dyn Fn(usize) -> f64) -> Self;

    fn all(self, simd: S) -> LaneVector<S>;

    fn lane(&self, lane: usize) -> f64;
}

/// Uniform: the same number in every lane.
#[derive(Debug, Clone, Copy)]
pub(in crate::modal) struct Uniform(f64);

/// Per lane: a number of its own in each lane.
#[derive(Debug, Clone, Copy)]
pub(in crate::modal) struct PerLane<V, const DISSIPATIVE: bool = false>([V; 2]);

/// Per lane, in a block with damped contacts or friction.
pub(in crate::modal) type Dissipative<V> = PerLane<V, true>;

impl<S: Simd> Coefficient<S> for Uniform {
    #[inline(always)]
    fn new(_: S, of: &dyn Fn(usize) -> f64) -> Self {
        Self(of(0))
    }

    #[inline(always)]
    fn all(self, simd: S) -> LaneVector<S> {
        [simd.splat_f64s(self.0); 2]
    }

    fn lane(&self, _: usize) -> f64 {
        self.0
    }
}

impl<S: Simd, const DISSIPATIVE: bool> Coefficient<S> for PerLane<S::f64s, DISSIPATIVE> {
    const DISSIPATIVE: bool = DISSIPATIVE;

    #[inline(always)]
    fn new(simd: S, of: &dyn Fn(usize) -> f64) -> Self {
        Self(lane_vector(simd, of))
    }

    #[inline(always)]
    fn all(self, _: S) -> LaneVector<S> {
        self.0
    }

    fn lane(&self, lane: usize) -> f64 {
        lane_of::<S>(&self.0, lane)
    }
}
