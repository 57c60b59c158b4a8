//! The derivative of a smooth closed form from four values around a point.

/// Share of a parameter by which it is varied.
///
/// The truncation of [`central_difference`] is then `h^4 / 30` times the fifth derivative, about
/// 1e-12 of the first for powers and 1e-11 for exponents of pressures in pascals; rounding leaves
/// about 1e-12 of the value.
pub const RELATIVE_STEP: f64 = 1e-3;

/// Places of the four values, in steps from the point.
pub const STENCIL: [f64; 4] = [-2.0, -1.0, 1.0, 2.0];

/// Derivative of a function from its `values` at two steps and one `step` below a point, and one
/// and two above, to fourth order:
///
/// ```text
/// f' = (8 (f(h) - f(-h)) - (f(2h) - f(-2h))) / (12 h) + h^4 f''''' / 30
/// ```
///
/// Exactly zero for four equal values.
pub fn central_difference(values: [f64; 4], step: f64) -> f64 {
    let [far_below, below, above, far_above] = values;
    (8.0 * (above - below) - (far_above - far_below)) / (12.0 * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the closed form; a polynomial of fourth degree has no error but rounding.
    #[test]
    fn powers_are_differentiated_to_their_truncation() {
        let at = |f: &dyn Fn(f64) -> f64, x: f64| {
            let h = RELATIVE_STEP * x;
            central_difference(STENCIL.map(|place| f(x + place * h)), h)
        };
        assert!((at(&|x| x.powi(4), 3.0) / 108.0 - 1.0).abs() < 1e-11);
        // h^4 / 30 times 1.4e5^m ln^4, and rounding.
        let exact = 1.4e5_f64.powf(0.35) * 1.4e5_f64.ln();
        assert!((at(&|m| 1.4e5_f64.powf(m), 0.35) / exact - 1.0).abs() < 1e-10);
        assert_eq!(central_difference([0.1; 4], 1e-3), 0.0);
    }
}
