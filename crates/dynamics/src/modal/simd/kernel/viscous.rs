//! The viscous traction of damped contacts.
//!
//! ```text
//! t = max(-p0, Q(x) + history),    Q = q + a_0 R / h,    history = sum of a_k R_before_k / h
//! ```
//!
//! The loss is the work of `t - q`.

use crate::modal::simd::block::{Block, Coefficient, Contacts, LanePair, LaneVector, PAST};
use crate::modal::simd::table_lookup::TableLookup;

impl<S: TableLookup, C: Coefficient<S>, const N: usize> Block<'_, S, C, N> {
    /// The share of earlier steps in the tractions at the end of the next.
    #[inline(always)]
    pub(super) fn predict_traction(&mut self, simd: S) {
        let pair = LanePair(simd);
        for damper in &mut self.dampers {
            let mut history = pair.splat(0.0);
            for k in 0..PAST {
                history = pair.mul_add(damper.rate[k + 1].all(simd), damper.impulse[k], history);
            }
            damper.history = history;
        }
    }

    /// Traction increment \[Pa\] and tangent per cell from Q and its tangent.
    #[inline(always)]
    pub(super) fn traction(
        &self,
        simd: S,
        i: usize,
        (value, tangent): (LaneVector<S>, LaneVector<S>),
    ) -> (LaneVector<S>, LaneVector<S>) {
        let (pair, damper) = (LanePair(simd), &self.dampers[i]);
        let (traction, least) = (pair.add(value, damper.history), damper.least.all(simd));
        let pressed = pair.less(least, traction);
        (pair.max(traction, least), pair.select(pressed, tangent, pair.splat(0.0)))
    }

    /// Completes the step with the tractions found at `closure`, friction apart: impulses, losses, and
    /// the tangents of the law in place of the tangents of the traction.
    #[inline(always)]
    pub(super) fn correct_traction(
        &mut self,
        simd: S,
        before: &Contacts<S, N>,
        closure: &Contacts<S, N>,
        traction: &Contacts<S, N>,
        tangent: &mut Contacts<S, N>,
    ) {
        let pair = LanePair(simd);
        for i in 0..self.interfaces() {
            let (value, slope) = self.table(simd, i, closure[i], None);
            let rows = self.dampers[i].rows.all(simd);
            let (impulse, coefficient) = self.table(simd, i, closure[i], Some(rows));
            let damper = &mut self.dampers[i];
            let rate = damper.rate[0].all(simd);
            let pressure = pair.less_mul(rate, impulse, value);
            tangent[i] = pair.less_mul(rate, coefficient, slope);
            let viscous = pair.sub(traction[i], pressure);
            pair.add_work(&mut damper.work, viscous, pair.sub(closure[i], before[i]));
            damper.impulse.copy_within(..PAST - 1, 1);
            damper.impulse[0] = impulse;
        }
    }
}
