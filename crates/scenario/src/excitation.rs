//! Force on the top of the stack.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Force on the top of the stack, positive when it pushes down.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ExcitationSpec {
    /// No force: the stack stays in static equilibrium.
    #[default]
    None,
    /// Hammer pulse F (t/rise)^2 exp(2 (1 - t/rise)): smooth, without a zero in its spectrum.
    GammaPulse {
        /// Largest force F in N; negative pulls.
        peak_n: f64,
        /// Time of the largest force in s.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        rise_s: f64,
    },
    /// Pulse F sin(pi t / duration), zero afterwards.
    HalfSine {
        /// Largest force F in N; negative pulls.
        peak_n: f64,
        /// Length of the pulse in s.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        duration_s: f64,
    },
    /// Pulse F sin^2(pi t / duration), zero afterwards.
    Haversine {
        /// Largest force F in N; negative pulls.
        peak_n: f64,
        /// Length of the pulse in s.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        duration_s: f64,
    },
    /// Shaker: F sin(2 pi f t) from t = 0 on.
    Harmonic {
        /// Amplitude F of the force in N.
        amplitude_n: f64,
        /// Frequency f in Hz.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        frequency_hz: f64,
    },
    /// Measured force, linear between its samples and zero outside them.
    Samples {
        /// CSV file with the columns `time_s,force_n`, relative to the folder of the scenario.
        #[schemars(length(min = 1))]
        file: String,
        /// Largest magnitude in N to which the force is rescaled; as measured when left out, reversed
        /// when negative.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        peak_n: Option<f64>,
    },
}
