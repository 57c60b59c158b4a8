//! What the stack stands on.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the lowest interface bears on.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum SupportSpec {
    /// A support that does not move.
    #[default]
    Rigid,
    /// A mass on a spring and a damper to the ground, e.g. a compliant disc.
    SpringMass {
        /// Stiffness of the spring in N/m.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        stiffness_n_per_m: f64,
        /// Moving mass of the support in kg.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        mass_kg: f64,
        /// Damping ratio of the support alone on its spring, c / (2 sqrt(k m)).
        #[schemars(range(min = 0.0))]
        damping_ratio: f64,
    },
}
