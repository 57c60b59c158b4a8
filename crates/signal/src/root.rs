//! Roots of functions of one variable.

/// Most steps; bisection alone needs 52.
const LIMIT: usize = 100;

/// A root of `function` between two points where its values have opposite signs.
///
/// Chandrupatla's method: inverse quadratic interpolation or bisection. It stops when the width of
/// the bracket over its position is below `tolerance` and returns the end with the smaller value;
/// NaN or an end if the function is NaN inside.
///
/// Source: T. R. Chandrupatla, Adv. Eng. Software 28 (1997), 145-149,
/// doi 10.1016/S0965-9978(96)00051-8.
pub(crate) fn bracketed_root(
    mut function: impl FnMut(f64) -> f64,
    (mut a, mut at_a): (f64, f64),
    (mut b, mut at_b): (f64, f64),
    tolerance: f64,
) -> f64 {
    let mut fraction = 0.5;
    for _ in 0..LIMIT {
        let x = a + fraction * (b - a);
        let at_x = function(x);
        // The new point replaces an end; the point left behind is c.
        let (c, at_c);
        if (at_x < 0.0) == (at_a < 0.0) {
            (c, at_c) = (a, at_a);
        } else {
            (c, at_c) = (b, at_b);
            (b, at_b) = (a, at_a);
        }
        (a, at_a) = (x, at_x);

        let best = if at_a.abs() < at_b.abs() { a } else { b };
        let least = tolerance * best.abs() / (b - a).abs();
        if at_a == 0.0 || least >= 0.5 || a == b {
            return best;
        }
        let xi = (a - b) / (c - b);
        let phi = (at_a - at_b) / (at_c - at_b);
        let gentle = phi * phi < xi && (1.0 - phi).powi(2) < 1.0 - xi;
        fraction = if gentle {
            let first = at_a / (at_b - at_a) * at_c / (at_b - at_c);
            let second = (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b);
            first + second
        } else {
            0.5
        };
        fraction = fraction.max(least).min(1.0 - least);
    }
    if at_a.abs() < at_b.abs() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verified against roots known in closed form, one of them flat on one side.
    #[test]
    fn finds_known_roots_in_few_steps() {
        let mut calls = 0;
        let cubic = |x: f64| {
            calls += 1;
            x * x * x - 2.0
        };
        let root = bracketed_root(cubic, (0.0, -2.0), (2.0, 6.0), 1e-14);
        assert!((root - 2.0_f64.cbrt()).abs() < 4e-15);
        assert!(calls <= 14, "{calls} calls");

        let steep = |x: f64| (30.0 * (x - 0.9)).exp() - 1.0;
        let root = bracketed_root(steep, (0.0, steep(0.0)), (2.0, steep(2.0)), 1e-13);
        assert!((root - 0.9).abs() < 1e-12);
    }
}
