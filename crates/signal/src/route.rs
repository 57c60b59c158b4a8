//! What was measured of a motion.

use crate::form::FrfForm;

/// What the response samples are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Route {
    /// Displacement from equilibrium, in metres.
    Displacement,
    /// Velocity, in m/s, divided by `i 2 pi f` in the spectrum.
    Velocity,
    /// Acceleration, in m/s^2, divided by `-(2 pi f)^2` in the spectrum.
    Acceleration,
}

impl Route {
    /// Time derivatives of the displacement in the samples: 0, 1 or 2.
    pub const fn derivatives(self) -> i32 {
        self.form().derivatives()
    }

    /// What the samples' transform over the force's is: receptance, mobility or accelerance.
    pub const fn form(self) -> FrfForm {
        match self {
            Self::Displacement => FrfForm::Receptance,
            Self::Velocity => FrfForm::Mobility,
            Self::Acceleration => FrfForm::Accelerance,
        }
    }

    /// The samples' name in running text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }
}
