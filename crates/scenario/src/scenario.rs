//! The scenario: everything one study needs, as typed data.
//!
//! The JSON keys are the field names, each carrying its unit; unknown keys are
//! refused. The bounds that one value must keep by itself are part of the
//! schema these types generate (see [`crate::schema`]); the conditions that tie
//! several values together are checked by [`crate::validate`]. Read a scenario
//! through [`crate::document::Document`], which applies both and reports every
//! problem with its place in the text.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{BodySpec, DampingSpec, ExcitationSpec, InterfaceSpec, Laws, MethodSpec, SupportSpec};

/// Standard gravity as the paper rounds it, in m/s².
pub const DEFAULT_GRAVITY_M_PER_S2: f64 = 9.81;

/// Rate of the output samples in Hz when the scenario does not say.
pub const DEFAULT_OUTPUT_RATE_HZ: f64 = 200_000.0;

/// Highest rate of the output samples, in Hz.
pub const MOST_OUTPUT_RATE_HZ: f64 = 1e9;

/// A stack of bodies with rough contacts, what excites it, and how long it is
/// watched.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// The version of this format.
    pub schema: SchemaId,
    /// A line for people: what is studied.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String")]
    pub title: Option<String>,
    /// Gravity in m/s², pointing down the stack.
    #[serde(default = "default_gravity")]
    #[schemars(range(min = 0.0))]
    pub gravity_m_per_s2: f64,
    /// The bodies, from the free top down to the support.
    #[schemars(length(min = 1))]
    pub bodies: Vec<BodySpec>,
    /// What the lowest body stands on.
    #[serde(default)]
    pub support: SupportSpec,
    /// The contact interfaces: one below each body, the last onto the support.
    #[schemars(length(min = 1))]
    pub interfaces: Vec<InterfaceSpec>,
    /// Contact laws by name, for the interfaces to share.
    #[serde(default, skip_serializing_if = "Laws::is_empty")]
    pub laws: Laws,
    /// Viscous damping of the bodies.
    pub damping: DampingSpec,
    /// The force on the top of the stack.
    #[serde(default)]
    pub excitation: ExcitationSpec,
    /// Length of the simulated time in s.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub duration_s: f64,
    /// Rate in Hz of the samples written and analysed.
    #[serde(default = "default_output_rate")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = MOST_OUTPUT_RATE_HZ))]
    pub output_rate_hz: f64,
    /// How the equation of motion is integrated in time.
    #[serde(default)]
    pub method: MethodSpec,
}

/// The version of the scenario format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum SchemaId {
    /// Version 1.
    #[default]
    #[serde(rename = "asperity/scenario/1")]
    V1,
}

fn default_gravity() -> f64 {
    DEFAULT_GRAVITY_M_PER_S2
}

fn default_output_rate() -> f64 {
    DEFAULT_OUTPUT_RATE_HZ
}
