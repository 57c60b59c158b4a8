//! How the equation of motion is integrated in time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Length of a finite-difference cell in m, when the scenario does not say.
pub const DEFAULT_CELL_M: f64 = 0.001;

/// Courant number when the scenario does not say.
pub const DEFAULT_COURANT: f64 = 0.95;

/// The method of time integration.
///
/// In JSON an object with its `kind`, or the kind alone as a string for the
/// method's defaults.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "MethodKeys", into = "MethodSettings")]
pub enum MethodSpec {
    /// The paper's explicit finite differences (Eqs. 2 to 5).
    FiniteDifference(FiniteDifference),
    /// Exact modal steps with implicit contact.
    Modal(Modal),
}

/// Exact modal steps with implicit contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Modal {
    /// Step in s; none to have it chosen from an error estimate.
    pub step_s: Option<f64>,
    /// Modes of each body, the rigid one included; none to have them chosen from an error bound.
    pub modes_per_body: Option<usize>,
}

/// The paper's explicit finite differences (Eqs. 2 to 5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FiniteDifference {
    /// Largest length of a cell in m; each body takes a whole number of cells.
    pub cell_m: f64,
    /// Courant number c dt / dx, below 1 (Eq. 3).
    pub courant: f64,
    /// The contact pressure's place in the time step.
    pub contact: ContactScheme,
}

/// Where in the time step the contact pressure is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactScheme {
    /// At the mean of the new and the previous-but-one closure: no first-order
    /// numerical loss.
    #[default]
    Centred,
    /// At the new time, the plain reading of the paper: damps the fundamental
    /// by about w0^2 dt.
    NewLevel,
}

impl Default for FiniteDifference {
    fn default() -> Self {
        Self { cell_m: DEFAULT_CELL_M, courant: DEFAULT_COURANT, contact: ContactScheme::default() }
    }
}

impl Default for MethodSpec {
    fn default() -> Self {
        Self::Modal(Modal::default())
    }
}

/// The method of time integration: its kind with settings, or the kind alone
/// for the defaults.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "MethodSpec")]
enum MethodKeys {
    /// The kind alone: the defaults.
    Kind(MethodKind),
    /// The kind with its settings.
    Settings(MethodSettings),
}

/// A method by its kind alone, with its defaults.
#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum MethodKind {
    /// The paper's explicit finite differences, 1 mm cells.
    FiniteDifference,
    /// Exact modal steps, step and modes chosen.
    Modal,
}

/// A method with its settings.
#[derive(Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum MethodSettings {
    /// The paper's explicit finite differences (Eqs. 2 to 5).
    FiniteDifference {
        /// Largest length of a cell in m; each body takes a whole number of
        /// cells.
        #[serde(default = "default_cell")]
        #[schemars(extend("exclusiveMinimum" = 0.0))]
        cell_m: f64,
        /// Courant number c dt / dx of the stability condition (Eq. 3, CFL).
        #[serde(default = "default_courant")]
        #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
        courant: f64,
        /// Where in the time step the contact pressure is taken.
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
        /// Modes of each body, the rigid one included; left out, they are chosen so that the
        /// inertia of the others does not matter.
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
                Self::FiniteDifference(FiniteDifference::default())
            }
            MethodKeys::Kind(MethodKind::Modal) => Self::Modal(Modal::default()),
            MethodKeys::Settings(MethodSettings::Modal { step_s, modes_per_body }) => {
                Self::Modal(Modal { step_s, modes_per_body })
            }
            MethodKeys::Settings(MethodSettings::FiniteDifference { cell_m, courant, contact }) => {
                Self::FiniteDifference(FiniteDifference { cell_m, courant, contact })
            }
        }
    }
}

impl From<MethodSpec> for MethodSettings {
    fn from(method: MethodSpec) -> Self {
        match method {
            MethodSpec::FiniteDifference(settings) => Self::FiniteDifference {
                cell_m: settings.cell_m,
                courant: settings.courant,
                contact: settings.contact,
            },
            MethodSpec::Modal(Modal { step_s, modes_per_body }) => {
                Self::Modal { step_s, modes_per_body }
            }
        }
    }
}
