//! Viscous damping of a contact.

use std::f64::consts::TAU;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contact_law::ContactLaw;
use crate::contact_law::quadrature::adaptive;
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

    /// The viscous impulse `integral of c dd` \[Pa s\] as the pressure on `law` goes `from` one value to
    /// another \[Pa\], `integral of c / K dp`: beta times the change of pressure under Kelvin-Voigt
    /// damping. Powers have no damping below zero pressure.
    ///
    /// The integral is over the fourth root of the pressure, by adaptive Gauss-Legendre quadrature to
    /// rounding.
    pub fn impulse(&self, law: &dyn ContactLaw, from: f64, to: f64) -> f64 {
        let Kind::Power { .. } = self.0 else {
            return self.coefficient(0.0, to - from);
        };
        let (from, to) = (from.max(0.0), to.max(0.0));
        let scale = from.max(to);
        if from == to {
            return 0.0;
        }
        let [start, end] = [from, to].map(|pressure| (pressure / scale).sqrt().sqrt());
        let integrand = |root: f64| {
            let cube = root * root * root;
            let pressure = scale * cube * root;
            let stiffness = law.stiffness(pressure);
            let coefficient = self.coefficient(pressure, stiffness);
            if coefficient > 0.0 { 4.0 * scale * cube * coefficient / stiffness } else { 0.0 }
        };
        adaptive(&integrand, start, end - start)
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

/// Viscous damping of a contact: its traction is p + c(p) dd/dt, with the pressure p of the law and
/// the closure d; never below zero where the law separates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ContactDampingSpec {
    /// Damping proportional to the stiffness, c = beta K(p): the traction is p + beta dp/dt.
    KelvinVoigt {
        /// Retardation time beta in s.
        #[schemars(range(min = 0.0))]
        time_s: f64,
    },
    /// Kelvin-Voigt damping with beta = ratio / (2 pi frequency).
    LossRatio {
        /// Loss per cycle of small vibration at the frequency, over 2 pi times the largest elastic
        /// energy of the contact.
        #[schemars(range(min = 0.0))]
        ratio: f64,
        /// Frequency in Hz.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        frequency_hz: f64,
    },
    /// Damping with its own power of pressure, c = coefficient (p / reference)^exponent.
    Power {
        /// Coefficient c at the reference pressure in Pa s/m.
        #[schemars(range(min = 0.0))]
        coefficient_pa_s_per_m: f64,
        /// Reference pressure in Pa.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        reference_pa: f64,
        /// Exponent of the pressure.
        #[schemars(range(min = -1.0))]
        exponent: f64,
    },
}

impl ContactDampingSpec {
    /// Builds the damping.
    ///
    /// # Errors
    /// [`LawError`] for values out of range or not finite.
    pub fn build(self) -> Result<ContactDamping, LawError> {
        match self {
            Self::KelvinVoigt { time_s } => ContactDamping::kelvin_voigt(time_s),
            Self::LossRatio { ratio, frequency_hz } => {
                ContactDamping::loss_ratio(ratio, frequency_hz)
            }
            Self::Power { coefficient_pa_s_per_m, reference_pa, exponent } => {
                ContactDamping::power(coefficient_pa_s_per_m, reference_pa, exponent)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Power;

    /// `c0 (p^(n - m + 1) - p0^(n - m + 1)) / (C p_ref^n (n - m + 1))` on a power law, and beta times
    /// the change of pressure on any.
    #[test]
    fn the_viscous_impulse_has_its_closed_form() {
        let (c, m, reference, from) = (1.81e10, 0.35, 1.2e5_f64, 1.4e5_f64);
        let law = Power::new(c, m, 0.0).unwrap();
        for n in [0.0, 0.5, 1.5] {
            let damping = ContactDamping::power(4e6, reference, n).unwrap();
            for to in [1e3_f64, 0.9e5, 1.4e5, 1.5e5, 1.1e6] {
                let power = n - m + 1.0;
                let scale = 4e6 / (c * reference.powf(n) * power);
                let exact = scale * (to.powf(power) - from.powf(power));
                let found = damping.impulse(&law, from, to);
                let bound = 1e-12 * scale * from.max(to).powf(power);
                assert!((found - exact).abs() < bound, "{n} {to}: {found} {exact}");
            }
        }
        let beta = ContactDamping::kelvin_voigt(3e-6).unwrap();
        assert_eq!(beta.impulse(&law, 1e5, 3e5), 3e-6 * 2e5);
        // The derivative is c / K.
        let damping = ContactDamping::power(4e6, reference, 1.5).unwrap();
        let slope =
            (damping.impulse(&law, from, 1.001e6) - damping.impulse(&law, from, 0.999e6)) / 2e3;
        let exact = damping.coefficient(1e6, law.stiffness(1e6)) / law.stiffness(1e6);
        assert!((slope / exact - 1.0).abs() < 1e-6);
    }
}
