//! Methods of time integration.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

/// Default length of a finite-difference cell in m.
pub const DEFAULT_CELL_M: f64 = 0.001;

/// Default Courant number.
pub const DEFAULT_COURANT: f64 = 0.95;

/// Method of time integration.
///
/// In a scenario an object with its `kind`, or the kind alone as a string for the defaults of the
/// method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[schemars(rename = "MethodSettings", description = "Method with its settings.")]
pub enum MethodSpec {
    /// Explicit finite differences of the paper (Eqs. 2 to 5).
    FiniteDifference(FiniteDifferenceSpec),
    /// Exact modal steps with implicit contact.
    Modal(ModalSpec),
}

/// Exact modal steps with implicit contact.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModalSpec {
    /// Step in s; left out, it is chosen so that the lowest natural frequency and the
    /// excitation are resolved, and halved until the accuracy is reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub step_s: Option<f64>,
    /// Modes of each body, the rigid one included; left out, the number is chosen so that the
    /// inertia of the omitted modes is negligible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 2000))]
    pub modes_per_body: Option<usize>,
    /// Relative accuracy of the observables, a tenth of it for the fundamental frequency: step and
    /// modes that are not given are refined until the estimated errors are smaller. Left out, 1e-3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-7, max = 0.1))]
    pub accuracy: Option<f64>,
}

/// Explicit finite differences of the paper (Eqs. 2 to 5).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FiniteDifferenceSpec {
    /// Length of a cell in m; each body takes the next whole number of cells, at least one.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub cell_m: f64,
    /// Courant number c dt / dx of the stability condition (Eq. 3, CFL).
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub courant: f64,
    /// Time at which the contact pressure is taken within a step.
    pub contact: ContactScheme,
}

/// Time at which the contact pressure is taken within a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactScheme {
    /// Mean of the new closure and the one two steps before: no numerical dissipation of first
    /// order.
    #[default]
    Centred,
    /// New closure, as the paper reads: damps the fundamental by about w0^2 dt.
    NewLevel,
}

impl Default for FiniteDifferenceSpec {
    fn default() -> Self {
        Self { cell_m: DEFAULT_CELL_M, courant: DEFAULT_COURANT, contact: ContactScheme::default() }
    }
}

impl Default for MethodSpec {
    fn default() -> Self {
        Self::Modal(ModalSpec::default())
    }
}

/// Method of time integration.
///
/// In JSON an object with its `kind`, or the kind alone as a string for the defaults of the method.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "MethodSpec")]
pub(crate) enum MethodKeys {
    /// Kind alone, with the defaults.
    Kind(MethodKind),
    /// Kind with settings.
    Settings(MethodSpec),
}

/// Method by its kind alone, with its defaults.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MethodKind {
    /// Explicit finite differences of the paper, with cells of 1 mm.
    FiniteDifference,
    /// Exact modal steps, with step and modes chosen from error bounds.
    Modal,
}

/// Reads a method, or its kind alone.
pub(crate) fn deserialize_method<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<MethodSpec, D::Error> {
    Ok(match MethodKeys::deserialize(deserializer)? {
        MethodKeys::Kind(MethodKind::FiniteDifference) => {
            MethodSpec::FiniteDifference(FiniteDifferenceSpec::default())
        }
        MethodKeys::Kind(MethodKind::Modal) => MethodSpec::default(),
        MethodKeys::Settings(method) => method,
    })
}
