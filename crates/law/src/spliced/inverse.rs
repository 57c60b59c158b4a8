//! Pressure over closure by polynomials of fifth degree.

use super::SplicedCell;
use crate::contact_law::INTERPOLATION_ERROR;

/// Most halvings of a cell, and most cells in all, of a law that has an interpolation.
const HALVINGS: u32 = 12;
const MOST_CELLS: usize = 1024;

/// Places in a cell at which the polynomial is compared with the law.
const CHECKS: [f64; 2] = [0.3, 0.7];

/// Largest difference found there, over the error that is stated: the largest difference may be larger by a quarter.
const SAFETY: f64 = 0.5;

/// `p(d) = p0 + sum of c_i t^i`, `t = (d - d0) / width`, from values, `dp/dd = K` and `d2p/dd2 = K dK/dp` at both
/// ends.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct InverseCell {
    /// Closure \[m\] where the cell starts.
    pub(super) closure: f64,
    cells_per_metre: f64,
    pressure: f64,
    coefficients: [f64; 5],
    /// Number of the cubic of K.
    pub(super) cubic: usize,
}

impl InverseCell {
    /// The polynomial from pressure `low` to pressure `high` of a cubic, whose closures are given.
    fn new(cubic: usize, cell: &SplicedCell, pressures: [f64; 2], closures: [f64; 2]) -> Self {
        let ([low, high], width) = (pressures, closures[1] - closures[0]);
        let rises = pressures.map(|p| cell.stiffness(p) * width);
        let bends = [0, 1].map(|end| 0.5 * rises[end] * cell.slope(pressures[end]) * width);
        // The rest beyond the Taylor polynomial at the start, its slope and its bend, at the end.
        let rest = (high - low) - rises[0] - bends[0];
        let slope = rises[1] - rises[0] - 2.0 * bends[0];
        let bend = bends[1] - bends[0];
        let third = 10.0 * rest - 4.0 * slope + bend;
        let fourth = -15.0 * rest + 7.0 * slope - 2.0 * bend;
        let fifth = 6.0 * rest - 3.0 * slope + bend;
        let coefficients = [rises[0], bends[0], third, fourth, fifth];
        let (closure, cells_per_metre) = (closures[0], width.recip());
        Self { closure, cells_per_metre, pressure: low, coefficients, cubic }
    }

    /// Pressure \[Pa\] at a closure \[m\].
    pub(super) fn pressure(&self, closure: f64) -> f64 {
        let t = (closure - self.closure) * self.cells_per_metre;
        let [c1, c2, c3, c4, c5] = self.coefficients;
        self.pressure + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * c5))))
    }
}

/// The polynomials of all cubics in turn, which end at `end`; `None` where too many would be needed.
pub(super) fn inverse(cells: &[SplicedCell], end: &SplicedCell) -> Option<Vec<InverseCell>> {
    let mut found = Vec::new();
    for (i, cell) in cells.iter().enumerate() {
        let next = cells.get(i + 1).unwrap_or(end);
        let mut stack = vec![([cell.start, next.start], [cell.closure, next.closure], 0)];
        while let Some((pressures, closures, halvings)) = stack.pop() {
            let ([low, high], [from, to]) = (pressures, closures);
            let candidate = InverseCell::new(i, cell, pressures, closures);
            let off = |place: &f64| {
                let closure = place * (to - from);
                let pressure = candidate.pressure(from + closure);
                let reached = cell.closure_over(low, pressure - low);
                cell.stiffness(pressure) * (reached - closure)
            };
            // A NaN is no agreement.
            let agrees = |place| off(place).abs() <= SAFETY * INTERPOLATION_ERROR * high;
            if CHECKS.iter().all(agrees) {
                found.push(candidate);
                continue;
            }
            if halvings == HALVINGS || found.len() + stack.len() > MOST_CELLS {
                return None;
            }
            let middle = 0.5 * (low + high);
            let reached = from + cell.closure_over(low, middle - low);
            stack.push(([middle, high], [reached, to], halvings + 1));
            stack.push(([low, middle], [from, reached], halvings + 1));
        }
    }
    Some(found)
}
