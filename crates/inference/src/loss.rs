//! Losses: squared, or growing slower beyond a threshold.

use crate::error::{InferenceError, check_positive};

/// The loss `rho(r^2)` of a standardised residual `r`; the cost of a fit is half its sum.
///
/// | loss | `rho(s)` | weight `rho'(s)` |
/// |---|---|---|
/// | squared | `s` | 1 |
/// | Huber | `s`, beyond `t^2`: `2 t sqrt(s) - t^2` | 1, beyond: `t / sqrt(s)` |
/// | Cauchy | `c^2 ln(1 + s / c^2)` | `1 / (1 + s / c^2)` |
///
/// Source: P. J. Huber, *Robust Statistics*, 1981; the weights are those of iteratively
/// reweighted least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// Least squares.
    Squared,
    /// Squared up to a threshold, linear beyond; 1.345 keeps 95 % efficiency on normal noise.
    Huber {
        /// Threshold `t`, in standard deviations.
        threshold: f64,
    },
    /// Logarithmic far out; 2.385 keeps 95 % efficiency on normal noise.
    Cauchy {
        /// Scale `c`, in standard deviations.
        scale: f64,
    },
}

impl Loss {
    /// `rho(r^2)` of a standardised residual.
    pub fn value(self, residual: f64) -> f64 {
        let square = residual * residual;
        match self {
            Self::Squared => square,
            Self::Huber { threshold } if residual.abs() <= threshold => square,
            Self::Huber { threshold } => threshold * (2.0 * residual.abs() - threshold),
            Self::Cauchy { scale } => scale * scale * (square / (scale * scale)).ln_1p(),
        }
    }

    /// The weight `rho'(r^2)` of a standardised residual, in (0, 1].
    pub fn weight(self, residual: f64) -> f64 {
        match self {
            Self::Squared => 1.0,
            Self::Huber { threshold } if residual.abs() <= threshold => 1.0,
            Self::Huber { threshold } => threshold / residual.abs(),
            Self::Cauchy { scale } => 1.0 / (1.0 + (residual / scale).powi(2)),
        }
    }

    /// Checks that threshold or scale is positive and finite.
    pub(crate) fn check(self) -> Result<(), InferenceError> {
        match self {
            Self::Squared => Ok(()),
            Self::Huber { threshold } => {
                check_positive("the threshold of the Huber loss", threshold)
            }
            Self::Cauchy { scale } => check_positive("the scale of the Cauchy loss", scale),
        }
    }
}
