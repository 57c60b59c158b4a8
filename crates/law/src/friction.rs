//! Rate-independent friction.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::{LawError, LawQuantity, above, at_least};

/// A Jenkins element: a spring of stiffness k in series with a slider that holds up to the slip
/// force R.
///
/// ```text
/// f = k (x - z),   |f| <= R,   the slider z moves only while |f| = R
/// ```
///
/// with x the displacement across the element. Over a step from `x0`, where the force is `f0`, to x
/// without a reversal in between the force is exactly
///
/// ```text
/// f = max(-R, min(R, f0 + k (x - x0))),
/// ```
///
/// whatever the step. Under a vibration of amplitude X > R / k the force follows the loops of Masing:
/// the first loading scaled by two from each reversal.
///
/// | closed form, for X >= R / k | |
/// |---|---|
/// | loss per cycle | `4 R (X - R / k)` |
/// | secant stiffness | `R / X` |
/// | storage coefficient | `(k / pi) (t - sin t cos t)`, `cos t = 1 - 2 R / (k X)` |
/// | loss coefficient | `4 R (X - R / k) / (pi X^2)` |
///
/// The coefficients are those of the first harmonic of the force in phase with x and with its
/// velocity. For smaller amplitudes the element is its spring.
///
/// The slip force is a number, or a coefficient mu times the force of a contact. Sources:
/// G. Masing, Proc. 2nd Int. Congr. Appl. Mech., Zurich 1926, 332; W. D. Iwan,
/// J. Appl. Mech. 1966, 33, 893, doi 10.1115/1.3625199.
///
/// ```
/// use asperity_law::Friction;
///
/// let friction = Friction::slip_force(1e7, 0.2)?;
/// let limit = friction.limit(158.0); // the slip force, whatever the contact carries
/// assert_eq!(friction.force(0.0, 1e-8, limit), 0.1); // stuck
/// assert_eq!(friction.force(0.1, 5e-8, limit), 0.2); // slips
/// assert_eq!(friction.force(0.2, -1e-8, limit), 0.1); // stuck again
/// # Ok::<(), asperity_law::LawError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    stiffness: f64,
    slip: Slip,
}

/// Slip force of a friction element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slip {
    /// Slip force in N.
    ForceN(f64),
    /// Slip force over the force of the contact: this contact, or the one below the body.
    Coefficient(f64),
}

impl Friction {
    /// An element of `stiffness` k \[N/m\] that slips at the force `slip` R \[N\].
    ///
    /// # Errors
    /// [`LawError`] for a stiffness that is not positive, or a slip force that is negative.
    pub fn slip_force(stiffness: f64, slip: f64) -> Result<Self, LawError> {
        FrictionSpec { stiffness_n_per_m: stiffness, slip: Slip::ForceN(slip) }.build()
    }

    /// An element of `stiffness` k \[N/m\] that slips at `coefficient` mu times the force of a
    /// contact.
    ///
    /// # Errors
    /// [`LawError`] for a stiffness that is not positive, or a coefficient that is negative.
    pub fn coefficient(stiffness: f64, coefficient: f64) -> Result<Self, LawError> {
        let slip = Slip::Coefficient(coefficient);
        FrictionSpec { stiffness_n_per_m: stiffness, slip }.build()
    }

    /// Stiffness k of the stuck element \[N/m\].
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Slip force R \[N\] where the contact carries `contact_force` \[N\]; none below zero.
    pub fn limit(&self, contact_force: f64) -> f64 {
        match self.slip {
            Slip::ForceN(force) => force,
            Slip::Coefficient(coefficient) => coefficient * contact_force.max(0.0),
        }
    }

    /// Share of the slip force in that of the contact: mu, or zero for a slip force of its own.
    pub fn share_of_contact(&self) -> f64 {
        match self.slip {
            Slip::ForceN(_) => 0.0,
            Slip::Coefficient(coefficient) => coefficient,
        }
    }

    /// The force \[N\] after an `increment` of displacement \[m\] from a state of force `before`
    /// \[N\], under the slip force `limit` \[N\].
    pub fn force(&self, before: f64, increment: f64, limit: f64) -> f64 {
        (before + self.stiffness * increment).min(limit).max(-limit)
    }

    /// Loss \[J\] of a whole cycle of `amplitude` \[m\] under the slip force `limit` \[N\].
    pub fn loss_per_cycle(&self, amplitude: f64, limit: f64) -> f64 {
        4.0 * limit * (amplitude - limit / self.stiffness).max(0.0)
    }

    /// Force at the reversals over the `amplitude` \[m\] of a cycle, under the slip force `limit`
    /// \[N\] \[N/m\].
    pub fn secant_stiffness(&self, amplitude: f64, limit: f64) -> f64 {
        self.stiffness.min(limit / amplitude)
    }

    /// Coefficients \[N/m\] of the first harmonic of the force over the `amplitude` \[m\] of a cycle,
    /// in phase with the displacement and with the velocity, under the slip force `limit` \[N\].
    pub fn harmonic_coefficients(&self, amplitude: f64, limit: f64) -> [f64; 2] {
        let cosine = 1.0 - 2.0 * limit / (self.stiffness * amplitude);
        if cosine <= -1.0 {
            return [self.stiffness, 0.0];
        }
        let angle = cosine.acos();
        let storage = self.stiffness * (angle - angle.sin() * cosine) / std::f64::consts::PI;
        let loss = self.loss_per_cycle(amplitude, limit);
        [storage, loss / (std::f64::consts::PI * amplitude * amplitude)]
    }
}

/// Friction across the closure of a contact, or between a body and its guide: a spring in series with
/// a slider that holds up to the slip force.
///
/// In JSON the slip force is given by exactly one of `slip_force_n` and `coefficient`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "FrictionKeys", into = "FrictionKeys")]
pub struct FrictionSpec {
    /// Stiffness of the stuck element in N/m.
    pub stiffness_n_per_m: f64,
    /// Slip force.
    pub slip: Slip,
}

impl FrictionSpec {
    /// Builds the element.
    ///
    /// ```
    /// use asperity_law::{FrictionSpec, Slip};
    ///
    /// let friction = FrictionSpec { stiffness_n_per_m: 1e7, slip: Slip::ForceN(0.2) };
    /// assert_eq!(serde_json::to_value(friction)?["slip_force_n"], 0.2);
    /// assert_eq!(friction.build()?.limit(158.0), 0.2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`LawError`] for a stiffness that is not positive, or a slip force or coefficient that is
    /// negative.
    pub fn build(self) -> Result<Friction, LawError> {
        let (slip, quantity) = match self.slip {
            Slip::ForceN(force) => (force, LawQuantity::SlipForce),
            Slip::Coefficient(coefficient) => (coefficient, LawQuantity::FrictionCoefficient),
        };
        at_least(quantity, slip, 0.0)?;
        let stiffness = above(LawQuantity::SpringStiffness, self.stiffness_n_per_m, 0.0)?;
        Ok(Friction { stiffness, slip: self.slip })
    }
}

/// Rate-independent friction: a spring in series with a slider, with exactly one of `slip_force_n`
/// and `coefficient`.
#[derive(Clone, Copy, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "FrictionSpec",
    extend("oneOf" = [{"required": ["slip_force_n"]}, {"required": ["coefficient"]}])
)]
struct FrictionKeys {
    /// Stiffness of the stuck element in N/m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    stiffness_n_per_m: f64,
    /// Slip force in N; give this or `coefficient`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    slip_force_n: Option<f64>,
    /// Slip force over the force of the contact, of a body the one below it; give this or
    /// `slip_force_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    coefficient: Option<f64>,
}

impl TryFrom<FrictionKeys> for FrictionSpec {
    type Error = &'static str;

    fn try_from(keys: FrictionKeys) -> Result<Self, Self::Error> {
        let slip = match (keys.slip_force_n, keys.coefficient) {
            (Some(force), None) => Slip::ForceN(force),
            (None, Some(coefficient)) => Slip::Coefficient(coefficient),
            _ => return Err("friction needs exactly one of slip_force_n and coefficient"),
        };
        Ok(Self { stiffness_n_per_m: keys.stiffness_n_per_m, slip })
    }
}

impl From<FrictionSpec> for FrictionKeys {
    fn from(friction: FrictionSpec) -> Self {
        let (slip_force_n, coefficient) = match friction.slip {
            Slip::ForceN(force) => (Some(force), None),
            Slip::Coefficient(coefficient) => (None, Some(coefficient)),
        };
        Self { stiffness_n_per_m: friction.stiffness_n_per_m, slip_force_n, coefficient }
    }
}
