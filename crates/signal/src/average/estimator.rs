//! Estimators of the frequency response function from averaged spectra.

use crate::error::{Result, check_positive};
use num_complex::Complex64;

/// Estimator of the frequency response function, by its assumption on the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrfEstimator {
    /// `H1 = Gfx / Gff`: least squares for noise on the response. Noise on the
    /// force biases it low, by `1 + Gnn/Gff`.
    H1,
    /// `H2 = Gxx / conj(Gfx)`: least squares for noise on the force. Noise on
    /// the response biases it high, by `1 + Gmm/Gxx`.
    H2,
    /// `Hv`: total least squares, for noise on both.
    ///
    /// ```text
    /// Hv = (b - a + sqrt((a - b)^2 + 4 |Gfx|^2 / s^2)) / (2 conj(Gfx) / s^2),
    /// a = Gff,   b = Gxx / s^2
    /// ```
    ///
    /// Its magnitude lies between the magnitudes of `H1` (`s -> infinity`) and `H2` (`s -> 0`); the
    /// three phases are equal.
    ///
    /// Source: G. T. Rocklin, J. Crowley and H. Vold, "A comparison of H1, H2
    /// and Hv frequency response functions", Proc. 3rd IMAC 1985, 272-278.
    Hv(HvScaling),
}

/// Ratio of the two noises in [`FrfEstimator::Hv`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum HvScaling {
    /// Equal noise-to-signal ratios: `s^2 = Gxx / Gff` at each frequency, which
    /// makes `Hv` the geometric mean of `H1` and `H2`.
    EqualRatios,
    /// Standard deviation `s` of the response noise over the deviation of the force
    /// noise, in the response's unit per newton.
    NoiseRatio(f64),
}

impl FrfEstimator {
    pub(super) fn check(self) -> Result<()> {
        match self {
            Self::Hv(HvScaling::NoiseRatio(ratio)) => check_positive("the noise ratio", ratio),
            _ => Ok(()),
        }
    }

    /// The quotient of the sums of `|F|^2`, `|X|^2` and `conj(F) X`.
    pub(super) fn value(self, force: f64, response: f64, cross: Complex64) -> Complex64 {
        match self {
            Self::H1 => cross / force,
            Self::H2 => response / cross.conj(),
            Self::Hv(HvScaling::EqualRatios) => (response / force).sqrt() * cross / cross.norm(),
            Self::Hv(HvScaling::NoiseRatio(s)) => {
                let (a, b, c) = (force, response / (s * s), cross / s);
                let root = (a - b).hypot(2.0 * c.norm());
                // The root of the quadratic in the form without cancellation.
                let h = if a > b {
                    c * 2.0 / (a - b + root)
                } else {
                    (b - a + root) / (c.conj() * 2.0)
                };
                h * s
            }
        }
    }
}
