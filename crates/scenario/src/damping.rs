//! Viscous damping of the bodies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Viscous damping of the bodies.
///
/// In JSON the amount is given by exactly one of `ratio` and `rate_per_s`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "DampingKeys", into = "DampingKeys")]
pub enum DampingSpec {
    /// Force `h rho A u'` per length on every body: h times its momentum per length.
    MassProportional(DampingAmount),
}

/// Amount of mass-proportional damping.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DampingAmount {
    /// Damping ratio xi of the lowest mode linearised about static equilibrium, `h = 2 xi w0`.
    Ratio(f64),
    /// Damping rate h in 1/s.
    RatePerS(f64),
}

/// Viscous damping of the bodies.
#[derive(Clone, Copy, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "DampingSpec")]
enum DampingKeys {
    /// Force on every body proportional to its momentum, with exactly one of ratio and
    /// `rate_per_s`.
    #[schemars(extend("oneOf" = [{"required": ["ratio"]}, {"required": ["rate_per_s"]}]))]
    MassProportional {
        /// Damping ratio of the lowest mode linearised about static equilibrium; give this or
        /// `rate_per_s`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        ratio: Option<f64>,
        /// Damping rate h of the equation of motion in 1/s; give this or ratio.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0.0))]
        rate_per_s: Option<f64>,
    },
}

impl TryFrom<DampingKeys> for DampingSpec {
    type Error = &'static str;

    fn try_from(keys: DampingKeys) -> Result<Self, Self::Error> {
        let DampingKeys::MassProportional { ratio, rate_per_s } = keys;
        match (ratio, rate_per_s) {
            (Some(xi), None) => Ok(Self::MassProportional(DampingAmount::Ratio(xi))),
            (None, Some(h)) => Ok(Self::MassProportional(DampingAmount::RatePerS(h))),
            _ => Err("mass_proportional damping needs exactly one of ratio and rate_per_s"),
        }
    }
}

impl From<DampingSpec> for DampingKeys {
    fn from(damping: DampingSpec) -> Self {
        let DampingSpec::MassProportional(amount) = damping;
        let (ratio, rate_per_s) = match amount {
            DampingAmount::Ratio(xi) => (Some(xi), None),
            DampingAmount::RatePerS(h) => (None, Some(h)),
        };
        Self::MassProportional { ratio, rate_per_s }
    }
}
