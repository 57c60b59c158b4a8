//! Internal damping of a body.

use crate::error::{MeshError, not_negative};

/// Internal damping of a body: its material loses energy as it is strained; rigid motions are free.
///
/// | kind | stress | damping ratio of a free mode at the angular frequency w |
/// |---|---|---|
/// | [`kelvin_voigt`](Self::kelvin_voigt) | `E (e + b de/dt)` | `b w / 2` |
/// | [`loss_factor`](Self::loss_factor) | `E (1 + i eta) e` of harmonic strains | `eta / 2` |
///
/// Kelvin-Voigt damping is the stiffness-proportional part of Rayleigh damping, `C = a M + b K`; the
/// mass-proportional part acts on all bodies of a structure. A loss factor belongs to steady
/// vibration: as a law in time it would act before its cause.
///
/// ```
/// use asperity_mesh::{Body, BodyDamping};
///
/// let bar = Body::new("bar", 0.2, 1e-3, 71e9, 2710.0)?;
/// let bar = bar.with_damping(BodyDamping::kelvin_voigt(2e-6)?);
/// assert_eq!(bar.damping().retardation_time(), Some(2e-6));
/// assert!(BodyDamping::loss_factor(-0.1).is_err());
/// # Ok::<(), asperity_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyDamping(Kind);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    KelvinVoigt { time: f64 },
    LossFactor { factor: f64 },
}

impl BodyDamping {
    /// No internal damping.
    pub const NONE: Self = Self(Kind::KelvinVoigt { time: 0.0 });

    /// Stress `E (e + b de/dt)` with the retardation time b \[s\].
    ///
    /// # Errors
    /// [`MeshError::Negative`] for a time that is negative or not finite.
    pub fn kelvin_voigt(time: f64) -> Result<Self, MeshError> {
        let time = not_negative("body damping", "retardation time [s]", time)?;
        Ok(Self(Kind::KelvinVoigt { time }))
    }

    /// Modulus `E (1 + i eta)` of harmonic vibration at any frequency, with the loss factor eta.
    ///
    /// # Errors
    /// [`MeshError::Negative`] for a factor that is negative or not finite.
    pub fn loss_factor(factor: f64) -> Result<Self, MeshError> {
        let factor = not_negative("body damping", "loss factor", factor)?;
        Ok(Self(Kind::LossFactor { factor }))
    }

    /// The retardation time b \[s\], zero without damping; none for a loss factor, which has no motion
    /// in time.
    pub fn retardation_time(&self) -> Option<f64> {
        match self.0 {
            Kind::KelvinVoigt { time } => Some(time),
            Kind::LossFactor { .. } => None,
        }
    }

    /// Imaginary part over real part of the modulus at the angular frequency `w` \[rad/s\], `b w` or
    /// `eta`.
    pub fn loss(&self, w: f64) -> f64 {
        match self.0 {
            Kind::KelvinVoigt { time } => time * w,
            Kind::LossFactor { factor } => factor,
        }
    }

    /// Derivative of [`loss`](Self::loss) with respect to the angular frequency \[s\].
    pub fn loss_slope(&self) -> f64 {
        self.retardation_time().unwrap_or(0.0)
    }
}

impl Default for BodyDamping {
    fn default() -> Self {
        Self::NONE
    }
}
