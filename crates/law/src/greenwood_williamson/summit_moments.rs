//! Moments of normally distributed heights above a plane.

use std::f64::consts::TAU;

/// Separation below which the expansion about the mean is exact to rounding.
const EXPANDED_BELOW: f64 = -36.0;

/// Terms of that expansion.
const TERMS: u32 = 9;

/// Step of the trapezoidal rule at the mean of the heights.
const STEP: f64 = 0.12;

/// Exponent of the integrand below which it is negligible.
const NEGLIGIBLE: f64 = -45.0;

/// The moments
///
/// ```text
/// F_n(h) = integral from h of (z - h)^n exp(-z^2/2) dz / sqrt(2 pi),    n = -1/2, 1/2, 3/2, 5/2,
/// ```
///
/// divided by `exp(log_factor)`. With `z - h = s^2` the integrand is an even analytic function of s,
///
/// ```text
/// F_n(h) = integral over all s of s^(2n+1) exp(-(h + s^2)^2 / 2) ds / sqrt(2 pi),
/// ```
///
/// which the trapezoidal rule integrates to rounding. Where all heights are above the plane,
/// `F_n = E[(z - h)^n]` is expanded in the moments of z. Relative precision about 1e-15.
pub(super) struct SummitMoments {
    pub(super) log_factor: f64,
    /// Rounding of `log_factor`, to be added.
    log_rest: f64,
    pub(super) minus_half: f64,
    pub(super) half: f64,
    pub(super) three_halves: f64,
    pub(super) five_halves: f64,
}

impl SummitMoments {
    /// The moments at the gap `h` in standard deviations.
    pub(super) fn at(h: f64) -> Self {
        let (log_factor, [minus_half, half, three_halves, five_halves]) =
            if h < EXPANDED_BELOW { (0.0, expanded(h)) } else { summed(h) };
        let square = h * h;
        let log_rest = if log_factor < 0.0 { -0.5 * h.mul_add(h, -square) } else { 0.0 };
        Self { log_factor, log_rest, minus_half, half, three_halves, five_halves }
    }

    /// `exp(log_factor)` to its last digits.
    pub(super) fn factor(&self) -> f64 {
        let factor = self.log_factor.exp();
        factor + factor * self.log_rest
    }
}

fn summed(h: f64) -> (f64, [f64; 4]) {
    let step = STEP / (1.0 + if h > 0.0 { h / 6.0 } else { -h / 4.0 }).sqrt();
    let mut sums = [0.0; 4];
    let mut weight = 0.5;
    for place in 0_u32.. {
        let square = (step * f64::from(place)).powi(2);
        let exponent =
            if h >= 0.0 { -square * (h + 0.5 * square) } else { -0.5 * (h + square).powi(2) };
        if exponent < NEGLIGIBLE && square > -h || exponent.is_nan() {
            break;
        }
        let mut value = weight * exponent.exp();
        for sum in &mut sums {
            *sum += value;
            value *= square;
        }
        weight = 1.0;
    }
    let factor = 2.0 * step / TAU.sqrt();
    let log_factor = if h >= 0.0 { -0.5 * h * h } else { 0.0 };
    (log_factor, if h.is_nan() { [f64::NAN; 4] } else { sums.map(|sum| factor * sum) })
}

fn expanded(h: f64) -> [f64; 4] {
    let square = 1.0 / (h * h);
    [-0.5, 0.5, 1.5, 2.5].map(|n: f64| {
        let (mut sum, mut term) = (0.0, 1.0);
        for order in 0..TERMS {
            let k = f64::from(2 * order);
            sum += term;
            term *= (n - k) * (n - k - 1.0) / (k + 2.0) * square;
        }
        (-h).powf(n) * sum
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From `F_n(h) = Gamma(n+1) exp(-h^2/4) D_(-n-1)(h) / sqrt(2 pi)`, D the parabolic cylinder
    /// function, computed with 40 digits.
    #[test]
    fn moments_have_their_exact_values() {
        let found = |h: f64| {
            let m = SummitMoments::at(h);
            let values = [m.minus_half, m.half, m.three_halves, m.five_halves];
            values.map(|value| value * m.factor())
        };
        for (h, expected) in REFERENCE {
            for (found, expected) in found(h).into_iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 4e-15, "{h}: {found:e}");
            }
        }
        // Both forms where they meet.
        for (above, below) in found(-36.0).into_iter().zip(found(-36.0 - 1e-12)) {
            assert!((above / below - 1.0).abs() < 1e-12, "{above} {below}");
        }
    }

    #[allow(clippy::unreadable_literal, reason = "numbers from another program")]
    const REFERENCE: [(f64, [f64; 4]); 9] = [
        (
            -100.0,
            [1.000037508206511e-1, 9.999874988278172, 1.000037500703228e+3, 1.000187498828052e+5],
        ),
        (
            -20.0,
            [2.238175875507507e-1, 4.470735115283983, 8.952661109945504e+1, 1.797238324662027e+3],
        ),
        (
            -5.0,
            [4.546437679618386e-1, 2.224413182805135, 1.134938779800659e+1, 6.008355876424067e+1],
        ),
        (-1.0, [1.007989078407272, 9.006029312703163e-1, 1.404597470473952, 2.755501867379427]),
        (
            0.0,
            [
                8.600399873245195e-1,
                4.110894793312293e-1,
                4.300199936622598e-1,
                6.166342189968439e-1,
            ],
        ),
        (
            1.0,
            [
                3.596437053976655e-1,
                1.041536753078577e-1,
                7.566817739097507e-2,
                8.056233557081147e-2,
            ],
        ),
        (
            3.0,
            [
                4.379037744630239e-3,
                6.418504393485508e-4,
                2.639675542694673e-4,
                1.708729962144244e-4,
            ],
        ),
        (
            9.0,
            [
                6.046080150118436e-19,
                3.299589274194585e-20,
                5.340972828409176e-21,
                1.425083657236186e-21,
            ],
        ),
        (
            15.0,
            [
                2.526926753971716e-50,
                8.3679070533117e-52,
                8.277318989102985e-53,
                1.358820963130725e-53,
            ],
        ),
    ];
}
