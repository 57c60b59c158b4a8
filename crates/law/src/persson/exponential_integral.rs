//! The exponential integral.

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// Argument up to which the series is used.
const SERIES_UP_TO: f64 = 1.0;

/// Terms at most of the series and of the continued fraction.
const TERMS: u32 = 200;

/// `exp(x) E1(x)`, `E1(x) = integral from x of exp(-s)/s ds`, for x > 0; relative precision about 1e-15.
///
/// Source: Abramowitz and Stegun, Handbook of Mathematical Functions, Eqs. 5.1.11 and 5.1.22.
pub(super) fn scaled_exponential_integral(x: f64) -> f64 {
    if x <= SERIES_UP_TO {
        let mut sum = -EULER - x.ln();
        let mut power = -1.0;
        for k in 1..TERMS {
            power *= -x / f64::from(k);
            let term = power / f64::from(k);
            sum += term;
            if term.abs() < 1e-17 * sum.abs() {
                break;
            }
        }
        return sum * x.exp();
    }
    // Lentz's evaluation of 1/(x + 1 - 1/(x + 3 - 4/(x + 5 - ...))).
    let mut denominator = x + 1.0;
    let mut numerator = f64::INFINITY;
    let mut inverse = 1.0 / denominator;
    let mut value = inverse;
    for k in 1..TERMS {
        let factor = -f64::from(k * k);
        denominator += 2.0;
        inverse = 1.0 / (factor * inverse + denominator);
        numerator = denominator + factor / numerator;
        let ratio = numerator * inverse;
        value *= ratio;
        if (ratio - 1.0).abs() < 2e-16 {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values with 17 digits by another implementation.
    #[allow(
        clippy::unreadable_literal,
        clippy::excessive_precision,
        reason = "numbers from another program"
    )]
    #[test]
    fn exponential_integrals_have_their_known_values() {
        let expected = [
            (1e-20, 4.5474486194979381e+1),
            (0.001, 6.337874070325488),
            (0.5, 9.2291063248373047e-1),
            (1.0, 5.9634736232319407e-1),
            (1.0000001, 5.9634732195793326e-1),
            (1.5, 4.4825666929158295e-1),
            (3.0, 2.620837402553185e-1),
            (20.0, 4.7718545495960842e-2),
            (500.0, 1.9960159047604109e-3),
        ];
        for (x, expected) in expected {
            let found = scaled_exponential_integral(x);
            assert!((found / expected - 1.0).abs() < 4e-15, "{x}: {found:e}");
        }
    }
}
