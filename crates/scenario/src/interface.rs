//! One contact interface of the stack.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::law::LawRef;

/// A rough contact between a body and what lies below it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InterfaceSpec {
    /// Name of the interface, used in the headers of the results.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Apparent area of contact in m².
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub area_m2: f64,
    /// The contact law: a name from "laws", or a law written in place.
    pub law: LawRef,
}
