//! The problem file: scenario, parameters, data and requested results.
//!
//! As in a scenario, the JSON keys are the field names, each with its unit, and unknown keys
//! are errors. Features have the names of a [summary's](asperity_simulation::quantity::Quantity)
//! numbers.

mod data;
mod parameter;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use asperity_scenario::schema_of;

pub(crate) use data::default_features;
pub use data::{
    AnalysisRef, Cell, Changes, DataSpec, HitConditionsSpec, HitSpec, Measured, PulseSpec,
    RecordChannelSpec, RecordRef, RecordSpec, RigRef, SpreadSpec, TableRef, Uncertain,
};
pub use parameter::{
    ChannelSpec, LogNormalSpec, ParameterSpec, PriorSpec, ScaleSpec, SlopeSmoothness,
};

/// An identification: a scenario, its unknown parameters, and data.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemSpec {
    /// The version of this format.
    pub schema: ProblemSchemaId,
    /// A title.
    pub title: Option<String>,
    /// The scenario: a file relative to the folder of the problem, or a
    /// scenario in place.
    pub scenario: ScenarioRef,
    /// The parameters to identify.
    #[schemars(length(min = 1, max = 100))]
    pub unknowns: Vec<ParameterSpec>,
    /// The data.
    #[schemars(length(min = 1, max = 1000))]
    pub data: Vec<DataSpec>,
    /// Tolerances of numbers of the scenario that are no unknowns. By default a number is rounded to
    /// its last digit, with a relative standard deviation of at most 0.005.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 100))]
    pub given: Vec<GivenSpec>,
    /// Name in "laws" of the law to report. The law of the first interface
    /// when left out.
    pub law: Option<String>,
    /// Range of pressures in Pa of the reported stiffness.
    pub pressures_pa: Option<[f64; 2]>,
    /// Loss of a residual.
    #[serde(default)]
    pub loss: LossSpec,
    /// Use of the standard deviations of the data.
    #[serde(default)]
    pub noise: NoiseSpec,
    /// Probability of the intervals and bands.
    #[serde(default = "default_level")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub level: f64,
    /// Name of the problem's own model in the comparison.
    #[schemars(length(min = 1))]
    pub name: Option<String>,
    /// Other laws, kinds of damping or other scenarios to compare with.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 100))]
    pub compare: Vec<CandidateSpec>,
    /// Possible further hits.
    pub design: Option<DesignSpec>,
    /// Starts of the fit: the given one, and others within the bounds.
    #[serde(default = "default_starts")]
    #[schemars(range(min = 1, max = 1000))]
    pub starts: usize,
    /// Draws from the posterior.
    #[serde(default = "default_draws")]
    #[schemars(range(min = 100, max = 100_000))]
    pub draws: usize,
    /// Seed of all random numbers.
    #[serde(default = "default_seed")]
    pub seed: u64,
}

/// The tolerance of a number of the scenario that is taken as given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GivenSpec {
    /// JSON Pointer to the number, such as `/bodies/0/mass_kg`; `/support` with zero states that the support is
    /// rigid.
    #[schemars(length(min = 1))]
    pub pointer: String,
    /// Standard deviation over the value; zero for an exact number.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub relative: f64,
}

/// A scenario by its file, or in place.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ScenarioRef {
    /// The file, relative to the folder of the problem.
    File(String),
    /// The scenario itself.
    InPlace(Map<String, Value>),
}

/// The loss of a residual in standard deviations.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum LossSpec {
    /// Its square: normal errors.
    #[default]
    Squared,
    /// Its square up to a threshold, linear beyond.
    Huber {
        /// Threshold in standard deviations.
        #[serde(default = "default_threshold")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        threshold: f64,
    },
    /// The logarithm of one plus its square: outliers have little weight.
    Cauchy {
        /// Scale in standard deviations, at which the weight is one half.
        #[serde(default = "default_cauchy")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        scale: f64,
    },
}

/// Use of the standard deviations of the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NoiseSpec {
    /// As given.
    Given,
    /// As given, or larger if the residuals are larger.
    #[default]
    AtLeastGiven,
}

/// Another law, kind of damping or other change of the scenario to compare with.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CandidateSpec {
    /// Its name in the comparison.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Changes of the scenario: JSON Pointers and values.
    pub set: Changes,
    /// Additional parameters of the candidate. Parameters of the problem remain
    /// unless they are inside a change.
    #[serde(default)]
    #[schemars(extend("default" = []))]
    pub unknowns: Vec<ParameterSpec>,
}

/// Possible further hits and quasi-static stiffnesses, to be ranked by the information expected.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignSpec {
    /// Force levels in N.
    #[schemars(length(min = 1, max = 1000))]
    pub force_peak_n: Vec<f64>,
    /// Preloads or other changes of the scenario: JSON Pointers and values, one
    /// object for each.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<Changes>,
    /// Number of hits of each kind.
    #[serde(default = "default_repeats")]
    #[schemars(range(min = 1, max = 1_000_000))]
    pub hits: usize,
    /// Features of the hits with their standard deviations over their values; the features of
    /// the data when left out.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub features: BTreeMap<String, f64>,
    /// Quasi-static stiffnesses of the law.
    pub stiffness: Option<DesignStiffness>,
    /// Lowest and highest pressure in Pa between which ln K is to be narrowed; the pressures
    /// that the runs reach when left out.
    pub pressures_pa: Option<[f64; 2]>,
}

/// Possible quasi-static stiffnesses.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesignStiffness {
    /// Pressures in Pa, each a measurement of its own.
    #[schemars(length(min = 1, max = 1000))]
    pub pressures_pa: Vec<f64>,
    /// Standard deviation over the value.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub relative: f64,
}

/// The version of the problem format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
pub enum ProblemSchemaId {
    /// Version 1.
    #[default]
    #[serde(rename = "asperity/identify/1")]
    V1,
}

/// The JSON Schema (draft 2020-12) of a problem.
pub fn problem_schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(schema_of::<ProblemSpec>);
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
