//! Data of a problem file.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// JSON Pointers into the scenario, and the values that are put there.
pub type Changes = Map<String, Value>;

/// Data of one kind.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum DataSpec {
    /// Features of hits, written in place.
    Hits {
        /// A name.
        name: Option<String>,
        /// Changes of the scenario for these hits, such as a preload: JSON
        /// Pointers and values.
        #[serde(default, skip_serializing_if = "Changes::is_empty")]
        set: Changes,
        /// Least standard deviation of each feature, added in squares.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        floor: BTreeMap<String, SpreadSpec>,
        /// The hits.
        #[schemars(length(min = 1))]
        hits: Vec<HitSpec>,
    },
    /// Features of hits, from the `analysis.json` of `asperity analyse`.
    Analysis {
        /// A name.
        name: Option<String>,
        /// The file, relative to the folder of the problem, or its content in place.
        file: AnalysisRef,
        /// Folder of the records that the analysis names, relative to the folder of the problem, where
        /// they are neither at their paths nor beside the analysis or the problem.
        records: Option<String>,
        /// The force of each hit.
        #[serde(default)]
        pulse: PulseSpec,
        /// Changes of the scenario for these hits.
        #[serde(default, skip_serializing_if = "Changes::is_empty")]
        set: Changes,
        /// The features to use.
        #[serde(default = "default_features")]
        #[schemars(length(min = 1))]
        features: Vec<String>,
        /// Raise standard deviations to the scatter of repeated hits, where the analysis has
        /// levels of them.
        #[serde(default = "default_true")]
        repeatability: bool,
        /// Least standard deviation of each feature, added in squares.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        floor: BTreeMap<String, SpreadSpec>,
    },
    /// The receptance of one hit, or of an average of hits, in a band.
    Frf {
        /// A name.
        name: Option<String>,
        /// The file, relative to the folder of the problem: a CSV with the columns `frequency_hz` and
        /// real and imaginary part in m/N, or a universal, MAT or NPZ file of another program with a
        /// frequency response function; or these columns in place.
        file: TableRef,
        /// The function of such a file, by its name or `#NUMBER` among the functions; the only one when left
        /// out.
        function: Option<String>,
        /// Unit of the function where such a file gives none, e.g. `m/s^2/N`.
        unit: Option<String>,
        /// Number of averages behind the function. With the coherence of the file it gives standard
        /// deviations, which add in squares to `spread`.
        #[schemars(range(min = 1))]
        averages: Option<usize>,
        /// Features to compare in place of the parts of the receptance: frequency and receptance of the peak
        /// in the band (f1, A1) and of its second harmonic (f2, A2), and their ratio.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        features: Vec<String>,
        /// Least standard deviation of each feature, added in squares.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        floor: BTreeMap<String, SpreadSpec>,
        /// The hit.
        #[serde(default)]
        hit: HitConditionsSpec,
        /// Frequency band in Hz.
        band_hz: [f64; 2],
        /// Standard deviation of each part: of the largest magnitude in the
        /// band, and absolute in m/N.
        #[serde(default)]
        spread: SpreadSpec,
        /// Largest number of frequencies, evenly spaced.
        #[serde(default = "default_points")]
        #[schemars(range(min = 1, max = 10_000))]
        points: usize,
    },
    /// Frequency, and damping if asked for, over amplitude along the decay of one hit, from the
    /// `backbone.csv` of `asperity analyse` or `asperity decay`.
    Backbone {
        /// A name.
        name: Option<String>,
        /// The file, relative to the folder of the problem, or its columns in place.
        file: TableRef,
        /// Number of the hit or curve in the file; the only one when left out.
        index: Option<usize>,
        /// The hit. Where its force was not measured, any hit that reaches the amplitudes: the relation
        /// belongs to the free decay.
        #[serde(default)]
        hit: HitConditionsSpec,
        /// Standard deviation of the frequency, of its value and absolute in Hz.
        spread: SpreadSpec,
        /// Standard deviation of the damping ratio, of its value and absolute. Damping is not used
        /// when left out.
        damping_spread: Option<SpreadSpec>,
    },
    /// Records of hits: the measured force is the load of the model, and the
    /// receptances are compared in a band.
    Records {
        /// A name.
        name: Option<String>,
        /// The files, relative to the folder of the problem: paths, folders of records, and patterns
        /// with `*`, `?` or `[...]`; a file may hold several hits. Or records in place.
        #[schemars(length(min = 1))]
        files: Vec<RecordRef>,
        /// Settings of the rig, as for `asperity analyse --rig`: sample rate, names, units, sensitivities,
        /// channels, trigger.
        rig: Option<RigRef>,
        /// The channel of the force, as for `asperity analyse`.
        force: Option<String>,
        /// The channel of the response.
        response: Option<String>,
        /// Changes of the scenario for these hits.
        #[serde(default, skip_serializing_if = "Changes::is_empty")]
        set: Changes,
        /// Frequency band in Hz.
        band_hz: [f64; 2],
        /// Standard deviation added in squares to the noise at the end of
        /// the record: of the largest magnitude in the band, and absolute in m/N.
        #[serde(default)]
        spread: SpreadSpec,
    },
    /// Steady responses to a shaker at stepped frequencies: amplitude and phase at the place of the
    /// force, from a table in the order of the measurement.
    SteppedSine {
        /// A name.
        name: Option<String>,
        /// The file, relative to the folder of the problem: a CSV with the columns `frequency_hz`,
        /// `force_n` (force amplitude), `amplitude_m` or `amplitude_m_per_s2` (of displacement or
        /// acceleration) and optionally `phase_rad` or `phase_deg` (of the same to the force) and
        /// `level`; or these columns in place.
        file: TableRef,
        /// Changes of the scenario for these responses.
        #[serde(default, skip_serializing_if = "Changes::is_empty")]
        set: Changes,
        /// Standard deviation of an amplitude: of its value, and absolute in m of displacement.
        spread: SpreadSpec,
        /// Standard deviation of a phase in rad. Phases are not used when left out.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        phase_spread_rad: Option<f64>,
        /// Number of harmonics of the periodic responses.
        #[serde(default = "default_harmonics")]
        #[schemars(range(min = 1, max = 100))]
        harmonics: usize,
    },
    /// Points of the law itself, from a quasi-static test.
    Stiffness {
        /// Name of the law in "laws".
        law: String,
        /// Pairs [pressure in Pa, stiffness in Pa/m].
        #[schemars(length(min = 1))]
        points: Vec<[f64; 2]>,
        /// Standard deviation of the stiffness.
        spread: SpreadSpec,
    },
    /// The ratio of a feature of two hits.
    Ratio {
        /// The feature.
        feature: String,
        /// The hit above.
        numerator: HitConditionsSpec,
        /// The hit below.
        denominator: HitConditionsSpec,
        /// The ratio.
        value: f64,
        /// Its standard deviation.
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        standard_deviation: f64,
    },
}

/// The force of the hits of an analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PulseSpec {
    /// The measured one, from the record that the analysis names; the scenario's where there is none,
    /// and where numbers of the excitation are unknowns.
    #[default]
    Measured,
    /// The pulse of the scenario, with the measured peak.
    Scenario,
}

/// The settings of a rig, by their file or in place.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum RigRef {
    /// The file, relative to the folder of the problem.
    File(#[schemars(length(min = 1))] String),
    /// The settings themselves, as a file of `asperity analyse --rig` holds them.
    InPlace(Map<String, Value>),
}

/// Records by their files, or one in place.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum RecordRef {
    /// A path, folder or pattern, relative to the folder of the problem.
    Files(String),
    /// The samples themselves.
    InPlace(RecordSpec),
}

/// A record: channels that were sampled together.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RecordSpec {
    /// Sample rate in Hz.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub sample_rate_hz: f64,
    /// The channels.
    #[schemars(length(min = 1))]
    pub channels: Vec<RecordChannelSpec>,
}

/// A channel of a record.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RecordChannelSpec {
    /// Its name.
    pub name: String,
    /// Its unit, such as `m/s^2`; empty for one that the rig gives.
    #[serde(default)]
    pub unit: String,
    /// The samples, null for a missing one.
    pub data: Vec<Option<f64>>,
}

/// An analysis by its file, or in place.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum AnalysisRef {
    /// The file, relative to the folder of the problem.
    File(#[schemars(length(min = 1))] String),
    /// The analysis itself, as `analysis.json` holds it.
    InPlace(Map<String, Value>),
}

/// A table by its CSV file, or in place.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum TableRef {
    /// The file, relative to the folder of the problem.
    File(#[schemars(length(min = 1))] String),
    /// Its columns by their names, all of one length.
    InPlace(BTreeMap<String, Vec<Cell>>),
}

/// A cell of a table in place.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Cell {
    /// A number.
    Number(f64),
    /// A truth value, such as the cells of a column `valid`.
    Truth(bool),
    /// A text.
    Text(String),
    /// No value.
    Empty(()),
}

impl DataSpec {
    /// Files that the data are read from, relative to the folder of the problem, but those of records.
    pub fn files(&self) -> &[String] {
        match self {
            Self::Analysis { file: AnalysisRef::File(file), .. }
            | Self::Frf { file: TableRef::File(file), .. }
            | Self::Backbone { file: TableRef::File(file), .. }
            | Self::SteppedSine { file: TableRef::File(file), .. } => std::slice::from_ref(file),
            _ => &[],
        }
    }

    /// The name, or the kind and the number if the data at `index` have none.
    pub(crate) fn name_or_kind(&self, index: usize) -> String {
        let (name, kind) = match self {
            Self::Hits { name, .. } => (name.as_ref(), "hits"),
            Self::Analysis { name, .. } => (name.as_ref(), "analysis"),
            Self::Frf { name, .. } => (name.as_ref(), "frf"),
            Self::Backbone { name, .. } => (name.as_ref(), "backbone"),
            Self::Records { name, .. } => (name.as_ref(), "records"),
            Self::SteppedSine { name, .. } => (name.as_ref(), "stepped_sine"),
            Self::Stiffness { .. } => (None, "stiffness"),
            Self::Ratio { .. } => (None, "ratio"),
        };
        name.cloned().unwrap_or_else(|| format!("{kind} {}", index + 1))
    }
}

/// Conditions of a hit.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HitConditionsSpec {
    /// Largest force in N; the scenario's when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_peak_n: Option<f64>,
    /// Changes of the scenario for this hit: JSON Pointers and values.
    #[serde(default, skip_serializing_if = "Changes::is_empty")]
    pub set: Changes,
}

/// A hit and its features.
#[derive(Debug, Clone, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HitSpec {
    /// Largest force in N; the scenario's when left out.
    pub force_peak_n: Option<f64>,
    /// Changes of the scenario for this hit: JSON Pointers and values.
    #[serde(default, skip_serializing_if = "Changes::is_empty")]
    pub set: Changes,
    /// Features by the names that a summary gives them, such as
    /// `fundamental.frequency_hz`.
    pub features: BTreeMap<String, Measured>,
}

/// A measured number, with or without its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Measured {
    /// The number; its standard deviation is the floor's.
    Alone(f64),
    /// The number with its standard deviation.
    Uncertain(Uncertain),
}

/// A number with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Uncertain {
    /// The number.
    pub value: f64,
    /// Its standard deviation.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub standard_deviation: f64,
}

/// A standard deviation: the root of the sum of both squares.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpreadSpec {
    /// Relative to the value.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub relative: f64,
    /// In the unit of the value.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub absolute: f64,
}

impl Measured {
    /// Value and, if there is one, standard deviation.
    pub fn parts(self) -> (f64, Option<f64>) {
        match self {
            Self::Alone(value) => (value, None),
            Self::Uncertain(number) => (number.value, Some(number.standard_deviation)),
        }
    }
}

impl SpreadSpec {
    /// The standard deviation of a number of this `value`.
    pub fn of(self, value: f64) -> f64 {
        (self.relative * value).hypot(self.absolute)
    }
}

pub(crate) fn default_features() -> Vec<String> {
    ["fundamental.frequency_hz", "fundamental.receptance_m_per_n", "harmonic_ratio"]
        .map(str::to_owned)
        .to_vec()
}

fn default_true() -> bool {
    true
}

fn default_harmonics() -> usize {
    12
}

fn default_points() -> usize {
    60
}
