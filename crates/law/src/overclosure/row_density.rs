//! Number of rows per pressure of a pressure-overclosure table.

use crate::contact_law::ContactLaw;

/// Cells on which the density is integrated; their ends lie at the cubes of equal steps.
const CELLS: usize = 4096;

/// Parts of the rows spread by the closure error, by the tangent error, and evenly.
const CLOSURE_PART: f64 = 0.75;
const TANGENT_PART: f64 = 0.2;
const EVEN_PART: f64 = 0.05;

/// Density of rows below the dense ones, as a share of the one that its errors would need.
const BELOW_DENSE: f64 = 0.4;

/// The share of the rows of a table below each pressure.
///
/// A straight segment of pressure width w has, relative to the overclosure o, the closure error
/// `w^2 K' / (8 K^2 o)`, and relative to K the tangent error `w K' / (2 K)`. Both are equal in all
/// segments if the rows per pressure are proportional to
///
/// ```text
/// sqrt(K' / (K^2 o))    and    K' / K.
/// ```
///
/// The density is a weighted sum of both and of an even one. Below the dense rows `o` and K
/// are held at their values there and the density is reduced, so that the low pressures take few
/// rows.
pub(super) struct RowDensity {
    low: f64,
    top: f64,
    /// Share of the rows below the start of each cell and the last end, from 0 to 1.
    shares: Vec<f64>,
    straight: bool,
}

impl RowDensity {
    /// The density between the first and the last of `pressures`; from the second on the rows are
    /// dense.
    pub(super) fn new(
        law: &dyn ContactLaw,
        overclosure: &dyn Fn(f64) -> f64,
        pressures: [f64; 3],
    ) -> Self {
        let [low, dense, top] = pressures;
        let (dense_overclosure, dense_stiffness) = (overclosure(dense), law.stiffness(dense));
        let edge = |cell: usize| low + (top - low) * (cell as f64 / CELLS as f64).powi(3);
        let mut densities = Vec::with_capacity(CELLS);
        for cell in 0..CELLS {
            let (start, stop) = (edge(cell), edge(cell + 1));
            let pressure = 0.5 * (start + stop);
            let (stiffness, slope) = (law.stiffness(pressure), law.stiffness_slope(pressure).abs());
            let (o, k, width) = if pressure < dense {
                let width = BELOW_DENSE * (stop - start);
                (dense_overclosure, stiffness.max(dense_stiffness), width)
            } else {
                (overclosure(pressure), stiffness, stop - start)
            };
            let closure = (slope / (k * stiffness * o)).sqrt() * width;
            densities.push([closure, slope / k * width, width]);
        }
        let totals = densities
            .iter()
            .fold([0.0; 3], |sum, density| std::array::from_fn(|part| sum[part] + density[part]));
        let straight = totals[1] < 1e-9;
        let parts = [CLOSURE_PART, TANGENT_PART, EVEN_PART];
        let weights: [f64; 3] =
            std::array::from_fn(
                |part| {
                    if totals[part] > 0.0 { parts[part] / totals[part] } else { 0.0 }
                },
            );
        let mut shares = vec![0.0];
        let mut sum = 0.0;
        for density in &densities {
            sum += (0..3).map(|part| weights[part] * density[part]).sum::<f64>();
            shares.push(sum);
        }
        for share in &mut shares {
            *share /= sum;
        }
        Self { low, top, shares, straight }
    }

    /// True for a law of constant stiffness.
    pub(super) fn is_straight(&self) -> bool {
        self.straight
    }

    /// Share of the rows below a pressure.
    pub(super) fn share(&self, pressure: f64) -> f64 {
        let place = ((pressure - self.low) / (self.top - self.low)).clamp(0.0, 1.0).cbrt();
        let cell = ((place * CELLS as f64) as usize).min(CELLS - 1);
        let (start, stop) = (self.edge(cell), self.edge(cell + 1));
        let (before, after) = (self.shares[cell], self.shares[cell + 1]);
        before + (after - before) * (pressure - start) / (stop - start)
    }

    /// The ends of a segment about a pressure, of the width that `segments` segments have, times
    /// `width`.
    pub(super) fn around(&self, pressure: f64, segments: usize, width: f64) -> [f64; 2] {
        let share = self.share(pressure);
        let half = 0.5 * width / segments as f64;
        [
            self.pressure((share - half).max(0.5 * share)),
            self.pressure((share + half).min(0.5 * (1.0 + share))),
        ]
    }

    /// The ends of `segments` segments from one pressure to another.
    pub(super) fn pressures(&self, from: f64, to: f64, segments: usize) -> Vec<f64> {
        let (first, last) = (self.share(from), self.share(to));
        let inner =
            |row: usize| self.pressure(first + (last - first) * row as f64 / segments as f64);
        let mut pressures = vec![from];
        pressures.extend((1..segments).map(inner));
        pressures.push(to);
        pressures
    }

    /// Pressure below which a share of the rows lies.
    fn pressure(&self, share: f64) -> f64 {
        let cell = self.shares.partition_point(|before| *before <= share).clamp(1, CELLS) - 1;
        let (before, after) = (self.shares[cell], self.shares[cell + 1]);
        let (start, stop) = (self.edge(cell), self.edge(cell + 1));
        start + (stop - start) * (share - before) / (after - before)
    }

    fn edge(&self, cell: usize) -> f64 {
        self.low + (self.top - self.low) * (cell as f64 / CELLS as f64).powi(3)
    }
}
