//! The contact laws of one step: Newton's method on cubic tables.
//!
//! The cubic through the last four closures predicts the next one so closely that one
//! correction is enough, except when a contact opens or closes.

use super::linear_solve::{factor, solve_factored};
use crate::modal::simd::block::{Block, Coefficient, Contacts, LanePair, LaneVector, PAST, Step};
use crate::modal::simd::table_lookup::TableLookup;

/// Newton corrections before a lane is solved by itself.
const NEWTON: usize = 8;

/// Rounding to nearest minus this is rounding down, but for the last bit of a whole number.
const HALF: f64 = 0.5 - 1.0 / 1_073_741_824.0;

/// Pressures and tangents of the laws at given closures.
struct Linearised<S: TableLookup, const N: usize> {
    pressure: Contacts<S, N>,
    tangent: Contacts<S, N>,
    /// `-y - B p(y)`
    shortfall: Contacts<S, N>,
}

impl<S: TableLookup, C: Coefficient<S>, const N: usize> Block<'_, S, C, N> {
    /// Closures (in cells) and pressures \[Pa\] that satisfy every law at once.
    #[inline(always)]
    pub(in crate::modal) fn solve(
        &mut self,
        simd: S,
        past: &[Step<LaneVector<S>, N>; PAST],
    ) -> (Contacts<S, N>, Contacts<S, N>) {
        let interfaces = self.interfaces();
        let pair = LanePair(simd);
        let (four, six) = (pair.splat(4.0), pair.splat(6.0));
        let mut closure = [four; N];
        for i in 0..interfaces {
            let [x3, x2, x1, x0] = past.each_ref().map(|step| step.closure[i]);
            let inner = pair.less_mul(six, x1, pair.sub(pair.splat(0.0), x3));
            closure[i] = pair.mul_add(four, pair.add(x0, x2), inner);
        }
        if C::DISSIPATIVE {
            self.predict_traction(simd);
            self.predict_limits(simd);
        }
        // Many rows have their factors in memory, and two in registers.
        let mut kept = if N == 2 { Vec::new() } else { std::mem::take(&mut self.factors) };
        let mut two = [[four; N]; 2];
        let factors = if N == 2 { &mut two[..] } else { &mut kept[..] };
        let law = self.linearise(simd, &closure, factors);
        let mut pressure = law.pressure;
        let correction = self.correction(simd, &law, factors);
        for i in 0..interfaces {
            closure[i] = pair.add(closure[i], correction[i]);
            pressure[i] = pair.mul_add(law.tangent[i], correction[i], pressure[i]);
        }
        let mut tangent = law.tangent;
        let open = self.unsolved(simd, &correction);
        if pair.any(open) {
            self.refine(simd, open, factors, (&mut closure, &mut pressure, &mut tangent));
        }
        if N != 2 {
            self.factors = kept;
        }
        if C::DISSIPATIVE {
            let before = &past[PAST - 1].closure;
            let mut normal = pressure;
            self.correct_friction(simd, before, &closure, &mut normal);
            self.correct_traction(simd, before, &closure, &normal, &mut tangent);
        }
        for i in 0..interfaces {
            self.contacts[i].stiffness = pair.add(self.contacts[i].stiffness, tangent[i]);
        }
        (closure, pressure)
    }

    #[inline(always)]
    fn correction(
        &self,
        simd: S,
        law: &Linearised<S, N>,
        factors: &[Contacts<S, N>],
    ) -> Contacts<S, N> {
        let interfaces = self.interfaces();
        let mut residual = law.shortfall;
        for i in 0..interfaces {
            residual[i] = LanePair(simd).add(self.contacts[i].predicted, residual[i]);
        }
        solve_factored(simd, interfaces, factors, residual)
    }

    /// Lanes whose correction is not negligible.
    #[inline(always)]
    fn unsolved(&self, simd: S, correction: &Contacts<S, N>) -> [S::m64s; 2] {
        let pair = LanePair(simd);
        let mut open = pair.exceeds(correction[0], self.contacts[0].tolerance.all(simd));
        for i in 1..self.interfaces() {
            let tolerance = self.contacts[i].tolerance.all(simd);
            open = pair.or(open, pair.exceeds(correction[i], tolerance));
        }
        open
    }

    /// Goes on correcting the lanes of `open`, and leaves the others as they are: the result of a
    /// lane must not depend on its neighbours.
    #[inline(always)]
    fn refine(
        &mut self,
        simd: S,
        mut open: [S::m64s; 2],
        factors: &mut [Contacts<S, N>],
        (closure, pressure, tangent): (
            &mut Contacts<S, N>,
            &mut Contacts<S, N>,
            &mut Contacts<S, N>,
        ),
    ) {
        let interfaces = self.interfaces();
        let pair = LanePair(simd);
        for _ in 1..NEWTON {
            let law = self.linearise(simd, closure, factors);
            let correction = self.correction(simd, &law, factors);
            for i in 0..interfaces {
                let reached = pair.add(closure[i], correction[i]);
                let pressed = pair.mul_add(law.tangent[i], correction[i], law.pressure[i]);
                closure[i] = pair.select(open, reached, closure[i]);
                pressure[i] = pair.select(open, pressed, pressure[i]);
                tangent[i] = pair.select(open, law.tangent[i], tangent[i]);
            }
            open = pair.and(open, self.unsolved(simd, &correction));
            if !pair.any(open) {
                return;
            }
        }
        let marks = pair.select(open, pair.splat(1.0), pair.splat(0.0));
        // Copies, so that the numbers of the usual path need not be in memory.
        let (mut alone, mut pressed) = (*closure, *pressure);
        self.solve_fallback(&marks, &mut alone, &mut pressed);
        (*closure, *pressure) = (alone, pressed);
        let law = self.linearise(simd, closure, factors);
        for i in 0..interfaces {
            tangent[i] = pair.select(open, law.tangent[i], tangent[i]);
        }
    }

    /// The laws at given closures, and the factors of `I + B K` there.
    #[inline(always)]
    fn linearise(
        &self,
        simd: S,
        closure: &Contacts<S, N>,
        factors: &mut [Contacts<S, N>],
    ) -> Linearised<S, N> {
        let interfaces = self.interfaces();
        let pair = LanePair(simd);
        let (mut pressure, mut tangent) = (*closure, *closure);
        // Written out for the usual two: the compiler does not unroll so long a loop, and keeps its
        // arrays in memory.
        (pressure[0], tangent[0]) = self.law(simd, 0, closure[0]);
        if N == 2 {
            (pressure[N - 1], tangent[N - 1]) = self.law(simd, N - 1, closure[N - 1]);
        } else {
            for i in 1..interfaces {
                (pressure[i], tangent[i]) = self.law(simd, i, closure[i]);
            }
        }
        let zero = pair.splat(0.0);
        let one = pair.splat(1.0);
        let mut shortfall = [zero; N];
        for i in 0..interfaces {
            shortfall[i] = pair.sub(zero, closure[i]);
            for j in 0..interfaces {
                let coupling = self.contacts[i].coupling[j].all(simd);
                shortfall[i] = pair.less_mul(coupling, pressure[j], shortfall[i]);
                factors[i][j] = if i == j {
                    pair.mul_add(coupling, tangent[j], one)
                } else {
                    pair.mul(coupling, tangent[j])
                };
            }
        }
        factor(simd, interfaces, factors);
        Linearised { pressure, tangent, shortfall }
    }

    /// Pressure increment \[Pa\] at a closure, in cells from rest, and its tangent per cell; with
    /// damping or friction, traction increment and tangent.
    #[inline(always)]
    fn law(&self, simd: S, i: usize, closure: LaneVector<S>) -> (LaneVector<S>, LaneVector<S>) {
        let found = self.table(simd, i, closure, None);
        if C::DISSIPATIVE {
            self.with_friction(simd, i, closure, self.traction(simd, i, found))
        } else {
            found
        }
    }

    /// Value at a closure, in cells from rest, and tangent per cell, by the table of contact `i`, or
    /// by one so many `rows` behind it.
    #[inline(always)]
    pub(super) fn table(
        &self,
        simd: S,
        i: usize,
        closure: LaneVector<S>,
        rows: Option<LaneVector<S>>,
    ) -> (LaneVector<S>, LaneVector<S>) {
        let contact = &self.contacts[i];
        let pair = LanePair(simd);
        let (mut whole, mut whole_at_rest) =
            (contact.whole.all(simd), contact.whole_at_rest.all(simd));
        if let Some(rows) = rows {
            (whole, whole_at_rest) = (pair.add(whole, rows), pair.add(whole_at_rest, rows));
        }
        // In this order: a closure that is not a number becomes the first.
        let closure = pair.max(closure, contact.first.all(simd));
        let closure = pair.min(closure, contact.last.all(simd));
        let place = pair.add(closure, contact.rest.all(simd));
        let marked = pair.add(pair.sub(place, pair.splat(HALF)), whole);
        // From the closure, not the place: next to rest all of its digits count.
        let t = pair.sub(closure, pair.sub(marked, whole_at_rest));
        let ([a0, a1, a2, a3], [b0, b1, b2, b3]) =
            (simd.lookup(&self.rows, marked[0]), simd.lookup(&self.rows, marked[1]));
        let [c0, c1, c2, c3] = [[a0, b0], [a1, b1], [a2, b2], [a3, b3]];
        let cubic = pair.mul(c3, t);
        let curved = pair.add(cubic, c2);
        let slope = pair.mul_add(t, curved, c1);
        let value = pair.mul_add(t, slope, c0);
        let tangent = pair.mul_add(t, pair.add(curved, cubic), slope);
        (value, tangent)
    }
}
