//! Rises of ln K from one pressure to the next as functions of unbounded numbers, one a rise.
//!
//! With the logarithmic step `h` of the pressures, the number `g` of a rise is its slope,
//!
//! ```text
//! ln K[i+1] - ln K[i] = h s(g[i]),
//! s(g) = w ln(1 + exp(g / w)),  w = 0.2,      positive, s = g for large slopes, or
//! s(g) = 1 / (1 + exp(-4 (g - 1/2))),         between 0 and 1, with s' = 1 in the middle.
//! ```
//!
//! Where K is concave in p, the secants `S[i] = (K[i+1] - K[i]) / (p[i+1] - p[i])` fall. There the number
//! of each rise after the first is minus the exponent of their fall,
//!
//! ```text
//! ln S[i] - ln S[i-1] = -h c(g[i]),    c(g) = w ln(1 + exp(-g / w)) > 0,
//! q[i] = q[i-1] exp(h (1 - c(g[i]))) / (1 + q[i-1]),    q[i] = K[i+1] / K[i] - 1.
//! ```
//!
//! A larger number is a steeper law everywhere. Exponents below one stay below one where K is concave.

/// Width `w` of the transition to a slope of zero.
const WIDTH: f64 = 0.2;

/// Least and greatest slope (the latter with an exponent between 0 and 1), and least fall of a secant, of
/// the scenario's law about which others are sought: the centre of the prior is finite.
const CENTRE: [f64; 2] = [0.01, 0.99];

/// The rises of a law between pressures that are evenly spaced in their logarithm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rises {
    /// Logarithmic step of the pressures.
    pub(super) step: f64,
    /// True if all slopes are below one.
    pub(super) below_one: bool,
    /// Index of the first rise whose secant is below the previous secant.
    pub(super) first_falling: usize,
}

impl Rises {
    /// The rises for these numbers.
    pub(super) fn of(&self, numbers: &[f64]) -> Vec<f64> {
        let mut rises: Vec<f64> = Vec::with_capacity(numbers.len());
        for (i, &g) in numbers.iter().enumerate() {
            let rise = if i < self.first_falling {
                self.step * slope(g, self.below_one)
            } else {
                let before = rises[i - 1];
                // q / (1 + q) = 1 - exp(-rise).
                (-(-before).exp_m1() * (self.step * (1.0 - soft(-g))).exp()).ln_1p()
            };
            rises.push(rise);
        }
        rises
    }

    /// The change of the rises along a change of the numbers.
    pub(super) fn change(&self, numbers: &[f64], changes: &[f64]) -> Vec<f64> {
        let rises = self.of(numbers);
        let mut found: Vec<f64> = Vec::with_capacity(numbers.len());
        for (i, (&g, &dg)) in numbers.iter().zip(changes).enumerate() {
            found.push(if i < self.first_falling {
                self.step * slope_derivative(g, self.below_one) * dg
            } else {
                let ratio =
                    found[i - 1] / rises[i - 1].exp_m1() + self.step * soft_derivative(-g) * dg;
                share(rises[i]) * ratio
            });
        }
        found
    }

    /// The change of the numbers that changes the rises, to first order.
    pub(super) fn inverse_change(&self, numbers: &[f64], changes: &[f64]) -> Vec<f64> {
        let rises = self.of(numbers);
        let of = |(i, &g): (usize, &f64)| {
            if i < self.first_falling {
                changes[i] / (self.step * slope_derivative(g, self.below_one))
            } else {
                let ratio = changes[i] / share(rises[i]) - changes[i - 1] / rises[i - 1].exp_m1();
                ratio / (self.step * soft_derivative(-g))
            }
        };
        numbers.iter().enumerate().map(of).collect()
    }

    /// The numbers of given rises, moved inside the range of centres.
    pub(super) fn centre(&self, rises: &[f64]) -> Vec<f64> {
        let least = |rise: f64| rise.max(CENTRE[0] * self.step);
        let of = |(i, &rise): (usize, &f64)| {
            if i < self.first_falling {
                return inverse_slope(rise / self.step, self.below_one);
            }
            // ln q[i] - ln (q[i-1] / (1 + q[i-1])) = h (1 - c).
            let (rise, before) = (least(rise), least(rises[i - 1]));
            let growth = rise.exp_m1().ln() - share(before).ln();
            -inverse_soft((1.0 - growth / self.step).max(CENTRE[0]))
        };
        rises.iter().enumerate().map(of).collect()
    }
}

/// `q / (1 + q)` of a rise `ln (1 + q)`: its derivative with respect to `ln q`.
fn share(rise: f64) -> f64 {
    -(-rise).exp_m1()
}

/// `w ln(1 + exp(g / w))`.
fn soft(g: f64) -> f64 {
    let scaled = g / WIDTH;
    WIDTH * (scaled.max(0.0) + (-scaled.abs()).exp().ln_1p())
}

fn soft_derivative(g: f64) -> f64 {
    1.0 / (1.0 + (-g / WIDTH).exp())
}

fn inverse_soft(value: f64) -> f64 {
    let scaled = value / WIDTH;
    WIDTH * (scaled + (-(-scaled).exp()).ln_1p())
}

/// The slope `s(g)`.
fn slope(g: f64, below_one: bool) -> f64 {
    if below_one { 1.0 / (1.0 + (-4.0 * (g - 0.5)).exp()) } else { soft(g) }
}

/// The derivative `s'(g)`.
fn slope_derivative(g: f64, below_one: bool) -> f64 {
    if below_one {
        let s = slope(g, true);
        4.0 * s * (1.0 - s)
    } else {
        soft_derivative(g)
    }
}

/// The `g` of a slope, moved inside the range of centres.
fn inverse_slope(slope: f64, below_one: bool) -> f64 {
    let slope = slope.max(CENTRE[0]);
    if below_one {
        let slope = slope.min(CENTRE[1]);
        0.5 + 0.25 * (slope / (1.0 - slope)).ln()
    } else {
        inverse_soft(slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_have_their_inverse_and_their_limits() {
        for (below_one, slopes) in [(false, [0.02, 0.4, 3.0]), (true, [0.02, 0.4, 0.97])] {
            for s in slopes {
                assert!((slope(inverse_slope(s, below_one), below_one) / s - 1.0).abs() < 1e-12);
            }
        }
        assert!((slope(3.0, false) - 3.0).abs() < 1e-6 && slope(-9.0, false) >= 0.0);
        assert!(slope(9.0, true) <= 1.0);
    }

    /// Rises of a law that is convex below and concave above come back from their numbers; a secant
    /// that does not fall is moved to one that hardly falls.
    #[test]
    fn rises_have_their_numbers() {
        let step = 0.1;
        let stiffness = |i: i32| {
            let p = (step * f64::from(i - 20)).exp();
            p * p / (1.0 + p * p)
        };
        let rises: Vec<f64> = (0..40).map(|i| (stiffness(i + 1) / stiffness(i)).ln()).collect();
        // The inflexion of x^2 / (1 + x^2) is at 3^(-1/2).
        for (first_falling, is_same) in [(40, true), (17, true), (5, false)] {
            let all = Rises { step, below_one: false, first_falling };
            let back = all.of(&all.centre(&rises));
            let off = rises.iter().zip(&back).map(|(a, b)| (a / b - 1.0).abs());
            assert_eq!(off.fold(0.0, f64::max) < 1e-10, is_same, "{first_falling}");
        }
    }
}
