//! Mass-proportional viscosity.

use asperity_mesh::Stack;

use crate::{DynamicsError, Equilibrium, modes::lowest_frequency};

/// The viscosity `h` of Eq. (1), given directly or by the ratio it has at the lowest mode.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damping {
    /// Damping ratio xi of the lowest mode of the rig linearised at static
    /// equilibrium: `h = 2 xi w0`. The paper writes `xi = h / (2 m w0)`, whose
    /// dimension does not fit Eq. (1).
    Ratio(f64),
    /// The rate h itself \[1/s\].
    Rate(f64),
}

impl Damping {
    /// The rate h \[1/s\] for a stack at its equilibrium.
    ///
    /// # Errors
    /// [`DynamicsError::Setting`] for a value that is negative or not finite;
    /// [`DynamicsError::NoFrequency`] for a positive ratio when the linearised rig
    /// has a free motion.
    pub fn rate(self, stack: &Stack, equilibrium: &Equilibrium) -> Result<f64, DynamicsError> {
        let (quantity, value) = match self {
            Self::Ratio(ratio) => ("damping ratio", ratio),
            Self::Rate(rate) => ("damping rate [1/s]", rate),
        };
        if !(value.is_finite() && value >= 0.0) {
            let accepted = "finite and not negative";
            return Err(DynamicsError::Setting { quantity, value, accepted });
        }
        match self {
            Self::Rate(_) => Ok(value),
            Self::Ratio(_) if value == 0.0 => Ok(0.0),
            Self::Ratio(_) => {
                let natural = lowest_frequency(stack, equilibrium)?;
                Ok(2.0 * value * std::f64::consts::TAU * natural)
            }
        }
    }
}
