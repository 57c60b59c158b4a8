//! Bends of the tractions: what a cubic within a step lacks of the quintic that also passes through the end
//! before.
//!
//! With the part s of a step, and its ends at s = 0 and 1, a traction is
//!
//! ```text
//! T(s) = H(s) + s^2 (1 - s)^2 (a + b s)
//! ```
//!
//! with the cubic H through its values and rates at both ends (Hermite). The bends a and b are those of the
//! polynomial of fifth order that has the value and the rate at the end before, s = -r, too, for steps whose lengths
//! have the ratio r. Its error within a step is
//!
//! ```text
//! d6T/ds6 / 720 s^2 (1 - s)^2 (s + r)^2
//! ```

use super::contact_solve::RowState;
use super::{hermite, hermite_slope};

/// Share of the tolerance for the error of a bent step. The cubic is symmetric in the ends of a step and keeps the energy of
/// an oscillation; the bend is not and does not. By comparison with runs of a hundredth of the tolerance.
const BENT_SHARE: f64 = 1.0 / 3.0;

/// Bends a and b of each row.
pub(super) type Bends<const N: usize> = [[f64; N]; 2];

/// The step before.
#[derive(Debug, Clone)]
pub(super) struct StepBefore<const N: usize> {
    /// Its length \[s\], and the rows at its beginning.
    pub(super) step: f64,
    pub(super) rows: RowState<N>,
    /// Its bends, if it was bent, and the length of the step before it \[s\].
    pub(super) bent: Option<(Bends<N>, f64)>,
    /// True if no contact opened or closed in it.
    pub(super) is_smooth: bool,
}

impl<const N: usize> StepBefore<N> {
    /// The rows after another `step` from `now` by the polynomials of the step before.
    #[inline(always)]
    pub(super) fn continued(&self, now: &RowState<N>, step: f64) -> RowState<N> {
        let mut next = *now;
        let s = 1.0 + step / self.step;
        for i in 0..N {
            let ends = ends([&self.rows, now], i, self.step);
            let [mut traction, mut slope] = [hermite(ends, s), hermite_slope(ends, s)];
            if let Some(([a, b], _)) = &self.bent {
                let [bump, bump_slope] = bump(s);
                let bend = a[i] + b[i] * s;
                traction += bump * bend;
                slope += bump_slope * bend + bump * b[i];
            }
            next.traction[i] = traction;
            next.traction_rate[i] = slope / self.step;
        }
        next
    }

    /// Bends within a `step` between two states.
    #[inline(always)]
    pub(super) fn bends(&self, rows: [&RowState<N>; 2], step: f64) -> Bends<N> {
        let inverse = step.recip();
        let s = -self.step * inverse;
        let [bump, bump_slope] = bump(s);
        let inverse_bump = bump.recip();
        let mut bends = [[0.0; N]; 2];
        for i in 0..N {
            let ends = ends(rows, i, step);
            let missing = self.rows.traction[i] - hermite(ends, s);
            let turned = self.rows.traction_rate[i] * step - hermite_slope(ends, s);
            let bend = missing * inverse_bump;
            let b = (turned - bump_slope * bend) * inverse_bump;
            bends[0][i] = bend - b * s;
            bends[1][i] = b;
        }
        bends
    }

    /// Error of the traction within a `step`, bent or not, to be compared with the tolerance, over the distance of its end
    /// from the one [continued](Self::continued).
    #[inline(always)]
    pub(super) fn error_share(&self, step: f64, is_bent: bool) -> f64 {
        let reach = step + self.step;
        match self.bent {
            // The largest of s^2 (1 - s)^2 (s + r)^2 is beyond the middle, where the last factor is larger.
            Some((_, earlier)) if is_bent => {
                let within = 1.1 * (0.5 * step + self.step) / (4.0 * reach * (reach + earlier));
                (within * step).powi(2) / BENT_SHARE
            }
            _ => (step / reach).powi(2) / 16.0,
        }
    }
}

/// Values and rates of the traction of row `i` at both ends of a `step`.
#[inline(always)]
fn ends<const N: usize>([begin, end]: [&RowState<N>; 2], i: usize, step: f64) -> [f64; 4] {
    [begin.traction[i], begin.traction_rate[i] * step, end.traction[i], end.traction_rate[i] * step]
}

/// `s^2 (1 - s)^2` and its slope.
#[inline(always)]
fn bump(s: f64) -> [f64; 2] {
    let root = s * (1.0 - s);
    [root * root, 2.0 * root * (1.0 - 2.0 * s)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows whose traction is a polynomial at `t`.
    fn at(t: f64, power: i32) -> RowState<1> {
        let rows = RowState::at_rest(&[]);
        let slope = f64::from(power) * t.powi(power - 1);
        RowState { traction: [t.powi(power)], traction_rate: [slope], ..rows }
    }

    /// Two steps up to zero, of which the second is bent, and one from there.
    const LENGTHS: [[f64; 3]; 5] =
        [[0.5, 0.5, 0.5], [0.2, 0.4, 0.8], [0.4, 0.4, 0.2], [0.4, 0.2, 0.2], [0.3, 0.6, 0.1]];

    fn step_before([earlier, step, _]: [f64; 3], power: i32) -> StepBefore<1> {
        let begin = at(-step, power);
        let first = StepBefore {
            step: earlier,
            rows: at(-step - earlier, power),
            bent: None,
            is_smooth: true,
        };
        let bends = first.bends([&begin, &at(0.0, power)], step);
        StepBefore { step, rows: begin, bent: Some((bends, earlier)), is_smooth: true }
    }

    /// The traction at a part `s` of a `step` between two states.
    fn within(before: &StepBefore<1>, rows: [&RowState<1>; 2], step: f64, s: f64) -> f64 {
        let [[a], [b]] = before.bends(rows, step);
        hermite(ends(rows, 0, step), s) + bump(s)[0] * (a + b * s)
    }

    #[test]
    fn polynomials_up_to_fifth_order_are_continued_and_bent_exactly() {
        for (lengths, power) in LENGTHS.into_iter().flat_map(|one| (1..=5).map(move |n| (one, n))) {
            let (before, step) = (step_before(lengths, power), lengths[2]);
            let now = at(0.0, power);
            let end = before.continued(&now, step);
            let expected = at(step, power);
            assert!((end.traction[0] - expected.traction[0]).abs() < 1e-12, "{lengths:?} {power}");
            let error = end.traction_rate[0] - expected.traction_rate[0];
            assert!(error.abs() < 1e-11, "{lengths:?} {power}");
            for s in [0.1, 0.5, 0.8] {
                let error = within(&before, [&now, &end], step, s) - (s * step).powi(power);
                assert!(error.abs() < 1e-12, "{lengths:?} {power} {s}");
            }
        }
    }

    /// Of a polynomial of sixth order the largest error within a step is at most the estimate without its
    /// share, and not far below.
    #[test]
    fn the_error_of_a_bent_step_is_bounded_closely() {
        for lengths in LENGTHS {
            let (before, step) = (step_before(lengths, 6), lengths[2]);
            let (now, end) = (at(0.0, 6), at(step, 6));
            let off = (before.continued(&now, step).traction[0] - end.traction[0]).abs();
            let bound = BENT_SHARE * before.error_share(step, true) * off;
            let errors = (1..100).map(|k| {
                let s = f64::from(k) / 100.0;
                (within(&before, [&now, &end], step, s) - (s * step).powi(6)).abs()
            });
            let largest = errors.fold(0.0, f64::max);
            assert!(largest <= bound && largest > 0.7 * bound, "{lengths:?}: {largest} {bound}");
        }
    }
}
