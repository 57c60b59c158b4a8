//! The traction of friction elements.
//!
//! ```text
//! t = max(-R, min(R, t_before + k (y - y_before)))
//! ```
//!
//! at the end of a step, exact without a reversal in it. A limit R that is a share of the pressure of
//! a contact takes it from the parabola through the last three steps: of third order, and known
//! before the step, so that every traction still rises with its own closure alone.

use crate::modal::simd::block::{Block, Coefficient, Contacts, LanePair, LaneVector};
use crate::modal::simd::table_lookup::TableLookup;

impl<S: TableLookup, C: Coefficient<S>, const N: usize> Block<'_, S, C, N> {
    /// The limits at the end of the next step.
    #[inline(always)]
    pub(super) fn predict_limits(&mut self, simd: S) {
        if self.sliders.is_empty() {
            return;
        }
        let (pair, rows) = (LanePair(simd), self.interfaces());
        let (zero, three) = (pair.splat(0.0), pair.splat(3.0));
        let mut pressure = [zero; N];
        for (pressure, slider) in pressure.iter_mut().zip(&self.sliders).take(rows) {
            let [newest, before, oldest] = slider.normal;
            let increment = pair.mul_add(three, pair.sub(newest, before), oldest);
            *pressure = pair.max(pair.add(slider.rest.all(simd), increment), zero);
        }
        for slider in self.sliders.iter_mut().take(rows) {
            let mut limit = slider.slip.all(simd);
            for (share, pressure) in slider.share.iter().zip(&pressure).take(rows) {
                limit = pair.mul_add(share.all(simd), *pressure, limit);
            }
            slider.limit = limit;
        }
    }

    /// A traction and its tangent at `closure`, with the friction of row `i`.
    #[inline(always)]
    pub(super) fn with_friction(
        &self,
        simd: S,
        i: usize,
        closure: LaneVector<S>,
        (traction, tangent): (LaneVector<S>, LaneVector<S>),
    ) -> (LaneVector<S>, LaneVector<S>) {
        let Some(slider) = self.sliders.get(i) else { return (traction, tangent) };
        let pair = LanePair(simd);
        let (force, stuck) = self.friction(simd, i, closure);
        let stiffness = pair.select(stuck, slider.stiffness.all(simd), pair.splat(0.0));
        (pair.add(traction, force), pair.add(tangent, stiffness))
    }

    /// The traction of the element of row `i` at `closure`, and where it is stuck.
    #[inline(always)]
    fn friction(&self, simd: S, i: usize, closure: LaneVector<S>) -> (LaneVector<S>, [S::m64s; 2]) {
        let (pair, slider) = (LanePair(simd), &self.sliders[i]);
        let force = pair.mul_add(slider.stiffness.all(simd), closure, slider.stuck);
        let stuck = pair.less(pair.abs(force), slider.limit);
        let backwards = pair.sub(pair.splat(0.0), slider.limit);
        (pair.max(pair.min(force, slider.limit), backwards), stuck)
    }

    /// Completes the step with the tractions found at `closure`, and takes friction out of them.
    #[inline(always)]
    pub(super) fn correct_friction(
        &mut self,
        simd: S,
        before: &Contacts<S, N>,
        closure: &Contacts<S, N>,
        traction: &mut Contacts<S, N>,
    ) {
        let pair = LanePair(simd);
        for i in 0..if self.sliders.is_empty() { 0 } else { self.interfaces() } {
            let (force, _) = self.friction(simd, i, closure[i]);
            traction[i] = pair.sub(traction[i], force);
            let slider = &mut self.sliders[i];
            slider.stuck = pair.less_mul(slider.stiffness.all(simd), closure[i], force);
            slider.normal = [traction[i], slider.normal[0], slider.normal[1]];
            pair.add_work(&mut slider.work, force, pair.sub(closure[i], before[i]));
        }
    }
}
