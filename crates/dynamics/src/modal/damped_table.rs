//! The law of a damped contact in one step, as tables.
//!
//! With the viscous impulse `R(x) = integral of c dx` from rest, the traction of a damped contact is
//! `t = q + dR/dt` over the static pressure. Both are functions of the closure increment x alone.
//! The rate at the end of a step is the slope of the quartic through five steps, so that
//!
//! ```text
//! t = Q(x) + sum_k a_k R_before_k / h,    Q(x) = q(x) + a_0 R(x) / h,
//! ```
//!
//! with an increasing Q, which takes the place of the law in the contact solve. A traction below
//! `-p0` is `-p0`, where the law separates.

use asperity_law::{CompiledLaw, ContactDamping};
use asperity_structure::PreloadedContact;

use super::simd::table_lookup::TableRow;

/// Earlier steps from which the rate of an impulse, and the next closure, are extrapolated.
pub(super) const PAST: usize = 4;

/// Weights of the rate at the end of a step, of the value there and of those at the steps before.
pub(super) const RATE: [f64; PAST + 1] = [25.0 / 12.0, -4.0, 3.0, -4.0 / 3.0, 0.25];

/// Multiple of `c / h` that counts as stiffness where a mode's interpolation is chosen. On a rigid
/// mode with the spring K the quartic grows from `(K + 2.5 c / h) h^2 / m = 1.44` on at the earliest,
/// for `c / (K h)` from 0 to 100; the mean of both ends is stable with any.
const COUNTS_AS_STIFFNESS: f64 = 2.5;

/// Stiffness \[Pa/m\] of `contact` at `pressure` \[Pa\], with what its damper adds in a step \[s\].
pub(super) fn stiffness_in_step(contact: &PreloadedContact, pressure: f64, step: f64) -> f64 {
    let stiffness = contact.law().stiffness(pressure);
    let coefficient = |damping: ContactDamping| damping.coefficient(pressure, stiffness);
    stiffness + COUNTS_AS_STIFFNESS / step * contact.damping().map_or(0.0, coefficient)
}

/// Q and R of one contact, on the cells of the table of its law.
#[derive(Debug, Clone)]
pub(super) struct DampedTable {
    /// Q, then R, by cells.
    rows: Vec<TableRow>,
}

impl DampedTable {
    /// The tables of `contact` in steps of `step` \[s\], whose law is `table`.
    pub(super) fn new(contact: &PreloadedContact, table: &CompiledLaw, step: f64) -> Self {
        let viscous = match contact.damping() {
            Some(damping) => impulse(contact, damping, table),
            None => vec![[0.0; 4]; table.cells().len()],
        };
        let combined = table.cells().iter().zip(&viscous).map(|(q, r)| {
            let mut row = *q;
            for (q, r) in row.iter_mut().zip(r) {
                *q += RATE[0] / step * r;
            }
            row
        });
        let mut rows: Vec<TableRow> = combined.collect();
        rows.extend(viscous);
        Self { rows }
    }

    /// Rows of Q, and behind them as many of R.
    pub(super) fn rows(&self) -> &[TableRow] {
        &self.rows
    }

    /// R \[Pa s\] at a place in cells, a whole number where one begins.
    pub(super) fn impulse(&self, place: f64) -> f64 {
        let cells = self.rows.len() / 2;
        let cell = (place.floor() as usize).min(cells.saturating_sub(1));
        let Some([c0, c1, c2, c3]) = self.rows.get(cells + cell) else { return 0.0 };
        let t = place - cell as f64;
        c0 + t * (c1 + t * (c2 + t * c3))
    }
}

/// Places and weights of the Gauss rule of four points on 0 to 1.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_7, 0.173_927_422_568_727),
    (0.330_009_478_207_572, 0.326_072_577_431_273),
    (0.669_990_521_792_428, 0.326_072_577_431_273),
    (0.930_568_155_797_026, 0.173_927_422_568_727),
];

/// Cubics of R on the cells of the law's table: the impulse of each cell by quadrature, its slopes
/// the coefficients at its ends, or its mean slope where such a coefficient is not finite.
fn impulse(
    contact: &PreloadedContact,
    damping: ContactDamping,
    table: &CompiledLaw,
) -> Vec<TableRow> {
    let scale = table.scales()[1];
    let state = contact.pressure();
    // The coefficient times the width of a cell.
    let slope = |[c0, c1, c2, c3]: TableRow, t: f64| {
        let pressure = state + c0 + t * (c1 + t * (c2 + t * c3));
        let stiffness = (c1 + t * (2.0 * c2 + t * 3.0 * c3)) * scale.cells_per_metre;
        damping.coefficient(pressure, stiffness) / scale.cells_per_metre
    };
    let mut value = 0.0;
    let mut rows: Vec<TableRow> = table
        .cells()
        .iter()
        .map(|&cell| {
            let rise: f64 = GAUSS.iter().map(|&(t, weight)| weight * slope(cell, t)).sum();
            let end = |t: f64| Some(slope(cell, t)).filter(|c| c.is_finite()).unwrap_or(rise);
            let (start, end) = (end(0.0), end(1.0));
            let row = [value, start, 3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise];
            // Below the table of a law that carries tension there are no numbers.
            value += if rise.is_finite() { rise } else { 0.0 };
            row
        })
        .collect();
    // Counted from rest, where a cell begins.
    let at_rest = rows.get(scale.offset as usize).map_or(0.0, |row| row[0]);
    for row in &mut rows {
        row[0] -= at_rest;
    }
    rows
}
