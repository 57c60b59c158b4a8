//! Settings of a rig: a file in place of the options that each of its tests needs.

use asperity_measure::{ChannelUnit, InvalidCells, SampleAxis};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::channel::{ChannelSelector, ResponseChoice};
use crate::inspection::Inspection;
use crate::options::{AnalysisOptions, ChannelSensor, FrequencyBand, parse_estimator};

/// Settings of a rig.
///
/// Keys that are left out have the values of [`AnalysisOptions::default`]. Numbers are in SI units.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigSettings {
    /// The version of this format.
    pub schema: RigSchemaId,
    /// A title.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// Sample rate in Hz, for files without a time axis.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub sample_rate_hz: Option<f64>,
    /// Axis of an array along which the samples run. The longer one when left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sample_axis: Option<RigSampleAxis>,
    /// The channels, in the order of the file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000), extend("default" = []))]
    pub channels: Vec<RigChannel>,
    /// Channel of the force: its name, "#" and its number, or its quantity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<String>,
    /// Channels of the responses; "all" alone for all of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000), extend("default" = []))]
    pub responses: Vec<String>,
    /// True for a force that is negative when the hammer pushes.
    #[serde(default)]
    pub flip_force: bool,
    /// Cells of texts that are no number: refused, the default, or taken as dropouts or overloads.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub invalid_cells: Option<RigInvalidCells>,
    /// Corner in Hz of a high-pass of second order for the responses, which takes out drifts.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub high_pass_hz: Option<f64>,
    /// Trigger level in N.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub level_n: Option<f64>,
    /// Longest hit in s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_s: Option<f64>,
    /// Time before the trigger that belongs to the hit, in s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub pre_trigger_s: Option<f64>,
    /// Time after a trigger in which a further impact makes a double hit, in s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub hold_off_s: Option<f64>,
    /// Estimator of the averaged function.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimator: Option<RigEstimator>,
    /// Windows: "auto", "none", "force", "exponential" or "force+exponential", the latter two also
    /// with ":" and a time constant in s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub window: Option<String>,
    /// Band of the fundamental in Hz.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub band_hz: Option<[f64; 2]>,
    /// True where double hits, overloads and dropouts are averaged too.
    #[serde(default)]
    pub keep_all: bool,
}

/// The accepted versions of the format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum RigSchemaId {
    /// Version 1.
    #[default]
    #[serde(rename = "asperity/rig/1")]
    V1,
}

/// A channel of a rig.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigChannel {
    /// Name. That of the file when left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Unit, such as "m/s^2". That of the file when left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// Sensitivity of the sensor of a channel in volts, such as "100mV/g".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensitivity: Option<String>,
}

/// An axis of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RigSampleAxis {
    /// Rows are instants.
    First,
    /// Columns are instants.
    Last,
}

/// Treatment of a cell of a text that is no number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RigInvalidCells {
    /// An error that names the row.
    Refuse,
    /// A missing sample.
    Dropout,
    /// A sample beyond the range of the sensor.
    Overload,
}

impl From<RigInvalidCells> for InvalidCells {
    fn from(cells: RigInvalidCells) -> Self {
        match cells {
            RigInvalidCells::Refuse => Self::Refuse,
            RigInvalidCells::Dropout => Self::Dropout,
            RigInvalidCells::Overload => Self::Overload,
        }
    }
}

/// An estimator of the averaged function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RigEstimator {
    /// H1.
    H1,
    /// H2.
    H2,
    /// Hv with equal noise ratios.
    Hv,
}

/// A fault of a rig's settings that their JSON schema does not tell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RigFault {
    /// JSON Pointer to the value.
    pub pointer: String,
    /// The fault, in words.
    pub found: String,
    /// Accepted values, in words.
    pub accepted: String,
}

impl RigSettings {
    /// Settings as a file was found to be: channels of its first record, force and responses. Units
    /// that the file does not tell are empty, those that are not known are left out.
    pub fn of_inspection(found: &Inspection) -> Self {
        let first = found.channels.iter().filter(|channel| channel.record == 1);
        let channels: Vec<RigChannel> = first
            .map(|channel| RigChannel {
                name: Some(channel.name.clone()),
                unit: is_known(&channel.unit).then(|| channel.unit.clone()),
                sensitivity: None,
            })
            .collect();
        let name = |number: usize| channels.get(number - 1).and_then(|one| one.name.clone());
        Self {
            force: found.force.channel.and_then(name),
            responses: found.response.channels.iter().copied().filter_map(name).collect(),
            channels,
            ..Self::default()
        }
    }

    /// The options of an analysis with these settings.
    ///
    /// # Errors
    /// All values that are not understood.
    pub fn options(&self) -> Result<AnalysisOptions, Vec<RigFault>> {
        let mut faults = Vec::new();
        let mut options = AnalysisOptions::default();
        let reading = &mut options.reading;
        reading.sample_rate_hz = self.sample_rate_hz;
        reading.sample_axis = self.sample_axis.map(|axis| match axis {
            RigSampleAxis::First => SampleAxis::First,
            RigSampleAxis::Last => SampleAxis::Last,
        });
        reading.invalid_cells = self.invalid_cells.map_or(InvalidCells::Refuse, Into::into);
        for (number, channel) in self.channels.iter().enumerate() {
            if let Some(unit) = channel.unit.as_ref().filter(|unit| !is_known(unit)) {
                faults.push(RigFault {
                    pointer: format!("/channels/{number}/unit"),
                    found: format!("the unit `{unit}`"),
                    accepted: "a unit such as N, lbf, V, m/s^2, g, mm/s or um".to_owned(),
                });
            }
            match channel.sensitivity.as_deref().map(str::parse) {
                None => {}
                Some(Ok(sensitivity)) => options.sensitivities.push(ChannelSensor {
                    channel: ChannelSelector::Number(number + 1),
                    sensitivity,
                }),
                Some(Err(error)) => faults.push(RigFault {
                    pointer: format!("/channels/{number}/sensitivity"),
                    found: error.to_string(),
                    accepted: "volts over a unit, such as 2.25mV/N or 100mV/g".to_owned(),
                }),
            }
        }
        // Names and units of the first channels; an empty one keeps the file's.
        let texts = |text: fn(&RigChannel) -> Option<&String>| -> Vec<String> {
            let given = self.channels.iter().rposition(|channel| text(channel).is_some());
            let kept = self.channels.iter().take(given.map_or(0, |last| last + 1));
            kept.map(|channel| text(channel).cloned().unwrap_or_default()).collect()
        };
        reading.names = texts(|channel| channel.name.as_ref());
        reading.units = texts(|channel| channel.unit.as_ref());
        options.force = self.force.as_deref().map(Into::into);
        let responses: Vec<ChannelSelector> =
            self.responses.iter().map(|text| text.as_str().into()).collect();
        options.responses = ResponseChoice::of(&responses);
        options.flip_force = self.flip_force;
        options.high_pass_hz = self.high_pass_hz;
        options.trigger_level_n = self.level_n;
        options.hit_length_s = self.length_s;
        options.pre_trigger_s = self.pre_trigger_s.unwrap_or(options.pre_trigger_s);
        options.hold_off_s = self.hold_off_s.unwrap_or(options.hold_off_s);
        options.keep_all = self.keep_all;
        let estimator = self.estimator.map(|estimator| match estimator {
            RigEstimator::H1 => "h1",
            RigEstimator::H2 => "h2",
            RigEstimator::Hv => "hv",
        });
        if let Some(Ok(estimator)) = estimator.map(parse_estimator) {
            options.estimator = estimator;
        }
        match self.window.as_deref().map(str::parse) {
            None => {}
            Some(Ok(windows)) => options.windows = windows,
            Some(Err(_)) => faults.push(RigFault {
                pointer: "/window".to_owned(),
                found: format!("the window `{}`", self.window.as_deref().unwrap_or_default()),
                accepted: "auto, none, force, exponential[:TAU] with TAU in seconds, or \
                           force+exponential"
                    .to_owned(),
            }),
        }
        if let Some([low_hz, high_hz]) = self.band_hz {
            if !(low_hz >= 0.0 && high_hz > low_hz) {
                faults.push(RigFault {
                    pointer: "/band_hz".to_owned(),
                    found: format!("a band from {low_hz} to {high_hz} Hz"),
                    accepted: "two frequencies in Hz, the second above the first".to_owned(),
                });
            }
            options.band_hz = Some(FrequencyBand { low_hz, high_hz });
        }
        if options.hold_off_s <= options.pre_trigger_s {
            faults.push(RigFault {
                pointer: "/hold_off_s".to_owned(),
                found: format!("{} s", options.hold_off_s),
                accepted: "a time longer than pre_trigger_s".to_owned(),
            });
        }
        if faults.is_empty() { Ok(options) } else { Err(faults) }
    }
}

/// True for the text of a known unit, or of none.
fn is_known(unit: &str) -> bool {
    !matches!(ChannelUnit::of_text(unit), ChannelUnit::Unrecognised(_))
}
