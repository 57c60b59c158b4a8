//! The scenario, its interfaces and its support, and the JSON Schema of all of it.
//!
//! JSON keys are the field names, each with its unit; unknown keys are refused. Bounds on single
//! values are part of the schema that these types generate; conditions between values are checked
//! in [`crate::validate`].

use std::sync::LazyLock;

use asperity_law::{ContactDampingSpec, FrictionSpec, LawRef, Laws};
use asperity_structure::{DampingSpec, ExcitationSpec, SensorSpec};
use schemars::generate::SchemaSettings;
use schemars::transform::transform_subschemas;
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::body::BodySpec;
use crate::method::{MethodKeys, MethodSpec, deserialize_method};

/// Default gravity in m/s², as the paper rounds it.
pub const DEFAULT_GRAVITY_M_PER_S2: f64 = 9.81;

/// Default sample rate of the output in Hz.
pub const DEFAULT_OUTPUT_RATE_HZ: f64 = 200_000.0;

/// Largest sample rate of the output in Hz.
pub const MAX_OUTPUT_RATE_HZ: f64 = 1e9;

/// Stack of elastic bodies with rough contacts, its excitation and its time integration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Version of the scenario format.
    pub schema: SchemaId,
    /// Title, for the reader.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// Gravity in m/s², positive down the stack.
    #[serde(default = "default_gravity")]
    #[schemars(range(min = 0.0))]
    pub gravity_m_per_s2: f64,
    /// Bodies, from the free top down to the support.
    #[schemars(length(min = 1, max = 1000))]
    pub bodies: Vec<BodySpec>,
    /// Support below the lowest interface.
    #[serde(default)]
    pub support: SupportSpec,
    /// Contact interfaces: one below each body, the last onto the support.
    #[schemars(length(min = 1, max = 1000))]
    pub interfaces: Vec<InterfaceSpec>,
    /// Contact laws by name, to be shared by interfaces.
    #[serde(default, skip_serializing_if = "Laws::is_empty")]
    pub laws: Laws,
    /// Damping of the bodies.
    pub damping: DampingSpec,
    /// Force on the stack, or motion of its base.
    #[serde(default)]
    pub excitation: ExcitationSpec,
    /// Sensors, from the first on: results are read at the first, and at the others beside it. The top
    /// of the stack when left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 100))]
    pub sensors: Vec<SensorSpec>,
    /// Simulated time in s.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub duration_s: f64,
    /// Sample rate of the output in Hz.
    #[serde(default = "default_output_rate")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = MAX_OUTPUT_RATE_HZ))]
    pub output_rate_hz: f64,
    /// Method of time integration.
    #[serde(default, deserialize_with = "deserialize_method")]
    #[schemars(with = "MethodKeys")]
    pub method: MethodSpec,
}

/// Rough contact between a body and the body or support below it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InterfaceSpec {
    /// Name of the interface, used in the headers of the results.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Apparent area of contact in m².
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub area_m2: f64,
    /// Contact law: a name from "laws", or a law written in place.
    pub law: LawRef,
    /// Viscous damping of the contact; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<ContactDampingSpec>,
    /// Friction across the closure; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionSpec>,
}

/// Support below the lowest interface.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum SupportSpec {
    /// Immovable support.
    #[default]
    Rigid,
    /// Mass on a spring and a damper to the ground, e.g. a compliant disc.
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

/// Version of the scenario format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum SchemaId {
    /// Version 1.
    #[default]
    #[serde(rename = "asperity/scenario/1")]
    V1,
}

/// JSON Schema (draft 2020-12) of a scenario, generated from [`Scenario`].
///
/// It states all keys, types and bounds once: [`check_schema`](crate::check_schema) applies it, and
/// editors complete scenarios with it.
///
/// ```
/// let schema = asperity_scenario::scenario_schema();
/// assert_eq!(schema["properties"]["gravity_m_per_s2"]["default"], 9.81);
/// ```
pub fn scenario_schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(schema_of::<Scenario>);
    &SCHEMA
}

/// JSON Schema (draft 2020-12) of a document type. An `Option` is left out or has its value: null
/// is not accepted.
pub fn schema_of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().with_transform(without_null);
    settings.into_generator().into_root_schema_for::<T>().to_value()
}

/// Removes the null that is generated for an `Option`, in this schema and all inside it.
fn without_null(schema: &mut Schema) {
    transform_subschemas(&mut without_null, schema);
    let Some(keywords) = schema.as_object_mut() else { return };
    if let Some([kind, Value::String(null)]) =
        keywords.get("type").and_then(Value::as_array).map(Vec::as_slice)
        && null == "null"
    {
        let kind = kind.clone();
        keywords.insert("type".to_owned(), kind);
    }
    if let Some([Value::Object(inner), null]) =
        keywords.get("anyOf").and_then(Value::as_array).map(Vec::as_slice)
        && null.get("type").is_some_and(|kind| kind == "null")
    {
        let inner = inner.clone();
        keywords.remove("anyOf");
        keywords.extend(inner);
    }
}

fn default_gravity() -> f64 {
    DEFAULT_GRAVITY_M_PER_S2
}

fn default_output_rate() -> f64 {
    DEFAULT_OUTPUT_RATE_HZ
}
