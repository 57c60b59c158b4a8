//! Two vectors side by side.

use pulp::Simd;

/// Numbers of every lane of a block: two vectors.
pub(in crate::modal) type Numbers<S> = [<S as Simd>::f64s; 2];

/// Arithmetic on two vectors at a time.
///
/// A contact solve is one long chain of operations, each waiting for the one before. Two chains
/// operation by operation side by side take hardly longer than one. Written out, without loops
/// over the two: they stay in registers.
#[derive(Clone, Copy)]
pub(in crate::modal) struct Pair<S>(pub(in crate::modal) S);

impl<S: Simd> Pair<S> {
    #[inline(always)]
    pub(in crate::modal) fn splat(self, number: f64) -> Numbers<S> {
        [self.0.splat_f64s(number); 2]
    }

    #[inline(always)]
    pub(in crate::modal) fn add(self, a: Numbers<S>, b: Numbers<S>) -> Numbers<S> {
        [self.0.add_f64s(a[0], b[0]), self.0.add_f64s(a[1], b[1])]
    }

    #[inline(always)]
    pub(in crate::modal) fn sub(self, a: Numbers<S>, b: Numbers<S>) -> Numbers<S> {
        [self.0.sub_f64s(a[0], b[0]), self.0.sub_f64s(a[1], b[1])]
    }

    #[inline(always)]
    pub(in crate::modal) fn mul(self, a: Numbers<S>, b: Numbers<S>) -> Numbers<S> {
        [self.0.mul_f64s(a[0], b[0]), self.0.mul_f64s(a[1], b[1])]
    }

    #[inline(always)]
    pub(in crate::modal) fn div(self, a: Numbers<S>, b: Numbers<S>) -> Numbers<S> {
        [self.0.div_f64s(a[0], b[0]), self.0.div_f64s(a[1], b[1])]
    }

    /// `a b + c`
    #[inline(always)]
    pub(in crate::modal) fn mul_add(
        self,
        a: Numbers<S>,
        b: Numbers<S>,
        c: Numbers<S>,
    ) -> Numbers<S> {
        [self.0.mul_add_e_f64s(a[0], b[0], c[0]), self.0.mul_add_e_f64s(a[1], b[1], c[1])]
    }

    /// `c - a b`
    #[inline(always)]
    pub(in crate::modal) fn less_mul(
        self,
        a: Numbers<S>,
        b: Numbers<S>,
        c: Numbers<S>,
    ) -> Numbers<S> {
        [
            self.0.negate_mul_add_e_f64s(a[0], b[0], c[0]),
            self.0.negate_mul_add_e_f64s(a[1], b[1], c[1]),
        ]
    }

    #[inline(always)]
    pub(in crate::modal) fn max(self, a: Numbers<S>, b: Numbers<S>) -> Numbers<S> {
        [self.0.max_f64s(a[0], b[0]), self.0.max_f64s(a[1], b[1])]
    }

    #[inline(always)]
    pub(in crate::modal) fn min(self, a: Numbers<S>, b: Numbers<S>) -> Numbers<S> {
        [self.0.min_f64s(a[0], b[0]), self.0.min_f64s(a[1], b[1])]
    }

    /// Mask of `|a| > limit`.
    #[inline(always)]
    pub(in crate::modal) fn exceeds(self, a: Numbers<S>, limit: Numbers<S>) -> [S::m64s; 2] {
        [
            self.0.less_than_f64s(limit[0], self.0.abs_f64s(a[0])),
            self.0.less_than_f64s(limit[1], self.0.abs_f64s(a[1])),
        ]
    }

    /// Mask of `a < b`.
    #[inline(always)]
    pub(in crate::modal) fn less(self, a: Numbers<S>, b: Numbers<S>) -> [S::m64s; 2] {
        [self.0.less_than_f64s(a[0], b[0]), self.0.less_than_f64s(a[1], b[1])]
    }

    #[inline(always)]
    pub(in crate::modal) fn equal(self, a: Numbers<S>, b: Numbers<S>) -> [S::m64s; 2] {
        [self.0.equal_f64s(a[0], b[0]), self.0.equal_f64s(a[1], b[1])]
    }

    #[inline(always)]
    pub(in crate::modal) fn or(self, a: [S::m64s; 2], b: [S::m64s; 2]) -> [S::m64s; 2] {
        [self.0.or_m64s(a[0], b[0]), self.0.or_m64s(a[1], b[1])]
    }

    #[inline(always)]
    pub(in crate::modal) fn and(self, a: [S::m64s; 2], b: [S::m64s; 2]) -> [S::m64s; 2] {
        [self.0.and_m64s(a[0], b[0]), self.0.and_m64s(a[1], b[1])]
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

    /// `a` where the mask is set, `b` elsewhere.
    #[inline(always)]
    pub(in crate::modal) fn select(
        self,
        mask: [S::m64s; 2],
        a: Numbers<S>,
        b: Numbers<S>,
    ) -> Numbers<S> {
        [self.0.select_f64s(mask[0], a[0], b[0]), self.0.select_f64s(mask[1], a[1], b[1])]
    }
}
