//! Parameters of a problem file.

use schemars::JsonSchema;
use serde::Deserialize;

/// One parameter to identify, or several of one law.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ParameterSpec {
    /// A number of the scenario.
    Scalar {
        /// JSON Pointer into the scenario, such as /damping/ratio.
        #[schemars(length(min = 1))]
        pointer: String,
        /// Pointers to other numbers that have the same value.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        #[schemars(length(max = 100), extend("default" = []))]
        also: Vec<String>,
        /// Its name in the results; the pointer when left out.
        name: Option<String>,
        /// The least and the greatest value.
        bounds: [f64; 2],
        /// Start of the fit; the scenario's value when left out.
        start: Option<f64>,
        /// Its scale; logarithmic by default when both bounds are positive.
        scale: Option<ScaleSpec>,
        /// Its prior.
        prior: Option<PriorSpec>,
    },
    /// The stiffnesses at the knots of a modified power law or the points of a
    /// table, as relative steps from one to the next: all values give a
    /// monotone law.
    MonotoneLaw {
        /// Name of the law in "laws".
        law: String,
        /// The least and the greatest step, 1 - K\[i\]/K\[i+1\].
        #[serde(default = "default_steps")]
        steps: [f64; 2],
    },
    /// The gain of a sensor: measured over true value.
    Gain {
        /// The channel.
        channel: ChannelSpec,
        /// Its name in the results.
        name: Option<String>,
        /// Names of the data it holds for; all when left out.
        data: Option<Vec<String>>,
        /// The least and the greatest value.
        #[serde(default = "default_gains")]
        bounds: [f64; 2],
        /// Its prior.
        prior: Option<PriorSpec>,
    },
}

/// The scale of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ScaleSpec {
    /// Its value.
    Linear,
    /// Its logarithm.
    Logarithmic,
}

/// A normal distribution: of the value, or on a logarithmic scale of its logarithm.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PriorSpec {
    /// Its mean.
    pub value: f64,
    /// Its standard deviation; give this or relative.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub standard_deviation: Option<f64>,
    /// Its standard deviation over its mean.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub relative: Option<f64>,
}

/// A channel of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ChannelSpec {
    /// The hammer's force.
    Force,
    /// The response.
    Response,
}

fn default_steps() -> [f64; 2] {
    [0.001, 0.98]
}

fn default_gains() -> [f64; 2] {
    [0.5, 2.0]
}
