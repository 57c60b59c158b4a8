//! The range of closures of a table, and its nodes.

use crate::contact_law::ContactLaw;
use crate::error::{LawError, LawQuantity, above, finite};

/// Lowest pressure over that of the state, for a law that never separates: in tables that end there; and in
/// uniform ones, which fall to zero from it, over the tolerance, and at most.
const LOWEST: f64 = 1.0 / 64.0;
const LOWEST_UNIFORM: f64 = 0.1;
const MOST_UNIFORM: f64 = 1e-6;

/// Number of cells next to a singular loss of contact that are divided, and the division of each. A
/// power law `d^a`, 1 < a < 2, has errors like `i^(a-4)` in cell i; both numbers reduce them alike.
pub(super) const DIVIDED: usize = 8;
pub(super) const DIVISION: usize = 32;

/// Division of the cells next to a singular loss of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CellLayout {
    Divided,
    Uniform,
}

/// Closure increments to cover.
pub(super) struct TableRange {
    pub(super) separates: bool,
    /// Contact is lost where the stiffness leaves zero with a vertical tangent.
    pub(super) singular: bool,
    layout: CellLayout,
    pub(super) down: f64,
    up: f64,
}

impl TableRange {
    pub(super) fn of(
        law: &dyn ContactLaw,
        (state, top): (f64, f64),
        tolerance: f64,
        layout: CellLayout,
    ) -> Result<Self, LawError> {
        let domain = law.domain();
        let uniform = layout == CellLayout::Uniform;
        let lowest = if domain.is_bilateral() {
            state - (top - state)
        } else if domain.separates() {
            if state < 0.0 {
                return Err(LawError::Below {
                    quantity: LawQuantity::PressureState,
                    value: state,
                    limit: 0.0,
                });
            }
            0.0
        } else {
            above(LawQuantity::PressureState, state, 0.0)?
                * if uniform { (LOWEST_UNIFORM * tolerance).min(MOST_UNIFORM) } else { LOWEST }
        };
        let down = if lowest == state { 0.0 } else { law.closure_increment(state, lowest - state) };
        Ok(Self {
            separates: domain.separates(),
            singular: domain.separates() && law.stiffness_slope(0.0) == f64::INFINITY,
            layout,
            down: finite(LawQuantity::PressureState, down)?,
            up: finite(LawQuantity::PressureTop, law.closure_increment(state, top - state))?,
        })
    }

    /// Number of cells of a grid that are divided, those next to a singular loss of contact.
    pub(super) fn divided(&self, grid: &ClosureGrid) -> usize {
        if self.singular && self.layout == CellLayout::Divided {
            grid.count().min(DIVIDED)
        } else {
            0
        }
    }

    /// Places of the nodes of a grid, in cells from the lowest.
    pub(super) fn places(&self, grid: &ClosureGrid) -> Vec<f64> {
        let (divided, part) = (self.divided(grid), 1.0 / DIVISION as f64);
        let fine = (0..divided * DIVISION).map(|i| i as f64 * part);
        fine.chain((divided..=grid.count()).map(|i| i as f64)).collect()
    }

    /// A grid of at least about `cells` cells with nodes at the state and at `down`; `None` if it
    /// would take more than `most`.
    pub(super) fn grid(&self, cells: usize, most: usize) -> Option<ClosureGrid> {
        let (down, up) = (-self.down, self.up);
        let share = down / (down + up);
        // Rounded down: at most one cell more than requested.
        let mut below = (share * cells as f64).floor();
        if down > 0.0 {
            below = below.max(1.0);
        }
        let width = if below > 0.0 { down / below } else { up / cells as f64 };
        let above = (up / width).ceil().max(1.0);
        (below + above <= most as f64).then_some(ClosureGrid {
            below: below as usize,
            above: above as usize,
            width,
        })
    }
}

/// Uniform cells below and above the state.
pub(super) struct ClosureGrid {
    pub(super) below: usize,
    above: usize,
    pub(super) width: f64,
}

impl ClosureGrid {
    pub(super) fn count(&self) -> usize {
        self.below + self.above
    }

    /// Closure increment at `i` cells from the lowest node.
    pub(super) fn closure(&self, i: f64) -> f64 {
        (i - self.below as f64) * self.width
    }
}
