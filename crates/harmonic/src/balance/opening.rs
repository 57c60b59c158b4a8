//! Contacts that open with a stiffness: the kink of their force between two samples.

use asperity_structure::PreloadedContact;

use crate::fourier::Fourier;

/// Relative difference of stiffnesses that is rounding.
const CONSTANT: f64 = 1e-9;

/// The closure at which a contact opens, and its stiffness next to it.
///
/// The force near it is `k max(x - x0, 0)`. Its sum over equal samples has a slope that jumps with every sample
/// that passes x0, and a branch has a kink there. With a straight line between two samples, `a > 0 > b` from x0,
/// the triangle between the force and the chord of its samples,
///
/// ```text
/// k a b / (2 (a - b)),   its centre (1 + a / (a - b)) / 3 of the way from a,
/// ```
///
/// belongs to both by its first moment: the slope then changes by a sixth of the second difference of each
/// harmonic only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Opening {
    /// Closure increment from rest \[m\].
    closure: f64,
    /// Stiffness \[N/m\].
    stiffness: f64,
}

/// The corrections of two neighbouring samples, closed and open, and their derivatives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    places: [usize; 2],
    /// Derivatives of each correction with respect to the closures at both \[N/m\].
    slopes: [[f64; 2]; 2],
}

impl Opening {
    /// The opening of a contact of constant stiffness; `None` for one that never opens, or whose stiffness changes
    /// with pressure.
    pub(super) fn of(contact: &PreloadedContact) -> Option<Self> {
        let law = contact.law();
        let (closure, stiffness) = (law.closure(0.0) - contact.closure(), law.stiffness(0.0));
        let opens = law.domain().separates() && closure.is_finite();
        let is_constant = (stiffness / contact.stiffness() - 1.0).abs() < CONSTANT;
        (opens && is_constant).then_some(Self { closure, stiffness: contact.area() * stiffness })
    }

    /// Corrects the force at the samples beside each crossing.
    pub(super) fn correct(&self, closures: &[f64], forces: &mut [f64], found: &mut Vec<Crossing>) {
        found.clear();
        let count = closures.len();
        for n in 0..count {
            let next = if n + 1 < count { n + 1 } else { 0 };
            let (here, there) = (closures[n] - self.closure, closures[next] - self.closure);
            let (a, b, places) = if here > 0.0 && there < 0.0 {
                (here, there, [n, next])
            } else if here < 0.0 && there > 0.0 {
                (there, here, [next, n])
            } else {
                continue;
            };
            let square = (a - b) * (a - b);
            let area = self.stiffness * a * b / (2.0 * (a - b));
            let d_area = [-b * b, a * a].map(|part| 0.5 * self.stiffness * part / square);
            let centre = (1.0 + a / (a - b)) / 3.0;
            let d_centre = [-b, a].map(|part| part / (3.0 * square));
            forces[places[0]] += area * (1.0 - centre);
            forces[places[1]] += area * centre;
            let slope = |j: usize| area * d_centre[j];
            let first = [0, 1].map(|j| d_area[j] * (1.0 - centre) - slope(j));
            let second = [0, 1].map(|j| d_area[j] * centre + slope(j));
            found.push(Crossing { places, slopes: [first, second] });
        }
    }
}

impl Crossing {
    /// Adds the derivative of the series of the corrections with respect to that of the closures.
    pub(super) fn add_to(&self, fourier: &Fourier, matrix: &mut [f64]) {
        let terms = fourier.terms();
        let [closed, open] = self.places;
        for (row, values) in matrix.chunks_exact_mut(terms).enumerate() {
            let scale = if row == 0 { 1.0 } else { 2.0 } / fourier.samples() as f64;
            let own = fourier.row(row);
            let along = |j: usize| own[closed] * self.slopes[0][j] + own[open] * self.slopes[1][j];
            let (by_closed, by_open) = (scale * along(0), scale * along(1));
            for (column, value) in values.iter_mut().enumerate() {
                let basis = fourier.row(column);
                *value += by_closed * basis[closed] + by_open * basis[open];
            }
        }
    }
}
