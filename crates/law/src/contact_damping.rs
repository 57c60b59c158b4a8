//! Viscous damping of a contact.

use std::f64::consts::TAU;

use crate::error::{LawError, LawQuantity, above, at_least, finite};

/// Viscous damping of a contact: a traction beyond the pressure `p` of its law,
///
/// ```text
/// s = p + c(p) dd/dt,    c in Pa s/m,
/// ```
///
/// with d the closure. Faces carry no tension: where a law separates the traction is `max(0, s)`,
/// and a lost contact has none. A law that carries tension has no bound.
///
/// | kind | c(p) |
/// |---|---|
/// | [`kelvin_voigt`](Self::kelvin_voigt) | `beta K(p)`, so that `s = p + beta dp/dt` |
/// | [`loss_ratio`](Self::loss_ratio) | the same with `beta = ratio / (2 pi f)` |
/// | [`power`](Self::power) | `c0 (p / p_ref)^n` |
///
/// A contact that vibrates with the small closure amplitude X at the angular frequency w loses
/// `pi c w X^2` per cycle and area; under Kelvin-Voigt damping that is `beta w` times its largest
/// elastic energy and `2 pi`.
///
/// ```
/// use asperity_law::ContactDamping;
///
/// let damping = ContactDamping::kelvin_voigt(4e-6)?;
/// assert_eq!(damping.coefficient(1.4e5, 1e12), 4e6);
/// assert_eq!(damping.coefficient(0.0, 0.0), 0.0); // contact lost
/// # Ok::<(), asperity_law::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactDamping(Kind);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    KelvinVoigt { time: f64 },
    Power { coefficient: f64, reference: f64, exponent: f64 },
}

/// Least exponent of a coefficient over pressure. One below it would need an infinite impulse to
/// close a contact with a law of K ~ p^m, m < 1.
const LEAST_EXPONENT: f64 = -1.0;

impl ContactDamping {
    /// Damping proportional to the stiffness, `c = beta K(p)`, with the retardation time `beta`
    /// \[s\].
    ///
    /// # Errors
    /// [`LawError`] for a time that is negative or not finite.
    pub fn kelvin_voigt(time: f64) -> Result<Self, LawError> {
        let time = at_least(LawQuantity::RetardationTime, time, 0.0)?;
        Ok(Self(Kind::KelvinVoigt { time }))
    }

    /// Kelvin-Voigt damping that loses `ratio` times the largest elastic energy of the contact and
    /// `2 pi` per cycle of small vibration at `frequency` \[Hz\]: `beta = ratio / (2 pi f)`.
    ///
    /// # Errors
    /// [`LawError`] for a ratio that is negative, or a frequency that is not positive.
    pub fn loss_ratio(ratio: f64, frequency: f64) -> Result<Self, LawError> {
        let ratio = at_least(LawQuantity::LossRatio, ratio, 0.0)?;
        Self::kelvin_voigt(ratio / (TAU * above(LawQuantity::Frequency, frequency, 0.0)?))
    }

    /// Damping with its own power of pressure, `c = c0 (p / p_ref)^n`, for the `coefficient` c0
    /// \[Pa s/m\] at the `reference` pressure \[Pa\]; n >= -1.
    ///
    /// # Errors
    /// [`LawError`] for values out of range or not finite.
    pub fn power(coefficient: f64, reference: f64, exponent: f64) -> Result<Self, LawError> {
        Ok(Self(Kind::Power {
            coefficient: at_least(LawQuantity::DampingCoefficient, coefficient, 0.0)?,
            reference: above(LawQuantity::ReferencePressure, reference, 0.0)?,
            exponent: finite(LawQuantity::Exponent, exponent)
                .and_then(|exponent| at_least(LawQuantity::Exponent, exponent, LEAST_EXPONENT))?,
        }))
    }

    /// True if the coefficient is the stiffness times a time: Kelvin-Voigt damping.
    pub fn is_proportional_to_stiffness(&self) -> bool {
        matches!(self.0, Kind::KelvinVoigt { .. })
    }

    /// The coefficient c \[Pa s/m\] at a `pressure` \[Pa\] where the law has this `stiffness`
    /// \[Pa/m\]; zero where there is no stiffness, and for a power of a pressure that is not
    /// positive.
    pub fn coefficient(&self, pressure: f64, stiffness: f64) -> f64 {
        match self.0 {
            Kind::KelvinVoigt { time } => time * stiffness,
            Kind::Power { coefficient, reference, exponent }
                if pressure > 0.0 && stiffness > 0.0 =>
            {
                coefficient * (pressure / reference).powf(exponent)
            }
            Kind::Power { .. } => 0.0,
        }
    }

    /// Derivative dc/dp \[s/m\] of the coefficient, where the law has this `stiffness` \[Pa/m\] and
    /// `slope` dK/dp \[1/m\].
    pub fn coefficient_slope(&self, pressure: f64, stiffness: f64, slope: f64) -> f64 {
        match self.0 {
            Kind::KelvinVoigt { time } => time * slope,
            Kind::Power { exponent, .. } => {
                let coefficient = self.coefficient(pressure, stiffness);
                if coefficient > 0.0 { exponent * coefficient / pressure } else { 0.0 }
            }
        }
    }
}
