//! The closures a table covers, and its nodes.

use super::LAST_CELLS;
use crate::error::{LawError, Quantity, above, finite};
use crate::law::ContactLaw;

/// Lowest pressure, as a part of the state's, of a law that never separates: where a caller can
/// turn to the exact law below it, and where it cannot.
const LOWEST: f64 = 1.0 / 64.0;
const LOWEST_UNIFORM: f64 = 1e-6;

/// Whether cells next to a singular loss of contact are divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    Divided,
    Uniform,
}

/// Closure increments to cover.
pub(super) struct Span {
    pub(super) separates: bool,
    /// Contact is lost where the stiffness leaves zero with a vertical tangent.
    pub(super) singular: bool,
    /// Below the table lies the pressure of its lowest node, though the law goes on falling.
    pub(super) floored: bool,
    pub(super) down: f64,
    up: f64,
}

impl Span {
    pub(super) fn of(
        law: &dyn ContactLaw,
        state: f64,
        top: f64,
        layout: Layout,
    ) -> Result<Self, LawError> {
        let domain = law.domain();
        let uniform = layout == Layout::Uniform;
        let lowest = if domain.is_bilateral() {
            state - (top - state)
        } else if domain.separates() {
            if state < 0.0 {
                return Err(LawError::Below {
                    quantity: Quantity::PressureState,
                    value: state,
                    limit: 0.0,
                });
            }
            0.0
        } else {
            above(Quantity::PressureState, state, 0.0)?
                * if uniform { LOWEST_UNIFORM } else { LOWEST }
        };
        let down = if lowest == state { 0.0 } else { law.closure_increment(state, lowest - state) };
        Ok(Self {
            separates: domain.separates(),
            singular: domain.separates() && law.stiffness_slope(0.0) == f64::INFINITY && !uniform,
            floored: uniform && !domain.separates() && !domain.is_bilateral(),
            down: finite(Quantity::PressureState, down)?,
            up: finite(Quantity::PressureTop, law.closure_increment(state, top - state))?,
        })
    }

    /// A grid of at least about `cells` cells with nodes at the state and at `down`; `None` if it
    /// would take more than the most allowed.
    pub(super) fn grid(&self, cells: usize) -> Option<Grid> {
        let (down, up) = (-self.down, self.up);
        let share = down / (down + up);
        // Rounded down, so that the cells do not exceed what is asked for by more than one.
        let mut below = (share * cells as f64).floor();
        if down > 0.0 {
            below = below.max(1.0);
        }
        let width = if below > 0.0 { down / below } else { up / cells as f64 };
        let above = (up / width).ceil().max(1.0);
        (below + above <= (LAST_CELLS + 2) as f64).then_some(Grid {
            below: below as usize,
            above: above as usize,
            width,
        })
    }
}

/// Uniform cells below and above the state.
pub(super) struct Grid {
    pub(super) below: usize,
    above: usize,
    pub(super) width: f64,
}

impl Grid {
    pub(super) fn count(&self) -> usize {
        self.below + self.above
    }

    /// Closure increment at `i` cells from the lowest node.
    pub(super) fn closure(&self, i: f64) -> f64 {
        (i - self.below as f64) * self.width
    }
}
