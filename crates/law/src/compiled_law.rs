//! A law tabulated about a state.
#![allow(
    clippy::inline_always,
    reason = "the innermost calls of time stepping, in loops compiled for wider registers"
)]

mod accuracy;
mod cubic_cell;
mod grid;
mod source;

use crate::contact_law::{ContactLaw, Pressure};
use crate::error::{LawError, LawQuantity, above, finite};
use accuracy::SAFETY;
use grid::{CellLayout, ClosureGrid, DIVIDED, DIVISION, TableRange};
use source::Source;

pub use cubic_cell::CubicCell;

/// A contact law tabulated by cubics: the pressure increment over the closure increment `x`, both
/// from a state.
///
/// The cells are uniform in closure. In each the pressure increment is the cubic Hermite
/// interpolant of the exact pressures and tangents,
///
/// ```text
/// p(x) - p_state = c0 + c1 t + c2 t^2 + c3 t^3,    t = x cells_per_metre + offset - i.
/// ```
///
/// Where the stiffness leaves zero with a vertical tangent at loss of contact, as in a power law,
/// each of the first eight cells is divided by 32. Nodes lie
/// - exactly at the state: the increment at x = 0 is exactly `0.0`;
/// - exactly at loss of contact, if the law separates: below it the increment is exactly
///   `-pressure_state` and the tangent zero.
///
/// Outside the table [`get`](Self::get) gives NaN; the caller then evaluates the law itself.
///
/// The table covers pressures up to the top, and downwards
/// - all closures of open faces, if the law separates;
/// - to `pressure_state / 64` if it does not, as the exponential law;
/// - as far below the state as the top is above it, if the law is bilateral.
///
/// # Accuracy
/// The absolute error of the increment is estimated, not proven:
/// [`error_estimate`](Self::error_estimate) is twice the largest difference from the law found at
/// eight points of the first cells, of cells with a kink and of every sixteenth cell, and from the quintic
/// Hermite interpolant (or a law's own [`interpolate`](ContactLaw::interpolate)) in the middle of the others, plus
/// the rounding of the evaluation. In a smooth cell
/// the error of a Hermite cubic has one flat maximum; next to a kink the samples find more than
/// half of it. The estimate is absolute because the relative error of any polynomial is large at
/// loss of contact, where a power law starts as `d^(1/(1-m))`. Just above loss of contact a
/// pressure may be negative within the estimate.
///
/// The tangent is that of the cubic, one order less accurate, and not part of the estimate.
///
/// # Example
/// ```
/// use asperity_law::{CompiledLaw, ContactLaw, LawError, Power};
///
/// let law = Power::new(1.81e10, 0.35, 0.0)?;
/// let table = CompiledLaw::new(&law, 1.4e5, 1e6, 1e-6)?;
/// let exact = law.pressure_increment(1.4e5, 1e-8).value;
/// assert!((table.get(1e-8) - exact).abs() <= table.error_estimate());
/// # Ok::<(), LawError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CompiledLaw {
    /// Cell 0 holds values below the table, open faces or NaN; then the fine cells, then the rest.
    cells: Vec<[f64; 4]>,
    fine_cells: u32,
    fine_below: f64,
    fine: CellScale,
    coarse: CellScale,
    pressure_state: f64,
    x_lo: f64,
    x_hi: f64,
    error_estimate: f64,
}

/// The map from closure to cells of a [`CompiledLaw`], `s = x cells_per_metre + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CellScale {
    /// Cells per closure \[1/m\].
    pub cells_per_metre: f64,
    /// Value of `s` at the state, a whole number.
    pub offset: f64,
}

impl CellScale {
    /// The scale on which rounding does not place the lowest closure of a table inside its first cell: what
    /// lies just below loss of contact is exactly open.
    fn starting_at(mut self, lowest: f64) -> Self {
        while lowest * self.cells_per_metre + self.offset > 1.0 {
            self.cells_per_metre = self.cells_per_metre.next_up();
        }
        self
    }
}

/// Fewest cells of a first attempt.
const FIRST_CELLS: usize = 16;

/// Number of cells of the last attempt; the nodes at the state and at the top may each add one.
const LAST_CELLS: usize = CompiledLaw::MAX_CELLS - DIVIDED * DIVISION - 2;

/// Number of nodes of cells next to a singular loss of contact that are tried first.
const FIRST_NODES: usize = 3;

/// Factor by which twice the cells lower the error of cubics at most: their fourth power, and half as much again.
const DOUBLED: f64 = 24.0;

impl CompiledLaw {
    /// Largest number of cells of a table: 65536, which take 2 MB.
    pub const MAX_CELLS: usize = 1 << 16;

    /// Tabulates `law` about the state of pressure `pressure_state` \[Pa\] up to `pressure_top`
    /// \[Pa\]: the cells are doubled until the error estimate is at most `tolerance` times
    /// `max(|pressure_state|, (pressure_top - pressure_state) / 1000)`.
    ///
    /// The state must be in contact: positive, or zero for a law that separates, or any for a
    /// bilateral law. A tolerance below 1e-12 may be below rounding.
    ///
    /// # Errors
    /// [`LawError`] if a parameter is outside these limits or not finite;
    /// [`LawError::Unresolved`] if [`MAX_CELLS`](Self::MAX_CELLS) cells do not reach the tolerance.
    pub fn new(
        law: &dyn ContactLaw,
        pressure_state: f64,
        pressure_top: f64,
        tolerance: f64,
    ) -> Result<Self, LawError> {
        let range = (pressure_state, pressure_top);
        Self::build(law, range, tolerance, CellLayout::Divided)
    }

    /// Tabulates like [`new`](Self::new), but with cells of one width, for kernels that look up many
    /// closures at once. A law that never separates is covered down to a tenth of `tolerance` times
    /// `pressure_state`, and at least to a millionth of it; from there the pressure falls to zero within about as much
    /// closure as it would by the tangent there, and is zero below. A pressure held there, however small, would push a light
    /// body for as long as it flies.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn uniform(
        law: &dyn ContactLaw,
        pressure_state: f64,
        pressure_top: f64,
        tolerance: f64,
    ) -> Result<Self, LawError> {
        Self::uniform_of(law, (pressure_state, pressure_top), tolerance, 0)
    }

    /// [`uniform`](Self::uniform) between two pressures \[Pa\] with at least so many cells, for tables of
    /// other functions of the closure on the same cells: the cells of the law are divided, each into as
    /// many, with its cubic.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn uniform_of(
        law: &dyn ContactLaw,
        pressures: (f64, f64),
        tolerance: f64,
        least_cells: usize,
    ) -> Result<Self, LawError> {
        let mut table = Self::build(law, pressures, tolerance, CellLayout::Uniform)?;
        let domain = law.domain();
        if !domain.separates() && !domain.is_bilateral() {
            table.add_tail();
        }
        let parts = least_cells.div_ceil(table.cells.len() - 1);
        Ok(table.divided(parts))
    }

    /// Cells below the lowest, of one cubic from its pressure and tangent to zero, and no pressure below.
    fn add_tail(&mut self) {
        let Some(&[c0, c1, ..]) = self.cells.get(1) else { return };
        let (lowest, most) = (self.pressure_state + c0, self.cells.len());
        let count = ((lowest / c1).ceil() as usize).clamp(1, most);
        let width = 1.0 / count as f64;
        // The fall over the tail at the tangent; the cubic goes on falling up to three.
        let fall = (c1 / (width * lowest)).min(3.0);
        let [square, cube] = [lowest * (3.0 - fall), lowest * (fall - 2.0)];
        let tail = (0..count).map(|cell| {
            let t = cell as f64 * width;
            [
                t * t * (square + t * cube) - self.pressure_state,
                width * t * (2.0 * square + t * 3.0 * cube),
                width * width * (square + 3.0 * t * cube),
                width * width * width * cube,
            ]
        });
        let below = [0.0 - self.pressure_state, 0.0, 0.0, 0.0];
        let cells = std::iter::once(below).chain(tail).chain(self.cells[1..].iter().copied());
        self.cells = cells.collect();
        self.x_lo -= count as f64 / self.coarse.cells_per_metre;
        self.coarse.offset += count as f64;
        self.coarse = self.coarse.starting_at(self.x_lo);
        self.error_estimate = self.error_estimate.max(lowest);
    }

    /// The same cubics on cells of one width, each in so many parts.
    fn divided(mut self, parts: usize) -> Self {
        if parts <= 1 {
            return self;
        }
        let (count, below) = (parts as f64, self.cells[0]);
        let of_cell = |&[c0, c1, c2, c3]: &[f64; 4]| {
            (0..parts).map(move |part| {
                let (start, width) = (part as f64 / count, 1.0 / count);
                [
                    c0 + start * (c1 + start * (c2 + start * c3)),
                    width * (c1 + start * (2.0 * c2 + start * 3.0 * c3)),
                    width * width * (c2 + 3.0 * start * c3),
                    width * width * width * c3,
                ]
            })
        };
        let above = self.cells[1..].iter().flat_map(of_cell);
        self.cells = std::iter::once(below).chain(above).collect();
        self.coarse = CellScale {
            cells_per_metre: self.coarse.cells_per_metre * count,
            offset: 1.0 + (self.coarse.offset - 1.0) * count,
        }
        .starting_at(self.x_lo);
        self
    }

    fn build(
        law: &dyn ContactLaw,
        (pressure_state, pressure_top): (f64, f64),
        tolerance: f64,
        layout: CellLayout,
    ) -> Result<Self, LawError> {
        finite(LawQuantity::PressureState, pressure_state)?;
        above(LawQuantity::PressureTop, pressure_top, pressure_state)?;
        above(LawQuantity::Tolerance, tolerance, 0.0)?;
        let scale = pressure_state.abs().max((pressure_top - pressure_state) / 1000.0);
        let limit = tolerance * scale;
        let range = TableRange::of(law, (pressure_state, pressure_top), tolerance, layout)?;

        let source = Source::new(law, (pressure_state, pressure_top), limit);
        let mut wanted = FIRST_CELLS;
        let mut best = (0, f64::INFINITY);
        while let Some(grid) = range.grid(wanted.min(LAST_CELLS), LAST_CELLS + 2) {
            let places = range.places(&grid);
            let last = wanted >= LAST_CELLS;
            let table = |places: &[f64]| {
                let table = Self::on_grid(&source, &range, &grid, places);
                // The last attempt is sampled completely, for the error message.
                let stop = if last { f64::INFINITY } else { limit };
                let smooth = table.smooth_errors(&source, &grid);
                let bound = table.estimate_error((&source, &range), &grid, &smooth, stop);
                (table, smooth, bound)
            };
            // The others can wait while cells next to a singular loss of contact ask for more.
            let first = if range.singular && !last { FIRST_NODES } else { places.len() };
            let (mut found, mut smooth, mut bound) = table(&places[..first.min(places.len())]);
            if bound <= limit && first < places.len() {
                (found, smooth, bound) = table(&places);
            }
            if bound <= limit {
                return Ok(Self { error_estimate: bound, ..found });
            }
            best = (grid.count(), bound);
            // Cubics gain at most the fourth power of the cells.
            let most = (LAST_CELLS as f64 / wanted as f64).max(1.0).powi(4);
            if last || bound > limit * most {
                break;
            }
            let smooth = smooth[1..].iter().filter(|off| off.is_finite());
            let mut smooth = SAFETY * smooth.fold(0.0, |most, off| off.max(most)) / DOUBLED;
            wanted *= 2;
            while smooth > limit && wanted < LAST_CELLS {
                smooth /= DOUBLED;
                wanted *= 2;
            }
        }
        Err(LawError::Unresolved { cells: best.0, value: best.1, limit })
    }

    /// Pressure increment \[Pa\] at closure increment `x` \[m\]; NaN outside the table.
    #[inline(always)]
    pub fn get(&self, x: f64) -> f64 {
        let (i, t) = self.place(x);
        match self.cells.get(i as usize) {
            Some(&[c0, c1, c2, c3]) => c0 + t * (c1 + t * (c2 + t * c3)),
            None => f64::NAN,
        }
    }

    /// The cell that contains `x` \[m\], for callers whose successive closures differ little; `None`
    /// outside the table.
    pub fn cell(&self, x: f64) -> Option<CubicCell> {
        let fine = x < self.fine_below;
        let scale = if fine { &self.fine } else { &self.coarse };
        let (i, _) = self.place(x);
        let cubic = *self.cells.get(i as usize)?;
        if x.is_nan() || cubic[0].is_nan() {
            return None;
        }
        let edge = |i: f64| (i - scale.offset) / scale.cells_per_metre;
        let index = f64::from(i);
        Some(CubicCell {
            // CubicCell 0 holds all that lies below the table.
            from: if i == 0 { f64::NEG_INFINITY } else { edge(index) },
            to: if fine { edge(index + 1.0).min(self.fine_below) } else { edge(index + 1.0) },
            cells_per_metre: if i == 0 { 0.0 } else { scale.cells_per_metre },
            offset: if i == 0 { 0.0 } else { scale.offset - index },
            cubic,
        })
    }

    /// Pressure increment \[Pa\] and tangent dp/dd \[Pa/m\] at closure increment `x` \[m\]; NaN outside
    /// the table.
    #[inline(always)]
    pub fn get_with_tangent(&self, x: f64) -> (f64, f64) {
        let (i, t) = self.place(x);
        match self.cells.get(i as usize) {
            Some(&[c0, c1, c2, c3]) => {
                let value = c0 + t * (c1 + t * (c2 + t * c3));
                let slope = c1 + t * (2.0 * c2 + t * (3.0 * c3));
                let scale = if i <= self.fine_cells { &self.fine } else { &self.coarse };
                (value, slope * scale.cells_per_metre)
            }
            None => (f64::NAN, f64::NAN),
        }
    }

    /// Rate of change of the tangent \[Pa/m2\] at closure increment `x` \[m\], of the cubic there; NaN
    /// outside the table. Its error is of second order in the width of a cell.
    #[inline(always)]
    pub fn tangent_slope(&self, x: f64) -> f64 {
        let (i, t) = self.place(x);
        let Some(&[_, _, c2, c3]) = self.cells.get(i as usize) else { return f64::NAN };
        let scale = if i <= self.fine_cells { &self.fine } else { &self.coarse };
        (2.0 * c2 + t * 6.0 * c3) * scale.cells_per_metre * scale.cells_per_metre
    }

    /// Tangent dp/dd \[Pa/m\] at closure increment `x` \[m\], that of
    /// [`get_with_tangent`](Self::get_with_tangent).
    #[inline(always)]
    pub fn tangent(&self, x: f64) -> f64 {
        let (i, t) = self.place(x);
        let Some(&[_, c1, c2, c3]) = self.cells.get(i as usize) else { return f64::NAN };
        let scale = if i <= self.fine_cells { &self.fine } else { &self.coarse };
        (c1 + t * (2.0 * c2 + t * (3.0 * c3))) * scale.cells_per_metre
    }

    /// The cell of `x` and the place in it, 0 <= t < 1. The conversion saturates, so that everything
    /// below the table falls in cell 0.
    #[inline(always)]
    fn place(&self, x: f64) -> (u32, f64) {
        let scale = if x < self.fine_below { &self.fine } else { &self.coarse };
        let s = x * scale.cells_per_metre + scale.offset;
        let i = s as u32;
        (i, s - f64::from(i))
    }

    /// Pressure \[Pa\] of the state.
    pub fn pressure_state(&self) -> f64 {
        self.pressure_state
    }

    /// Closure increment \[m\] where the table starts: loss of contact if the law separates ([`get`](Self::get)
    /// is defined below it too).
    pub fn x_lo(&self) -> f64 {
        self.x_lo
    }

    /// Closure increment \[m\] where the table ends.
    pub fn x_hi(&self) -> f64 {
        self.x_hi
    }

    /// Estimate of the greatest difference \[Pa\] between table and law, from samples.
    pub fn error_estimate(&self) -> f64 {
        self.error_estimate
    }

    /// The cells `[c0, c1, c2, c3]`, for kernels that evaluate several at a time: at x, with s from
    /// [`scales`](Self::scales) and `t = s - floor(s)`, cell `floor(s)` (0 if s < 1) gives
    /// `c0 + t (c1 + t (c2 + t c3))`.
    pub fn cells(&self) -> &[[f64; 4]] {
        &self.cells
    }

    /// The scale of the divided cells, for `x < fine_below`, and that of the others.
    pub fn scales(&self) -> [CellScale; 2] {
        [self.fine, self.coarse]
    }

    /// Closure increment \[m\] below which cells are divided; -inf if none are.
    pub fn fine_below(&self) -> f64 {
        self.fine_below
    }

    /// The table on the first `places` of a grid, before its error is estimated.
    fn on_grid(
        source: &Source<'_>,
        range: &TableRange,
        grid: &ClosureGrid,
        places: &[f64],
    ) -> Self {
        let state = source.state;
        let divided = range.divided(grid);
        let fine_cells = divided * DIVISION;
        let part = 1.0 / DIVISION as f64;
        let nodes = source.nodes(range, grid, places);
        // The rise over a cell at the tangent of a node.
        let rise = |node: Pressure, width: f64| (node.value, node.tangent * (grid.width * width));
        let mut cells = Vec::with_capacity(places.len());
        cells.push(if range.separates { [0.0 - state, 0.0, 0.0, 0.0] } else { [f64::NAN; 4] });
        for (i, pair) in nodes.windows(2).enumerate() {
            let width = if i < fine_cells { part } else { 1.0 };
            cells.push(hermite(rise(pair[0], width), rise(pair[1], width)));
        }

        let below = grid.below as f64;
        let (inverse, division) = (1.0 / grid.width, DIVISION as f64);
        let mut fine =
            CellScale { cells_per_metre: inverse * division, offset: 1.0 + below * division };
        let mut coarse = CellScale {
            cells_per_metre: inverse,
            offset: 1.0 + below + (fine_cells - divided) as f64,
        };
        let first = if divided > 0 { &mut fine } else { &mut coarse };
        *first = first.starting_at(range.down);
        Self {
            cells,
            fine_cells: fine_cells as u32,
            fine_below: if divided > 0 { grid.closure(divided as f64) } else { f64::NEG_INFINITY },
            fine,
            coarse,
            pressure_state: state,
            x_lo: range.down,
            x_hi: grid.closure(grid.count() as f64),
            error_estimate: f64::INFINITY,
        }
    }
}

/// The cubic on 0 <= t < 1 from values and rises at its ends.
fn hermite((y0, m0): (f64, f64), (y1, m1): (f64, f64)) -> [f64; 4] {
    let rise = y1 - y0;
    [y0, m0, 3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Constant, ModifiedPower, Power, Tabulated};

    /// Numbers of cells that are passed over would not have been enough: half the cells of a table miss the
    /// tolerance.
    #[test]
    fn tables_have_no_more_cells_than_they_need() {
        let knots = [(0.0, 0.02e12), (0.025e6, 0.12e12), (0.078e6, 0.40e12), (0.14e6, 0.97e12)];
        let points = [(0.14e6, 1.15e12), (0.35e6, 1.75e12), (0.57e6, 1.63e12), (1e6, 2.46e12)];
        let laws: [&dyn ContactLaw; 4] = [
            &ModifiedPower::new(1.81e10, 0.35, 0.2e6, &knots).unwrap(),
            &Power::new(1.81e10, 0.35, 0.0).unwrap(),
            &Tabulated::new(&points).unwrap(),
            &Constant::new(8.5e11).unwrap(),
        ];
        let (state, layout) = (137_340.0, CellLayout::Uniform);
        for law in laws {
            for exponent in [16, 18, 20, 22] {
                let top = state + f64::from(exponent).exp2();
                let scale = state.max((top - state) / 1000.0);
                for tolerance in [1e-4, 1e-5, 1e-7] {
                    let table = CompiledLaw::uniform(law, state, top, tolerance).unwrap();
                    let doublings =
                        ((table.cells.len() as f64) / FIRST_CELLS as f64).log2().round();
                    if doublings == 0.0 {
                        continue;
                    }
                    let fewer = FIRST_CELLS << (doublings as usize - 1);
                    let range = TableRange::of(law, (state, top), tolerance, layout).unwrap();
                    let grid = range.grid(fewer, LAST_CELLS + 2).unwrap();
                    let places = range.places(&grid);
                    let limit = tolerance * scale;
                    let source = Source::new(law, (state, top), limit);
                    let coarse = CompiledLaw::on_grid(&source, &range, &grid, &places);
                    let smooth = coarse.smooth_errors(&source, &grid);
                    let bound =
                        coarse.estimate_error((&source, &range), &grid, &smooth, f64::INFINITY);
                    assert!(bound > limit, "{law:?} {exponent} {tolerance}: {bound} <= {limit}");
                }
            }
        }
    }

    /// Divided cells hold the cubics of the table: equal to rounding, zero at rest and open where contact is lost.
    #[test]
    fn divided_cells_are_the_same_table() {
        let laws: [&dyn ContactLaw; 3] = [
            &Power::new(1.81e10, 0.35, 0.0).unwrap(),
            &Tabulated::new(&[(0.14e6, 1.15e12), (0.35e6, 1.75e12), (1e6, 2.46e12)]).unwrap(),
            &Constant::new(8.5e11).unwrap(),
        ];
        for law in laws {
            let pressures = (137_340.0, 4e5);
            let table = CompiledLaw::uniform(law, pressures.0, pressures.1, 1e-5).unwrap();
            let cells = 5 * table.cells.len();
            let divided = CompiledLaw::uniform_of(law, pressures, 1e-5, cells).unwrap();
            assert!((cells..=2 * cells).contains(&(divided.cells().len() - 1)), "{law:?}");
            assert_eq!(divided.get(0.0), 0.0);
            let below = table.x_lo().next_down();
            assert_eq!(divided.get(below).to_bits(), table.get(below).to_bits());
            let rounding = 1e-9 * table.error_estimate().max(1.0);
            for i in 0..10_000 {
                let x = table.x_lo() + (table.x_hi() - table.x_lo()) * (f64::from(i) + 0.5) / 1e4;
                let [(p, k), (q, l)] = [&table, &divided].map(|one| one.get_with_tangent(x));
                assert!((p - q).abs() <= rounding, "{law:?} {x}: {p} {q}");
                assert!((k - l).abs() <= 1e-9 * k.abs(), "{law:?} {x}: {k} {l}");
            }
        }
    }
}
