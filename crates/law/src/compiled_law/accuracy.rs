//! The error of a table, estimated from its law.

use super::CompiledLaw;
use super::grid::{ClosureGrid, DIVISION, TableRange};
use super::source::Source;
use crate::contact_law::{ContactLaw, Pressure};

/// Places in a cell at which the error is sampled, denser towards the ends.
const CHECKS: [f64; 8] = [0.03, 0.12, 0.25, 0.42, 0.58, 0.75, 0.88, 0.97];

/// The place at which nodes are checked too: against the law inverted from the state.
const FROM_STATE: f64 = CHECKS[3];

/// Every so many cells one is sampled, next to others whose error is that of their quintic.
const WATCHED: usize = 16;

/// Number of first cells, next to loss of contact, that are sampled at all places.
const EDGE: usize = 16;

/// Ratio of the error estimate to the largest error found.
pub(super) const SAFETY: f64 = 2.0;

impl CompiledLaw {
    /// Error of every cell in its middle, as of a smooth law: from the law where it is interpolated, else from the
    /// quintic; NaN for cell 0 and next to a singular loss of contact.
    pub(super) fn smooth_errors(&self, source: &Source<'_>, grid: &ClosureGrid) -> Vec<f64> {
        let cells = self.cells.iter().enumerate();
        let mut middles: Vec<f64> =
            cells.clone().map(|(i, _)| grid.closure(self.at(i, 0.5))).collect();
        let mut found = Vec::new();
        if source.interpolate(&mut middles, &mut found) {
            let off = |(&[c0, c1, c2, c3], at): (&[f64; 4], &Pressure)| {
                (c0 + 0.5 * (c1 + 0.5 * (c2 + 0.5 * c3)) - at.value).abs()
            };
            return self.cells.iter().zip(&found).map(off).collect();
        }
        // dK/dp at the upper end of the cell before: the lower end of this one.
        let mut below = None;
        let distance = |(i, &[c0, c1, c2, c3]): (usize, &[f64; 4])| {
            let width = self.width(i) * grid.width;
            let slope = |value: f64| source.law.stiffness_slope(self.pressure_state + value);
            let slopes = [below.unwrap_or_else(|| slope(c0)), slope(c0 + c1 + c2 + c3)];
            below = Some(slopes[1]).filter(|_| i > 0);
            off_quintic([c1, c1 + 2.0 * c2 + 3.0 * c3], slopes.map(|slope| slope * width))
        };
        cells.map(distance).collect()
    }

    /// The place `t` in cell `i`, in coarse cells above the lowest node.
    fn at(&self, i: usize, t: f64) -> f64 {
        let (cell, fine) = (i as f64 - 1.0, f64::from(self.fine_cells));
        let division = DIVISION as f64;
        if i <= self.fine_cells as usize {
            (cell + t) / division
        } else {
            cell - fine + fine / division + t
        }
    }

    /// Width of cell `i` in widths of the grid.
    fn width(&self, i: usize) -> f64 {
        if i <= self.fine_cells as usize { 1.0 / DIVISION as f64 } else { 1.0 }
    }

    /// Error of a pressure increment `found` \[Pa\] at closure increment `x` \[m\], from the closure that the law has
    /// there; none where the law is open, or the pressure off by so much that its stiffness differs.
    fn off_from_state(&self, law: &dyn ContactLaw, x: f64, found: f64) -> Option<f64> {
        let pressure = self.pressure_state + found;
        if pressure <= law.domain().pressure_min {
            return None;
        }
        let stiffness = law.stiffness(pressure);
        let off = stiffness * (law.closure_increment(self.pressure_state, found) - x);
        let changed = (off * law.stiffness_slope(pressure)).abs();
        (changed <= 0.01 * stiffness).then_some(off)
    }

    /// Error estimate of the table, from the errors of its cells in their middle, or the first partial one that
    /// exceeds `stop`.
    pub(super) fn estimate_error(
        &self,
        (source, range): (&Source<'_>, &TableRange),
        grid: &ClosureGrid,
        smooth: &[f64],
        stop: f64,
    ) -> f64 {
        let kinks = source.law.kinks();
        let (mut kink, mut bound) = (0, 0.0_f64);
        for (i, &[c0, c1, c2, c3]) in self.cells.iter().enumerate().skip(1) {
            // An argument s of up to `count` cells is rounded by three operations, the value by
            // as many of its own size.
            let steepest = c1.abs().max((c1 + 2.0 * c2 + 3.0 * c3).abs());
            let size = c0.abs().max((c0 + c1 + c2 + c3).abs());
            let rounding = 2.0 * f64::EPSILON * (steepest * self.cells.len() as f64 + size);
            // A kink of the law may put the error anywhere.
            let (from, to) = (self.pressure_state + c0, self.pressure_state + (c0 + c1 + c2 + c3));
            while kinks.get(kink).is_some_and(|kink| *kink < from) {
                kink += 1;
            }
            let is_kinked = kinks.get(kink).is_some_and(|kink| *kink <= to);
            let is_smooth = source.is_interpolated() && !range.singular;
            let is_edge = i <= if is_smooth { 1 } else { EDGE };
            let is_sampled = i % WATCHED == 0 || is_edge || is_kinked || !smooth[i].is_finite();
            let off = if is_sampled { self.sampled(source, grid, i) } else { smooth[i] };
            let found = SAFETY * off + rounding;
            // A NaN is not an error of zero.
            bound = if found.is_nan() { f64::INFINITY } else { bound.max(found) };
            if bound > stop {
                break;
            }
        }
        bound
    }

    /// Largest difference of cell `i` from the law at eight places; NaN if one is.
    fn sampled(&self, source: &Source<'_>, grid: &ClosureGrid, i: usize) -> f64 {
        let (law, c0) = (source.law, self.cells[i][0]);
        let closures = CHECKS.map(|t| grid.closure(self.at(i, t)));
        let mut interpolated = Vec::new();
        source.interpolate(&mut closures.clone(), &mut interpolated);
        let off = |(place, (t, x)): (usize, (f64, f64))| {
            let found = self.get(x);
            let off = if t == FROM_STATE {
                self.off_from_state(law, x, found)
            } else if let Some(at) = interpolated.get(place) {
                Some(found - at.value)
            } else {
                // From the node below, which is checked once.
                let width = t * self.width(i) * grid.width;
                let near = law.pressure_step(self.pressure_state + c0, width);
                near.map(|at| found - (c0 + at.value))
            };
            let inverted = || found - law.pressure_increment(self.pressure_state, x).value;
            off.unwrap_or_else(inverted).abs()
        };
        // Neither a NaN before nor one now is lost.
        let larger = |most: f64, off: f64| if off > most || off.is_nan() { off } else { most };
        CHECKS.into_iter().zip(closures).enumerate().map(off).fold(0.0, larger)
    }
}

/// Distance of the Hermite cubic from the quintic in the middle of a cell, from the rises over it at the
/// tangents of its ends and `dK/dp` there times its width: `p'' = K dK/dp`.
fn off_quintic([m0, m1]: [f64; 2], [b0, b1]: [f64; 2]) -> f64 {
    ((m0 - m1) / 32.0 + (m0 * b0 + m1 * b1) / 64.0).abs()
}
