//! The problem: what is unknown, what was measured, and what is asked.
//!
//! As in a scenario, the JSON keys are the field names, each carrying its unit, and unknown keys
//! are refused. Features have the names of a [summary's](asperity_study::quantity::Quantity)
//! numbers.

mod data;
mod unknown;

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::sync::LazyLock;

pub use data::{DataSpec, HitSpec, Measured, SpreadSpec, StrikeSpec, Uncertain};
pub use unknown::{ChannelSpec, PriorSpec, ScaleSpec, UnknownSpec};

/// JSON Pointers into the scenario, and the values that are put there.
pub type Changes = Map<String, Value>;

/// An identification: a scenario with unknowns, and data to find them from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemSpec {
    /// The version of this format.
    pub schema: ProblemSchemaId,
    /// A line for people: what is identified.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String")]
    pub title: Option<String>,
    /// The scenario whose numbers are unknown: a file relative to the folder
    /// of the problem, or a scenario in place.
    pub scenario: ScenarioRef,
    /// The unknowns.
    #[schemars(length(min = 1))]
    pub unknowns: Vec<UnknownSpec>,
    /// What was measured.
    #[schemars(length(min = 1))]
    pub data: Vec<DataSpec>,
    /// The law whose stiffness is asked for: its name in "laws". The law of the
    /// first interface when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String")]
    pub law: Option<String>,
    /// Pressures in Pa between which its stiffness is drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 2]")]
    pub pressures_pa: Option<[f64; 2]>,
    /// How much a residual counts.
    #[serde(default)]
    pub loss: LossSpec,
    /// Whether the standard deviations are taken as they are.
    #[serde(default)]
    pub noise: NoiseSpec,
    /// Probability of the intervals and bands.
    #[serde(default = "default_level")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub level: f64,
    /// Other laws to compare with.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub compare: Vec<CandidateSpec>,
    /// Hits that could be made next.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "DesignSpec")]
    pub design: Option<DesignSpec>,
    /// Starts of the fit: the given one, and others spread over the bounds.
    #[serde(default = "default_starts")]
    #[schemars(range(min = 1, max = 1000))]
    pub starts: usize,
    /// Draws from the posterior that are run exactly.
    #[serde(default = "default_draws")]
    #[schemars(range(min = 100, max = 100_000))]
    pub draws: usize,
    /// Seed of all random numbers.
    #[serde(default = "default_seed")]
    pub seed: u64,
}

/// A scenario by its file, or in place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ScenarioRef {
    /// The file, relative to the folder of the problem.
    File(String),
    /// The scenario itself.
    InPlace(Map<String, Value>),
}

/// How much a residual counts, in standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum LossSpec {
    /// Its square: normal errors.
    #[default]
    Squared,
    /// Its square up to a threshold, beyond it linear.
    Huber {
        /// Standard deviations from which on a residual counts linearly.
        #[serde(default = "default_threshold")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        threshold: f64,
    },
    /// The logarithm of one plus its square: a few wild hits hardly count.
    Cauchy {
        /// Standard deviations at which a residual counts half.
        #[serde(default = "default_cauchy")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        scale: f64,
    },
}

/// Whether the standard deviations of the data are taken as they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NoiseSpec {
    /// As they are.
    Given,
    /// Never smaller; larger when the residuals are.
    #[default]
    AtLeastGiven,
}

/// Another law to compare with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CandidateSpec {
    /// Its name in the comparison.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Changes of the scenario: JSON Pointers and values.
    pub set: Changes,
    /// Unknowns of the candidate. Those of the problem stay, but for those
    /// inside what is changed.
    #[serde(default)]
    pub unknowns: Vec<UnknownSpec>,
}

/// Hits that could be made next, to be ranked by what they would tell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignSpec {
    /// Force levels in N.
    #[schemars(length(min = 1))]
    pub force_peak_n: Vec<f64>,
    /// Preloads or other changes of the rig: JSON Pointers and values, one
    /// object for each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<Changes>,
    /// Hits of each that would be made.
    #[serde(default = "default_repeats")]
    #[schemars(range(min = 1))]
    pub hits: usize,
}

/// The version of the problem format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum ProblemSchemaId {
    /// Version 1.
    #[default]
    #[serde(rename = "asperity/identify/1")]
    V1,
}

/// The JSON Schema (draft 2020-12) of a problem.
pub fn problem_schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(|| {
        let generator = SchemaSettings::draft2020_12().into_generator();
        generator.into_root_schema_for::<ProblemSpec>().to_value()
    });
    &SCHEMA
}

fn default_level() -> f64 {
    0.95
}

fn default_starts() -> usize {
    4
}

fn default_draws() -> usize {
    1000
}

fn default_seed() -> u64 {
    1
}

fn default_threshold() -> f64 {
    1.345
}

fn default_cauchy() -> f64 {
    2.385
}

fn default_repeats() -> usize {
    1
}
