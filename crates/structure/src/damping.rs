//! Mass-proportional viscosity.

use std::f64::consts::TAU;

use crate::StructureError;

/// The viscosity `h` of Eq. (1), given directly or by the ratio it has at the lowest mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// Damping ratio xi of the lowest mode linearised at static equilibrium: `h = 2 xi w0`. The
    /// paper writes `xi = h / (2 m w0)`, whose dimension does not fit Eq. (1).
    Ratio(f64),
    /// The rate h itself \[1/s\].
    Rate(f64),
}

impl Damping {
    /// The rate h \[1/s\] where the lowest natural frequency is `natural` \[Hz\].
    pub(crate) fn rate(self, natural: Result<f64, StructureError>) -> Result<f64, StructureError> {
        let (quantity, value) = match self {
            Self::Ratio(ratio) => ("damping ratio", ratio),
            Self::Rate(rate) => ("damping rate [1/s]", rate),
        };
        if !(value.is_finite() && value >= 0.0) {
            let accepted = "finite and not negative";
            return Err(StructureError::Setting { quantity, value, accepted });
        }
        let rate = match self {
            Self::Ratio(ratio) if ratio > 0.0 => 2.0 * ratio * TAU * natural?,
            Self::Ratio(_) | Self::Rate(_) => value,
        };
        if rate.is_finite() {
            Ok(rate)
        } else {
            let quantity = "damping rate [1/s]";
            Err(StructureError::Setting { quantity, value: rate, accepted: "finite" })
        }
    }
}
