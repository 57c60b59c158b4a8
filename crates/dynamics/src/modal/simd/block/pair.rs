//! Two vectors side by side.

use pulp::Simd;

/// One number for each lane of a block: two vectors.
pub(in crate::modal) type LaneVector<S> = [<S as Simd>::f64s; 2];

/// The lane vector of the number that `of` gives for each lane.
#[inline(always)]
pub(in crate::modal) fn lane_vector<S: Simd>(simd: S, of: impl Fn(usize) -> f64) -> LaneVector<S> {
    let mut numbers = [simd.splat_f64s(0.0); 2];
    for lane in 0..2 * S::F64_LANES {
        set_lane::<S>(&mut numbers, lane, of(lane));
    }
    numbers
}

/// The number of a lane.
#[inline(always)]
pub(in crate::modal) fn lane_of<S: Simd>(numbers: &LaneVector<S>, lane: usize) -> f64 {
    pulp::bytemuck::cast_slice::<S::f64s, f64>(numbers)[lane]
}

/// Replaces the number of a lane.
#[inline(always)]
pub(in crate::modal) fn set_lane<S: Simd>(numbers: &mut LaneVector<S>, lane: usize, number: f64) {
    pulp::bytemuck::cast_slice_mut::<S::f64s, f64>(numbers)[lane] = number;
}

/// Arithmetic on two vectors at a time.
///
/// A contact solve is one long chain of operations, each waiting for its predecessor. Two chains
/// operation by operation side by side take hardly longer than one. Written out, without loops
/// over the two: they stay in registers.
#[derive(Clone, Copy)]
pub(in crate::modal) struct LanePair<S>(pub(in crate::modal) S);

/// Functions that apply one operation of `Simd` to each of the two vectors.
macro_rules! pairwise {
    ($($(#[$doc:meta])* $name:ident($($of:ident: $vectors:ty),+) -> $found:ty = $operation:ident;)+) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub(in crate::modal) fn $name(self, $($of: [$vectors; 2]),+) -> [$found; 2] {
            [self.0.$operation($($of[0]),+), self.0.$operation($($of[1]),+)]
        }
    )+};
}

impl<S: Simd> LanePair<S> {
    pairwise! {
        add(a: S::f64s, b: S::f64s) -> S::f64s = add_f64s;
        sub(a: S::f64s, b: S::f64s) -> S::f64s = sub_f64s;
        mul(a: S::f64s, b: S::f64s) -> S::f64s = mul_f64s;
        div(a: S::f64s, b: S::f64s) -> S::f64s = div_f64s;
        max(a: S::f64s, b: S::f64s) -> S::f64s = max_f64s;
        min(a: S::f64s, b: S::f64s) -> S::f64s = min_f64s;
        /// `a b + c`
        mul_add(a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s = mul_add_e_f64s;
        /// `c - a b`
        less_mul(a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s = negate_mul_add_e_f64s;
        /// Mask of `a < b`.
        less(a: S::f64s, b: S::f64s) -> S::m64s = less_than_f64s;
        equal(a: S::f64s, b: S::f64s) -> S::m64s = equal_f64s;
        or(a: S::m64s, b: S::m64s) -> S::m64s = or_m64s;
        and(a: S::m64s, b: S::m64s) -> S::m64s = and_m64s;
        /// `a` where the mask is set, `b` elsewhere.
        select(mask: S::m64s, a: S::f64s, b: S::f64s) -> S::f64s = select_f64s;
    }

    #[inline(always)]
    pub(in crate::modal) fn splat(self, number: f64) -> LaneVector<S> {
        [self.0.splat_f64s(number); 2]
    }

    #[inline(always)]
    pub(in crate::modal) fn abs(self, a: LaneVector<S>) -> LaneVector<S> {
        let all_but_sign = self.0.splat_f64s(f64::from_bits(u64::MAX >> 1));
        [self.0.and_f64s(all_but_sign, a[0]), self.0.and_f64s(all_but_sign, a[1])]
    }

    /// Mask of `|a| > limit`.
    #[inline(always)]
    pub(in crate::modal) fn exceeds(self, a: LaneVector<S>, limit: LaneVector<S>) -> [S::m64s; 2] {
        self.less(limit, self.abs(a))
    }

    #[inline(always)]
    pub(in crate::modal) fn any(self, mask: [S::m64s; 2]) -> bool {
        self.0.first_true_m64s(self.0.or_m64s(mask[0], mask[1])) < S::F64_LANES
    }

    #[inline(always)]
    pub(in crate::modal) fn every(self, mask: [S::m64s; 2]) -> bool {
        let missing = self.0.not_m64s(self.0.and_m64s(mask[0], mask[1]));
        self.0.first_true_m64s(missing) == S::F64_LANES
    }
}
