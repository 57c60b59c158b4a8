//! Parameters of a problem file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
        /// Its scale; logarithmic by default when both bounds are positive, but for exponents.
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
    /// A law without an assumed form: ln K over ln p at many points, whose
    /// slope deviates from the slope of the scenario's law by a smooth random
    /// function of unknown amplitude and length. The law of the scenario is
    /// replaced by a table. Other unknowns may be numbers of that law: the free
    /// law deviates from the form that they give.
    FreeLaw {
        /// Name of the law in "laws".
        law: String,
        /// Least and greatest pressure of the table in Pa. Half of the least and
        /// twice the greatest pressure that the data reach with the scenario's
        /// law when left out.
        pressures_pa: Option<[f64; 2]>,
        /// Number of points of the table.
        #[serde(default = "default_points")]
        #[schemars(range(min = 10, max = 80))]
        points: usize,
        /// Pressure in Pa at which the level of the law is unknown by a number
        /// of its own; the static one when left out.
        at_pa: Option<f64>,
        /// Standard deviation of ln K at that pressure.
        #[serde(default = "default_law_level")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        level: f64,
        /// Standard deviation of the slope d ln K / d ln p.
        #[serde(default = "default_roughness")]
        roughness: LogNormalSpec,
        /// Length in ln p over which the slope changes.
        #[serde(default = "default_length")]
        length: LogNormalSpec,
        /// Smoothness of the slope: the kinds among which the data choose, each
        /// with the same prior probability.
        #[serde(default = "default_smoothness")]
        #[schemars(length(min = 1, max = 2), extend("uniqueItems" = true))]
        smoothness: Vec<SlopeSmoothness>,
        /// True if the exponent d ln K / d ln p is between 0 and 1 at all
        /// pressures; otherwise it is positive.
        #[serde(default)]
        exponent_between_0_and_1: bool,
        /// Pressure in Pa from which on the law is concave: K rises ever less
        /// with pressure. Nowhere when left out.
        concave_above_pa: Option<f64>,
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

/// Smoothness of the slope d ln K / d ln p of a free law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SlopeSmoothness {
    /// The slope has a derivative (Matérn covariance of smoothness 3/2): laws
    /// without kinks.
    Differentiable,
    /// The slope is continuous without a derivative (Matérn covariance of
    /// smoothness 1/2, as of slopes with jumps at random pressures): laws with
    /// kinks or steep shoulders.
    Continuous,
}

/// A positive number whose logarithm has a normal distribution.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogNormalSpec {
    /// Its median.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub median: f64,
    /// Standard deviation of its natural logarithm; zero for a known number.
    #[schemars(range(min = 0.0, max = 3.0))]
    pub log_deviation: f64,
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

fn default_points() -> usize {
    40
}

fn default_law_level() -> f64 {
    1.0
}

fn default_roughness() -> LogNormalSpec {
    LogNormalSpec { median: 0.5, log_deviation: 0.8 }
}

fn default_length() -> LogNormalSpec {
    LogNormalSpec { median: 1.0, log_deviation: 0.5 }
}

fn default_smoothness() -> Vec<SlopeSmoothness> {
    vec![SlopeSmoothness::Differentiable, SlopeSmoothness::Continuous]
}

fn default_gains() -> [f64; 2] {
    [0.5, 2.0]
}
