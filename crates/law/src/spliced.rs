//! Closure, pressure and energy of a stiffness that is a piecewise cubic of pressure up to an
//! end pressure and a power law above.
//!
//! `1/K` and `p/K` of a cubic are integrated by Gauss-Legendre quadrature over cells that are
//! halved, once, at construction, until the rule is exact to rounding. The integrals up to every
//! cell are stored, so that a closure costs one search and one rule.

mod inverse;

use crate::contact_law::inverse::step;
use crate::contact_law::quadrature::{gauss, gauss_short};
use crate::contact_law::{ContactLaw, Pressure, refine_increment};
use crate::domain::{Domain, no_less};
use crate::power::Power;
use inverse::{InverseCell, inverse};

/// Relative difference between the rule on a cell and on its halves below which the halves are
/// kept. The rule is of order 20: even next to a pole of 1/K halving improves it by three digits,
/// so that the halves are exact to rounding.
const AGREEMENT: f64 = 1e-13;

/// Largest number of halvings of a cell, and of cells of a piece, for extreme data.
const HALVINGS: u32 = 40;
const CELLS: usize = 1024;

/// Widths over which the terms of K, each by itself, may become as large as K: the poles of 1/K are at least half
/// as far, where the rule of four points is exact to rounding.
const SHORTER: f64 = 50.0;

/// Share of the closure up to the end pressure from which on the end may be reached, beyond rounding.
const NEAR_END: f64 = 1e-9;

/// Newton steps at most; the start is a cell's end and the bracket is kept.
const ITERATIONS: usize = 64;

/// Stiffness and slope at an end of a cubic piece.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SplicedNode {
    pub(crate) pressure: f64,
    pub(crate) stiffness: f64,
    pub(crate) slope: f64,
}

/// A cubic `K = sum of c_i s^i`, `s = p - anchor`, valid from `start` to the next cell, and the
/// integrals from zero pressure to `start`.
///
/// The anchor is the end of lesser stiffness, where K then has full relative precision.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SplicedCell {
    start: f64,
    anchor: f64,
    coefficients: [f64; 4],
    closure: f64,
    energy: f64,
}

impl SplicedCell {
    /// K at `s` from the anchor.
    fn cubic(&self, s: f64) -> f64 {
        let [c0, c1, c2, c3] = self.coefficients;
        c0 + s * (c1 + s * (c2 + s * c3))
    }

    fn stiffness(&self, p: f64) -> f64 {
        self.cubic(p - self.anchor)
    }

    fn slope(&self, p: f64) -> f64 {
        let s = p - self.anchor;
        let [_, c1, c2, c3] = self.coefficients;
        c1 + s * (2.0 * c2 + s * 3.0 * c3)
    }

    // Both integrate over the distance from the anchor: the rounding of absolute pressures would be
    // noise in a steep cell.
    fn closure_over(&self, from: f64, increment: f64) -> f64 {
        let start = from - self.anchor;
        let [_, c1, c2, c3] = self.coefficients;
        let h = SHORTER * increment.abs();
        let slope = (c1 + start * (2.0 * c2 + start * 3.0 * c3)).abs();
        let bend = (c2 + 3.0 * start * c3).abs();
        let largest = (h * slope).max(h * h * bend).max(h * h * h * c3.abs());
        let integrand = |s: f64| 1.0 / self.cubic(s);
        if largest <= self.cubic(start).abs() {
            return gauss_short(&integrand, start, increment);
        }
        gauss(&integrand, start, increment)
    }

    fn work_over(&self, from: f64, increment: f64) -> f64 {
        let start = from - self.anchor;
        gauss(&|u| (from + u) / self.cubic(start + u), 0.0, increment)
    }
}

/// The law of cubics below a power law; closures count from zero pressure.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Spliced {
    cells: Vec<SplicedCell>,
    /// Pressures at which the cells start, side by side for the search.
    starts: Vec<f64>,
    above: Power,
    end: SplicedCell,
    /// Pressure over closure, unless extreme cubics would need too many polynomials.
    inverse: Option<Vec<InverseCell>>,
}

impl Spliced {
    /// The cubics of `pieces`, which join from pressure zero on and are positive, and `above`,
    /// whose reference pressure must be where they end, from there on.
    pub(crate) fn new(pieces: &[[SplicedNode; 2]], above: Power) -> Self {
        let mut cells: Vec<SplicedCell> = Vec::new();
        let (mut closure, mut energy) = (0.0, 0.0);
        for &[left, right] in pieces {
            let (anchor, coefficients) = hermite(left, right);
            let most = cells.len() + CELLS;
            let mut stack = vec![(left.pressure, right.pressure, 0)];
            while let Some((start, stop, halvings)) = stack.pop() {
                let mut cell = SplicedCell { start, anchor, coefficients, closure, energy };
                let middle = 0.5 * (start + stop);
                let whole = cell.closure_over(start, stop - start);
                let left = cell.closure_over(start, middle - start);
                let right = cell.closure_over(middle, stop - middle);
                let halves = left + right;
                let off = (whole - halves).abs() > AGREEMENT * halves;
                // Wide cells may agree by accident: every piece is halved once.
                let halve = halvings == 0 || (off && halvings < HALVINGS && cells.len() < most);
                if halve {
                    stack.push((middle, stop, halvings + 1));
                    stack.push((start, middle, halvings + 1));
                    continue;
                }
                cells.push(cell);
                cell.start = middle;
                cell.closure = closure + left;
                cell.energy = energy + cell.work_over(start, middle - start);
                cells.push(cell);
                closure += halves;
                energy = cell.energy + cell.work_over(middle, stop - middle);
            }
        }
        let end = SplicedCell {
            start: above.reference_pressure(),
            anchor: above.reference_pressure(),
            coefficients: [0.0; 4],
            closure,
            energy,
        };
        let starts = cells.iter().map(|cell| cell.start).collect();
        let inverse = inverse(&cells, &end);
        Self { cells, starts, above, end, inverse }
    }

    /// The cell that holds pressure `p`, and the pressure and closure where it ends; `None` from
    /// the end pressure on.
    fn find(&self, p: f64) -> Option<(&SplicedCell, &SplicedCell)> {
        if p >= self.end.start {
            return None;
        }
        let next = self.starts.partition_point(|start| *start <= p).max(1);
        Some((&self.cells[next - 1], self.cells.get(next).unwrap_or(&self.end)))
    }

    /// The cell that holds closure `d`, likewise.
    fn find_closure(&self, d: f64) -> Option<(&SplicedCell, &SplicedCell)> {
        if d >= self.end.closure {
            return None;
        }
        let next = self.cells.partition_point(|cell| cell.closure <= d).max(1);
        Some((&self.cells[next - 1], self.cells.get(next).unwrap_or(&self.end)))
    }

    /// About the pressure at closure `d`, from zero up to the end.
    fn guess(&self, d: f64) -> f64 {
        let Some(cells) = &self.inverse else { return self.pressure(d).value };
        let next = cells.partition_point(|cell| cell.closure <= d).max(1);
        cells.get(next - 1).map_or_else(|| self.pressure(d).value, |cell| cell.pressure(d))
    }

    /// Closure increment upwards: in the cell of `from`, across whole cells, in the last one.
    fn rise(&self, from: f64, dp: f64) -> f64 {
        let Some((cell, next)) = self.find(from) else {
            return self.above.closure_increment(from, dp);
        };
        let room = next.start - from;
        if dp <= room {
            return cell.closure_over(from, dp);
        }
        let first = cell.closure_over(from, room);
        let last = self.find(next.start + (dp - room)).map_or(&self.end, |at| at.0);
        let rest = (dp - room) - (last.start - next.start);
        let over = if last.start < self.end.start {
            last.closure_over(last.start, rest)
        } else {
            self.above.closure_increment(last.start, rest)
        };
        first + (last.closure - next.closure) + over
    }

    /// Closure increment downwards, `dp` < 0, likewise.
    fn fall(&self, from: f64, dp: f64) -> f64 {
        let below = self.starts.partition_point(|start| *start < from).max(1) - 1;
        let (cell, within): (&SplicedCell, &dyn Fn(f64) -> f64) = if from > self.end.start {
            (&self.end, &|dp| self.above.closure_increment(from, dp))
        } else {
            let cell = &self.cells[below];
            (cell, &move |dp| cell.closure_over(from, dp))
        };
        let room = cell.start - from;
        if dp >= room {
            return within(dp);
        }
        let first = within(room);
        let target = no_less(cell.start + (dp - room), 0.0);
        let Some((last, edge)) = self.find(target) else {
            return first;
        };
        let rest = (dp - room) + (cell.start - edge.start);
        first + (edge.closure - cell.closure) + last.closure_over(edge.start, rest)
    }

    /// Pressure increment from the start of `cell`, at most `room`, that takes the closure
    /// `target` >= 0: Newton within a bracket.
    fn advance(cell: &SplicedCell, room: f64, target: f64) -> f64 {
        let from = cell.start;
        let (mut low, mut high) = (0.0, room);
        let mut step = (target * cell.stiffness(from)).clamp(low, high);
        for _ in 0..ITERATIONS {
            let residual = target - cell.closure_over(from, step);
            if residual > 0.0 {
                low = step;
            } else {
                high = step;
            }
            let newton = residual * cell.stiffness(from + step);
            let next = step + newton;
            if newton.abs() <= 2.0 * f64::EPSILON * step.abs() {
                return next.clamp(0.0, room);
            }
            step = if (low..=high).contains(&next) { next } else { 0.5 * (low + high) };
        }
        step
    }
}

/// The cubic between two nodes: its anchor and coefficients.
fn hermite(left: SplicedNode, right: SplicedNode) -> (f64, [f64; 4]) {
    let (near, far) = if right.stiffness < left.stiffness { (right, left) } else { (left, right) };
    let h = far.pressure - near.pressure;
    let secant = (far.stiffness - near.stiffness) / h;
    let c2 = (3.0 * secant - 2.0 * near.slope - far.slope) / h;
    let c3 = (near.slope + far.slope - 2.0 * secant) / (h * h);
    (near.pressure, [near.stiffness, near.slope, c2, c3])
}

impl ContactLaw for Spliced {
    fn stiffness(&self, pressure: f64) -> f64 {
        if pressure < 0.0 {
            return 0.0;
        }
        match self.find(pressure) {
            Some((cell, _)) => cell.stiffness(pressure),
            None => self.above.stiffness(pressure),
        }
    }

    fn stiffness_slope(&self, pressure: f64) -> f64 {
        if pressure < 0.0 {
            return 0.0;
        }
        match self.find(pressure) {
            Some((cell, _)) => cell.slope(pressure),
            None => self.above.stiffness_slope(pressure),
        }
    }

    fn domain(&self) -> Domain {
        Domain {
            pressure_min: 0.0,
            closure_lost: Some(0.0),
            closure_limit: self.end.closure + self.above.domain().closure_limit,
        }
    }

    fn reference_pressure(&self) -> f64 {
        0.0
    }

    fn closure(&self, pressure: f64) -> f64 {
        let p = no_less(pressure, 0.0);
        match self.find(p) {
            Some((cell, _)) => cell.closure + cell.closure_over(cell.start, p - cell.start),
            None => self.end.closure + self.above.closure(p),
        }
    }

    fn closure_increment(&self, from: f64, increment: f64) -> f64 {
        let dp = no_less(increment, 0.0 - from);
        if dp < 0.0 { self.fall(from, dp) } else { self.rise(from, dp) }
    }

    fn pressure(&self, closure: f64) -> Pressure {
        if closure < 0.0 {
            return Pressure::OPEN;
        }
        if closure >= self.domain().closure_limit {
            return Pressure::RIGID;
        }
        let Some((cell, next)) = self.find_closure(closure) else {
            return self.above.pressure(closure - self.end.closure);
        };
        let room = next.start - cell.start;
        let p = cell.start + Self::advance(cell, room, closure - cell.closure);
        Pressure { value: p, tangent: cell.stiffness(p) }
    }

    fn pressure_increment(&self, from: f64, closure_increment: f64) -> Pressure {
        let end = self.end.start;
        let start = self.closure(from);
        // Far below the end the way to it need not be known.
        if start + closure_increment >= (1.0 - NEAR_END) * self.end.closure {
            let to_end = self.closure_increment(from, end - from);
            if closure_increment >= to_end {
                if from >= end {
                    return self.above.pressure_increment(from, closure_increment);
                }
                let over = self.above.pressure_increment(end, closure_increment - to_end);
                return Pressure { value: (end - from) + over.value, ..over };
            }
        }
        if closure_increment < -start {
            return Pressure::lost_from(from);
        }
        let guess = self.guess(start + closure_increment) - from;
        refine_increment(self, from, closure_increment, guess)
    }

    fn pressure_step(&self, from: f64, closure_increment: f64) -> Option<Pressure> {
        let across = |increment| self.closure_increment(from, increment);
        let Some((cell, next)) = self.find(from) else {
            let above = self.above.pressure_step(from, closure_increment);
            return above.filter(|at| from + at.value >= self.end.start).or_else(|| {
                step((from, closure_increment), |pressure| self.stiffness(pressure), across)
            });
        };
        // Within the cell of `from` nothing is to be searched for.
        let inside = |pressure: f64| (cell.start..=next.start).contains(&pressure);
        let stiffness = |pressure| {
            if inside(pressure) { cell.stiffness(pressure) } else { self.stiffness(pressure) }
        };
        let closure = |increment| {
            if inside(from + increment) {
                cell.closure_over(from, increment)
            } else {
                across(increment)
            }
        };
        step((from, closure_increment), stiffness, closure)
    }

    fn interpolate(&self, closures: &[f64], found: &mut Vec<Pressure>) -> bool {
        let Some(cells) = &self.inverse else { return false };
        found.clear();
        let mut near = 0;
        found.extend(closures.iter().map(|&closure| {
            if !(0.0..self.end.closure).contains(&closure) {
                return self.pressure(closure);
            }
            while near > 0 && closure < cells[near].closure {
                near -= 1;
            }
            while cells.get(near + 1).is_some_and(|next| next.closure <= closure) {
                near += 1;
            }
            let value = cells[near].pressure(closure);
            Pressure { value, tangent: self.cells[cells[near].cubic].stiffness(value) }
        }));
        true
    }

    fn energy(&self, closure: f64) -> f64 {
        if closure < 0.0 {
            return 0.0;
        }
        let Some((cell, _)) = self.find_closure(closure) else {
            let above = self.above.energy_from_reference(closure - self.end.closure);
            return self.end.energy + above;
        };
        let p = self.pressure(closure).value;
        cell.energy + cell.work_over(cell.start, p - cell.start)
    }
}
