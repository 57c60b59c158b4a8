//! Methods of time integration.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Default length of a finite-difference cell in m.
pub const DEFAULT_CELL_M: f64 = 0.001;

/// Default Courant number.
pub const DEFAULT_COURANT: f64 = 0.95;

/// Method of time integration.
///
/// In JSON an object with its `kind`, or the kind alone as a string for the defaults of the method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "MethodKeys", into = "MethodSettings")]
pub enum MethodSpec {
    /// Explicit finite differences of the paper (Eqs. 2 to 5).
    FiniteDifference(FiniteDifferenceSpec),
    /// Exact modal steps with implicit contact.
    Modal(ModalSpec),
}

/// Exact modal steps with implicit contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ModalSpec {
    /// Step in s; `None` for a step chosen from an error estimate.
    pub step_s: Option<f64>,
    /// Modes of each body, the rigid one included; `None` for a number chosen from an error bound.
    pub modes_per_body: Option<usize>,
}

/// Explicit finite differences of the paper (Eqs. 2 to 5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiniteDifferenceSpec {
    /// Largest length of a cell in m; each body takes a whole number of cells.
    pub cell_m: f64,
    /// Courant number c dt / dx, below 1 (Eq. 3).
    pub courant: f64,
    /// Time at which the contact pressure is taken.
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

/// Method of time integration: its kind with settings, or the kind alone for the defaults.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "MethodSpec")]
enum MethodKeys {
    /// Kind alone, with the defaults.
    Kind(MethodKind),
    /// Kind with settings.
    Settings(MethodSettings),
}

/// Method by its kind alone, with its defaults.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum MethodKind {
    /// Explicit finite differences of the paper, with cells of 1 mm.
    FiniteDifference,
    /// Exact modal steps, with step and modes chosen from error bounds.
    Modal,
}

/// Method with its settings.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum MethodSettings {
    /// Explicit finite differences of the paper (Eqs. 2 to 5).
    FiniteDifference {
        /// Largest length of a cell in m; each body takes a whole number of cells.
        #[serde(default = "default_cell")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        cell_m: f64,
        /// Courant number c dt / dx of the stability condition (Eq. 3, CFL).
        #[serde(default = "default_courant")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
        courant: f64,
        /// Time at which the contact pressure is taken within a step.
        #[serde(default)]
        contact: ContactScheme,
    },
    /// Exact modal steps with implicit contact.
    Modal {
        /// Step in s; left out, it is chosen so that the lowest natural frequency and the
        /// excitation are resolved, and halved until the energy balance closes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "f64", extend("exclusiveMinimum" = 0.0))]
        step_s: Option<f64>,
        /// Modes of each body, the rigid one included; left out, the number is chosen so that the
        /// inertia of the omitted modes is negligible.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(with = "usize", range(min = 1, max = 2000))]
        modes_per_body: Option<usize>,
    },
}

fn default_cell() -> f64 {
    DEFAULT_CELL_M
}

fn default_courant() -> f64 {
    DEFAULT_COURANT
}

impl From<MethodKeys> for MethodSpec {
    fn from(keys: MethodKeys) -> Self {
        match keys {
            MethodKeys::Kind(MethodKind::FiniteDifference) => {
                Self::FiniteDifference(FiniteDifferenceSpec::default())
            }
            MethodKeys::Kind(MethodKind::Modal) => Self::Modal(ModalSpec::default()),
            MethodKeys::Settings(MethodSettings::Modal { step_s, modes_per_body }) => {
                Self::Modal(ModalSpec { step_s, modes_per_body })
            }
            MethodKeys::Settings(MethodSettings::FiniteDifference { cell_m, courant, contact }) => {
                Self::FiniteDifference(FiniteDifferenceSpec { cell_m, courant, contact })
            }
        }
    }
}

impl From<MethodSpec> for MethodSettings {
    fn from(method: MethodSpec) -> Self {
        match method {
            MethodSpec::FiniteDifference(FiniteDifferenceSpec { cell_m, courant, contact }) => {
                Self::FiniteDifference { cell_m, courant, contact }
            }
            MethodSpec::Modal(ModalSpec { step_s, modes_per_body }) => {
                Self::Modal { step_s, modes_per_body }
            }
        }
    }
}
