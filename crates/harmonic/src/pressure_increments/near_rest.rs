//! The pressure next to rest.

use asperity_law::Pressure;

/// Coefficients of a polynomial of the tangent.
const TERMS: usize = 6;

/// Reach over the closure that would relieve the contact at its stiffness at rest: at most, and its share at each
/// further trial.
const REACH: f64 = 1e-3;
const SHRINK: f64 = 0.25;
const TRIALS: i32 = 4;

/// Largest error of a tangent, and of the pressure where the polynomials end, relative to the stiffness at rest.
const TANGENT_ERROR: f64 = 1e-11;
const PRESSURE_ERROR: f64 = 1e-10;

/// Pressure increments next to rest, with as many digits for a small closure as for a large one.
///
/// The difference `p(x) - p(0)` of a table or a law is rounded to 1e-16 of the static pressure, and `x` to as
/// much of the closure at rest: a motion of 1e-9 of either has seven digits, fewer than the equations of its
/// harmonics need. Tangents are no differences. On each side of rest a polynomial of fifth degree goes through six of them,
/// and the increment is its integral,
///
/// ```text
/// p(x) - p(0) = x sum_i k_i t^i / (i + 1),    dp/dx = sum_i k_i t^i,    t = |x| / reach.
/// ```
#[derive(Debug, Clone)]
pub(super) struct NearRest {
    reach: f64,
    /// Of opening and of closing \[Pa/m\].
    tangents: [[f64; TERMS]; 2],
}

impl NearRest {
    /// Polynomials of the increments `at` about rest, of a contact of this stiffness \[Pa/m\] that a closure of `scale` \[m\]
    /// would relieve; none where none is exact next to rest, as beside an end of a table's cell.
    pub(super) fn new(scale: f64, stiffness: f64, at: impl Fn(f64) -> Pressure) -> Option<Self> {
        let reaches = (0..TRIALS).map(|trial| REACH * SHRINK.powi(trial) * scale);
        let exact = |reach: f64| {
            let [opening, closing] = [-1.0, 1.0].map(|sense| {
                let tangents = fit(|t| at(sense * t * reach).tangent);
                let near = Self { reach, tangents: [tangents; 2] };
                let is_exact = (0..=2 * TERMS).all(|n| {
                    let x = sense * reach * n as f64 / (2 * TERMS) as f64;
                    let (own, given) = (near.polynomial(x, &tangents), at(x));
                    let value =
                        (own.value - given.value).abs() <= PRESSURE_ERROR * stiffness * reach;
                    // At rest the tangent may be that of the other side.
                    let tangent = (own.tangent - given.tangent).abs() <= TANGENT_ERROR * stiffness;
                    value && (tangent || n == 0)
                });
                is_exact.then_some(tangents)
            });
            Some(Self { reach, tangents: [opening?, closing?] })
        };
        reaches.into_iter().find_map(exact)
    }

    /// Pressure increment and tangent; none beyond the polynomials.
    #[inline]
    pub(super) fn get(&self, x: f64) -> Option<Pressure> {
        let side = &self.tangents[usize::from(x > 0.0)];
        (x.abs() < self.reach).then(|| self.polynomial(x, side))
    }

    #[inline]
    fn polynomial(&self, x: f64, tangents: &[f64; TERMS]) -> Pressure {
        let t = x.abs() / self.reach;
        let (mut tangent, mut mean) = (0.0, 0.0);
        for (i, k) in tangents.iter().enumerate().rev() {
            tangent = k + t * tangent;
            mean = k / (i + 1) as f64 + t * mean;
        }
        Pressure { value: x * mean, tangent }
    }
}

/// Coefficients of the polynomial through `value` at the Chebyshev points of 0 to 1, by divided differences.
fn fit(value: impl Fn(f64) -> f64) -> [f64; TERMS] {
    let angle = |j: usize| std::f64::consts::PI * (2 * j + 1) as f64 / (2 * TERMS) as f64;
    let points: [f64; TERMS] = std::array::from_fn(|j| 0.5 - 0.5 * angle(j).cos());
    let mut differences = points.map(value);
    for order in 1..TERMS {
        for j in (order..TERMS).rev() {
            let step = points[j] - points[j - order];
            differences[j] = (differences[j] - differences[j - 1]) / step;
        }
    }
    // Newton's form, multiplied out from the innermost factor.
    let mut coefficients = [0.0; TERMS];
    for j in (0..TERMS).rev() {
        for i in (1..TERMS).rev() {
            coefficients[i] = coefficients[i - 1] - points[j] * coefficients[i];
        }
        coefficients[0] = differences[j] - points[j] * coefficients[0];
    }
    coefficients
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A law `p = (1 + x)^3 - 1` about its closure 1: the increment of a closure of 1e-12 has all digits, and the
    /// polynomials go over into the law.
    #[test]
    fn small_closures_have_as_many_digits_as_large_ones() {
        let exact = |x: f64| x * (3.0 + x * (3.0 + x));
        let law = |x: f64| {
            let closure = 1.0 + x;
            Pressure { value: closure.powi(3) - 1.0, tangent: 3.0 * closure * closure }
        };
        let near = NearRest::new(1.0 / 3.0, 3.0, law).unwrap();
        for x in [1e-15, -1e-12, 1e-9, -1e-6, 3.2e-4, -3.3e-4] {
            let found = near.get(x).unwrap();
            assert!((found.value / exact(x) - 1.0).abs() < 1e-14, "{x}: {found:?}");
            assert!((found.tangent / (3.0 * (1.0 + x).powi(2)) - 1.0).abs() < 1e-14, "{x}");
        }
        assert!((law(1e-12).value / exact(1e-12) - 1.0).abs() > 1e-5);
        assert_eq!(near.get(3.4e-4), None);
    }

    /// The stiffness jumps at rest: a polynomial for each side. Elsewhere it jumps beyond them, or nothing is exact.
    #[test]
    fn a_kink_is_kept() {
        let law = |kink: f64| {
            move |x: f64| {
                let soft = x < kink;
                let tangent = if soft { 1.0 } else { 2.0 };
                let value = if soft { x } else { 2.0 * x - kink };
                Pressure { value: if kink > 0.0 { value } else { tangent * x }, tangent }
            }
        };
        let near = NearRest::new(1.0, 1.0, law(0.0)).unwrap();
        assert!((near.get(-1e-12).unwrap().value / -1e-12 - 1.0).abs() < 1e-14);
        assert!((near.get(1e-12).unwrap().value / 2e-12 - 1.0).abs() < 1e-14);
        let near = NearRest::new(1.0, 1.0, law(3e-4)).unwrap();
        assert!((near.get(2e-4).unwrap().value / 2e-4 - 1.0).abs() < 1e-14);
        assert_eq!(near.get(2.6e-4), None);
        assert!(NearRest::new(1.0, 1.0, law(1e-9)).is_none());
    }
}
