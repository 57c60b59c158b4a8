//! Viscous damping of a contact.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
