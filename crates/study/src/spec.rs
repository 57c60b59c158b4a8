//! The study file: a scenario, inputs with distributions, and a design.
//!
//! As in a scenario, the JSON keys are the field names, and unknown keys are errors.

use std::sync::LazyLock;

use asperity_scenario::schema_of;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Map, Value};

/// A study: a scenario, its uncertain or varied inputs, and the design of its runs.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StudySpec {
    /// The version of this format.
    pub schema: StudySchemaId,
    /// A title.
    pub title: Option<String>,
    /// The scenario: a file relative to the folder of the study, or a scenario in place.
    pub scenario: StudiedScenario,
    /// The inputs, each with a distribution or a column of a table.
    #[serde(default)]
    #[schemars(length(max = 100), extend("default" = []))]
    pub inputs: Vec<InputSpec>,
    /// Correlation of these inputs; independent when left out.
    pub correlation: Option<CorrelationSpec>,
    /// Inputs that are drawn together, such as from the posterior of an identification.
    pub draws: Option<DrawsSpec>,
    /// Lines of the receptance that are observed in each run.
    pub frf: Option<FrfSpec>,
    /// The design.
    pub design: StudyDesign,
    /// Rows of a chunk, the part of the results that is written at once.
    #[serde(default = "default_chunk_rows")]
    #[schemars(range(min = 1, max = 1_000_000))]
    pub chunk_rows: u64,
}

/// Equally spaced lines of the receptance, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrfSpec {
    /// The first frequency \[Hz\].
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub start_hz: f64,
    /// The last frequency \[Hz\], above the first.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub stop_hz: f64,
    /// Number of lines.
    #[schemars(range(min = 2, max = 2000))]
    pub count: usize,
}

impl FrfSpec {
    /// The frequencies \[Hz\].
    pub fn frequencies(&self) -> Vec<f64> {
        let step = (self.stop_hz - self.start_hz) / (self.count - 1) as f64;
        (0..self.count).map(|i| self.start_hz + step * i as f64).collect()
    }
}

/// A scenario by its file, or in place.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum StudiedScenario {
    /// The file, relative to the folder of the study.
    File(String),
    /// The scenario itself.
    InPlace(Map<String, Value>),
}

/// One input: a place of the scenario and the distribution of its values.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InputSpec {
    /// JSON Pointer into the scenario, such as /damping/ratio.
    #[schemars(length(min = 1))]
    pub pointer: String,
    /// Pointers to other values that are the same.
    #[serde(default)]
    #[schemars(length(max = 100), extend("default" = []))]
    pub also: Vec<String>,
    /// Its name in the results; the pointer when left out.
    pub name: Option<String>,
    /// The distribution of its values; of a table only a choice, for a column of texts.
    pub distribution: Option<DistributionSpec>,
}

/// A distribution.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum DistributionSpec {
    /// All values between two ends are equally likely.
    Uniform {
        /// The least value.
        lower: f64,
        /// The greatest value.
        upper: f64,
    },
    /// The logarithm is uniform.
    LogUniform {
        /// The least value.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        lower: f64,
        /// The greatest value.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        upper: f64,
    },
    /// Normal.
    Normal {
        /// The mean.
        mean: f64,
        /// The standard deviation.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        standard_deviation: f64,
    },
    /// The logarithm is normal.
    Lognormal {
        /// The median.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        median: f64,
        /// The standard deviation of the natural logarithm; for small values the relative one of the
        /// value.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        log_standard_deviation: f64,
    },
    /// The density rises linearly to the mode and falls linearly.
    Triangular {
        /// The least value.
        lower: f64,
        /// The most likely value.
        mode: f64,
        /// The greatest value.
        upper: f64,
    },
    /// One of several values, such as names of laws.
    Choice {
        /// The values.
        #[schemars(length(min = 1, max = 10_000))]
        values: Vec<Value>,
        /// Their weights; equal when left out.
        weights: Option<Vec<f64>>,
    },
}

/// Correlation of the inputs, in their order.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CorrelationSpec {
    /// Meaning of the matrix.
    #[serde(default)]
    pub kind: CorrelationKind,
    /// Rows of the matrix, with ones on the diagonal.
    #[schemars(length(min = 1, max = 100))]
    pub matrix: Vec<Vec<f64>>,
}

/// Meaning of a correlation matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CorrelationKind {
    /// Rank correlations (Spearman).
    #[default]
    Rank,
    /// Correlations of the normal scores, which are the values' for normal inputs.
    NormalScores,
}

/// Draws of several inputs with weights, from a file.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DrawsSpec {
    /// The file, relative to the folder of the study: draws.json of an identification, whose
    /// draws change the scenario, or a CSV file such as its posterior.csv.
    pub file: String,
    /// For a CSV file, JSON Pointers into the scenario, each with the name of its column.
    #[schemars(length(min = 1, max = 100))]
    pub columns: Option<Map<String, Value>>,
    /// For a CSV file, the column of the weights; equal weights when there is no such column.
    #[serde(default = "default_weight")]
    pub weight: String,
}

/// A design.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum StudyDesign {
    /// All combinations of levels, the last input varying fastest.
    Grid {
        /// Number of levels of each input, quantiles at the middles of equal probabilities.
        #[schemars(length(min = 1, max = 100))]
        levels: Vec<u64>,
    },
    /// Independent random rows.
    Random {
        /// Number of rows.
        #[schemars(range(min = 1))]
        rows: u64,
        /// Seed of all random numbers.
        #[serde(default = "default_seed")]
        seed: u64,
    },
    /// Latin hypercube.
    LatinHypercube {
        /// Number of rows.
        #[schemars(range(min = 1))]
        rows: u64,
        /// Seed of all random numbers.
        #[serde(default = "default_seed")]
        seed: u64,
    },
    /// Scrambled Sobol sequence.
    Sobol {
        /// Number of rows, best a power of 2.
        #[schemars(range(min = 1))]
        rows: u64,
        /// Seed of all random numbers.
        #[serde(default = "default_seed")]
        seed: u64,
    },
    /// Saltelli's design for Sobol indices.
    Saltelli {
        /// Number of base rows, best a power of 2; each takes as many runs as there are inputs, and 2.
        #[schemars(range(min = 1))]
        base_rows: u64,
        /// Seed of all random numbers.
        #[serde(default = "default_seed")]
        seed: u64,
    },
    /// Rows from a CSV or Parquet file with a column for each input, by its name or its pointer.
    Table {
        /// The file, relative to the folder of the study.
        #[schemars(length(min = 1))]
        file: String,
        /// The number of rows that it must have; any when left out.
        #[schemars(range(min = 1))]
        rows: Option<u64>,
    },
}

/// The version of the study format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
pub enum StudySchemaId {
    /// Version 1.
    #[default]
    #[serde(rename = "asperity/study/1")]
    V1,
}

/// The JSON Schema (draft 2020-12) of a study file.
pub fn study_schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(schema_of::<StudySpec>);
    &SCHEMA
}

fn default_chunk_rows() -> u64 {
    4096
}

fn default_weight() -> String {
    "weight".to_owned()
}

fn default_seed() -> u64 {
    1
}
