//! Extremes of sampled values and their derivatives.

/// An extreme of samples: its value, and its weights on the samples that it is made of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extreme {
    pub(super) value: f64,
    /// The middle one of the three samples.
    at: usize,
    weights: [f64; 3],
}

impl Extreme {
    /// The lowest value of `sign` times the `samples`: a sample, or the vertex of the parabola
    /// through three samples around one; none without samples. `value` keeps its own sign.
    pub(super) fn lowest(samples: &[f64], sign: f64) -> Option<Self> {
        let mut found = Self { value: *samples.first()?, at: 0, weights: [0.0, 1.0, 0.0] };
        for (at, &value) in samples.iter().enumerate() {
            if sign * value < sign * found.value {
                found = Self { value, at, weights: [0.0, 1.0, 0.0] };
            }
        }
        for (before, window) in samples.windows(3).enumerate() {
            let &[a, b, c] = window else { continue };
            let bend = a - 2.0 * b + c;
            if bend == 0.0 || (b - a) * (b - c) < 0.0 {
                continue;
            }
            let s = (c - a) / bend;
            let value = b - 0.125 * s * (c - a);
            if sign * value < sign * found.value {
                let square = 0.125 * s * s;
                let weights = [square + 0.25 * s, 1.0 - 2.0 * square, square - 0.25 * s];
                found = Self { value, at: before + 1, weights };
            }
        }
        Some(found)
    }

    /// The derivative of the extreme from the derivatives of the samples.
    pub(super) fn derivative(&self, derivatives: &[f64]) -> f64 {
        let [a, b, c] = self.weights;
        let of =
            |place: Option<usize>| place.and_then(|at| derivatives.get(at)).copied().unwrap_or(0.0);
        a * of(self.at.checked_sub(1)) + b * of(Some(self.at)) + c * of(Some(self.at + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against a central difference of the extreme itself, of truncation 1e-10.
    #[test]
    fn extremes_follow_their_samples() {
        let samples = |theta: f64| -> Vec<f64> {
            (0..60).map(|n| (0.31 * f64::from(n) + theta).sin() * (1.0 + theta)).collect()
        };
        let derivatives: Vec<f64> =
            (0..60).map(|n| (0.31 * f64::from(n)).cos() + (0.31 * f64::from(n)).sin()).collect();
        for sign in [1.0, -1.0] {
            let at = |theta: f64| Extreme::lowest(&samples(theta), sign).unwrap();
            let expected = (at(1e-5).value - at(-1e-5).value) / 2e-5;
            let found = at(0.0).derivative(&derivatives);
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            assert!((at(0.0).value + sign).abs() < 1e-3);
        }
        assert_eq!(Extreme::lowest(&[], 1.0), None);
    }
}
