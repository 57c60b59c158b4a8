//! The named laws of a scenario.

use asperity_scenario::{LawRef, Laws};
use asperity_simulation::error::SimulationError;
use serde_json::Value;

use crate::error::IdentificationError;

/// Least pressure \[Pa\] that laws which never separate are built for.
const LEAST_PRESSURE: f64 = 1.0;

/// Stiffness \[Pa/m\] of a law at some pressures \[Pa\]. The law is built once: its static pressure is the
/// origin of closures alone.
pub(super) fn stiffness_curve(
    laws: &Laws,
    name: &str,
    pressures: &[f64],
) -> Result<Vec<f64>, SimulationError> {
    let reference = LawRef::Named(name.to_owned());
    let highest = pressures.iter().copied().fold(LEAST_PRESSURE, f64::max);
    let law = laws.build(&reference, highest).map_err(|source| SimulationError::Law {
        law: name.to_owned(),
        interface: None,
        pressure_pa: highest,
        source,
    })?;
    Ok(pressures.iter().map(|&pressure| law.stiffness(pressure)).collect())
}

/// The error of a missing law.
pub(super) fn no_law(scenario: &Value, law: &str) -> IdentificationError {
    IdentificationError::NoLaw { law: law.to_owned(), known: law_names(scenario) }
}

/// The error of a law without a name.
pub(super) fn unnamed_law(scenario: &Value) -> IdentificationError {
    IdentificationError::UnnamedLaw(law_names(scenario))
}

fn law_names(scenario: &Value) -> String {
    let laws = scenario.pointer("/laws").and_then(Value::as_object);
    let names: Vec<&str> =
        laws.into_iter().flat_map(|laws| laws.keys()).map(String::as_str).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
