//! The modified Bessel function of Kaiser's windows.

use std::f64::consts::TAU;

/// Argument from which the asymptotic series is used.
const ASYMPTOTIC: f64 = 30.0;

/// Modified Bessel function `I0(x)` for `x >= 0`, to rounding.
///
/// Power series `sum ((x/2)^k / k!)^2` below 30, asymptotic series
/// `exp(x) / sqrt(2 pi x) sum (1^2 3^2 ... (2k-1)^2) / (k! (8x)^k)` above.
///
/// Source: M. Abramowitz and I. A. Stegun, *Handbook of Mathematical Functions*, 9.6.12, 9.7.1.
pub(crate) fn bessel_i0(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    if x < ASYMPTOTIC {
        let quarter = 0.25 * x * x;
        // The terms fall once k > x/2; 60 are more than enough.
        for k in 1..=60_u32 {
            term *= quarter / f64::from(k * k);
            sum += term;
            if term < 1e-17 * sum {
                break;
            }
        }
        return sum;
    }
    // The terms fall until k = 2 x.
    for k in 1..=20_u32 {
        let odd = f64::from(2 * k - 1);
        term *= odd * odd / (8.0 * x * f64::from(k));
        sum += term;
        if term < 1e-17 {
            break;
        }
    }
    x.exp() / (TAU * x).sqrt() * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verified against tabulated `I0(1)`, and on both sides of 30 against the power series, to the
    /// rounding of exp(x).
    #[test]
    fn both_series_agree() {
        assert!((bessel_i0(1.0) - 1.266_065_877_752_008_4).abs() < 1e-15);
        for x in [0.0, 19.0, 29.9, 30.1, 39.5, 42.5_f64] {
            let quarter = 0.25 * x * x;
            let (mut term, mut sum) = (1.0, 1.0);
            for k in 1..200_u32 {
                term *= quarter / f64::from(k * k);
                sum += term;
            }
            assert!((bessel_i0(x) / sum - 1.0).abs() < 2e-14, "{x}");
        }
    }
}
