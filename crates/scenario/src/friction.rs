//! Rate-independent friction.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Friction across the closure of a contact, or between a body and its guide: a spring in series with
/// a slider that holds up to the slip force.
///
/// In JSON the slip force is given by exactly one of `slip_force_n` and `coefficient`.
///
/// ```
/// use asperity_scenario::{FrictionSpec, SlipSpec};
///
/// let friction = FrictionSpec { stiffness_n_per_m: 1e7, slip: SlipSpec::ForceN(0.2) };
/// assert_eq!(serde_json::to_value(friction)?["slip_force_n"], 0.2);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "FrictionKeys", into = "FrictionKeys")]
pub struct FrictionSpec {
    /// Stiffness of the stuck element in N/m.
    pub stiffness_n_per_m: f64,
    /// Slip force.
    pub slip: SlipSpec,
}

/// Slip force of a friction element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SlipSpec {
    /// Slip force in N.
    ForceN(f64),
    /// Slip force over the force of the contact: this contact, or the one below the body.
    Coefficient(f64),
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
            (Some(force), None) => SlipSpec::ForceN(force),
            (None, Some(coefficient)) => SlipSpec::Coefficient(coefficient),
            _ => return Err("friction needs exactly one of slip_force_n and coefficient"),
        };
        Ok(Self { stiffness_n_per_m: keys.stiffness_n_per_m, slip })
    }
}

impl From<FrictionSpec> for FrictionKeys {
    fn from(friction: FrictionSpec) -> Self {
        let (slip_force_n, coefficient) = match friction.slip {
            SlipSpec::ForceN(force) => (Some(force), None),
            SlipSpec::Coefficient(coefficient) => (None, Some(coefficient)),
        };
        Self { stiffness_n_per_m: friction.stiffness_n_per_m, slip_force_n, coefficient }
    }
}
