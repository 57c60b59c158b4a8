//! Parameters: numbers of a scenario that a response depends on, by JSON Pointer.

use asperity_scenario::{JsonPointer, PointerError, has_matrices};
use serde::Serialize;
use serde_json::Value;
use thiserror::Error;

/// Keys of a scenario that set the computation or the sampling.
const SETTINGS: [&str; 3] = ["method", "duration_s", "output_rate_hz"];

/// A number of a scenario, and its value there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScenarioParameter {
    /// JSON Pointer into the scenario.
    pub pointer: String,
    /// Value, in the unit that its key names.
    pub value: f64,
}

/// A pointer that leads to no parameter.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// The text is not a JSON Pointer.
    #[error(transparent)]
    Pointer(#[from] PointerError),
    /// There is no number at this place.
    #[error("`{0}` is not a number of the scenario; expected a pointer such as /excitation/peak_n")]
    NotANumber(String),
    /// The number sets the computation or the sampling.
    #[error(
        "`{0}` is a setting of the computation; expected a number of the structure, its laws or its force"
    )]
    Setting(String),
}

impl ScenarioParameter {
    /// The parameter at `pointer` of a `scenario`.
    ///
    /// # Errors
    /// [`ParameterError`] for a text that is not a pointer, a place without a number, or a setting
    /// of the computation.
    pub fn of_scenario(scenario: &Value, pointer: &str) -> Result<Self, ParameterError> {
        let pointer = pointer.to_owned();
        let parts: JsonPointer = pointer.parse()?;
        let first = parts.parts().first().map(String::as_str).unwrap_or_default();
        if SETTINGS.contains(&first) || is_of_reduction(scenario, &pointer) {
            return Err(ParameterError::Setting(pointer));
        }
        match scenario.pointer(&pointer).and_then(Value::as_f64) {
            Some(value) => Ok(Self { pointer, value }),
            None => Err(ParameterError::NotANumber(pointer)),
        }
    }

    /// True for a number of a contact law.
    ///
    /// Any other leaves the laws as they are, but for the pressure that closures count from.
    pub fn is_of_law(&self) -> bool {
        let mut parts = self.pointer.split('/').skip(1);
        parts.next() == Some("laws") || parts.nth(1) == Some("law")
    }
}

/// True for a number of a structure of matrices that its reduction depends on, or its accuracy: of its bodies, places,
/// directions and divisions of patches.
pub fn is_of_reduction(scenario: &Value, pointer: &str) -> bool {
    let parts: Vec<&str> = pointer.split('/').skip(1).collect();
    has_matrices(scenario)
        && matches!(
            parts[..],
            ["bodies" | "held" | "sensors" | "accuracy", ..]
                | ["interfaces", _, "split" | "along", ..]
                | ["loads", _, "node" | "direction", ..]
                | ["springs", _, "from" | "to", ..]
                | ["excitation", "at" | "direction", ..]
        )
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn numbers_of_the_structure_are_parameters() {
        let scenario = json!({
            "interfaces": [{"area_m2": 1.0, "law": {"exponent": 0.5}}],
            "laws": {"pl": {"coefficient": 2.0}},
            "duration_s": 0.1
        });
        let find = |pointer: &str| ScenarioParameter::of_scenario(&scenario, pointer);
        assert!(find("/laws/pl/coefficient").unwrap().is_of_law());
        assert!(find("/interfaces/0/law/exponent").unwrap().is_of_law());
        assert!(!find("/interfaces/0/area_m2").unwrap().is_of_law());
        assert!(matches!(find("/laws/pl"), Err(ParameterError::NotANumber { .. })));
        assert!(matches!(find("/duration_s"), Err(ParameterError::Setting { .. })));
        assert!(matches!(find("duration_s"), Err(ParameterError::Pointer(_))));
    }

    #[test]
    fn numbers_of_a_reduction_are_settings() {
        let scenario = json!({
            "bodies": [{"matrices": {}, "reduction": {"modes": 30}}],
            "loads": [{"direction": [0, 0, -1], "force_n": 40}],
            "interfaces": [{"split": [6, 2], "initial_gap_m": 1e-6}],
            "excitation": {"peak_n": 5, "at": {"node": 12}}
        });
        let find = |pointer: &str| ScenarioParameter::of_scenario(&scenario, pointer);
        for number in ["/loads/0/force_n", "/interfaces/0/initial_gap_m", "/excitation/peak_n"] {
            assert!(find(number).is_ok(), "{number}");
        }
        for setting in [
            "/bodies/0/reduction/modes",
            "/loads/0/direction/2",
            "/interfaces/0/split/0",
            "/excitation/at/node",
        ] {
            assert!(matches!(find(setting), Err(ParameterError::Setting(_))), "{setting}");
        }
    }
}
