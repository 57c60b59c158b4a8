//! The state of an assembled scenario at rest.

use serde::Serialize;

use crate::assemble::Assembly;

/// State at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StaticSummary {
    /// Lowest natural frequency of the structure linearised at rest \[Hz\]; none without stiffness.
    pub natural_frequency_hz: Option<f64>,
    /// Contacts at rest, from the top down.
    pub interfaces: Vec<StaticInterface>,
}

/// One contact at rest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StaticInterface {
    /// Name of the interface.
    pub name: String,
    /// Static pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contact stiffness per area \[Pa/m\].
    pub stiffness_pa_per_m: f64,
    /// Closure from the law's reference \[m\].
    pub closure_m: f64,
}

impl StaticSummary {
    /// The state of an assembled scenario: pressures, stiffnesses and closures of its contacts,
    /// and the lowest natural frequency about it.
    pub fn of(assembly: &Assembly) -> Self {
        let contacts = assembly.structure.contacts().iter();
        Self {
            natural_frequency_hz: assembly.structure.natural_frequency(),
            interfaces: contacts
                .map(|contact| StaticInterface {
                    name: contact.name().to_owned(),
                    pressure_pa: contact.pressure(),
                    stiffness_pa_per_m: contact.stiffness(),
                    closure_m: contact.closure(),
                })
                .collect(),
        }
    }
}
