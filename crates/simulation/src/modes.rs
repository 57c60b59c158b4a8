//! Linearised modes of a scenario about static equilibrium, with their shapes along the stack.

use asperity_scenario::Scenario;
use asperity_structure::LinearisedMode;
use serde::Serialize;

use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::provenance::Provenance;
use crate::static_state::StaticSummary;

/// Positions along each body at which a mode shape is given.
const PLACES: usize = 51;

/// Identifier of the summary's format.
pub const MODES_SCHEMA: &str = "asperity/modes/1";

/// Modes with their shapes.
#[derive(Debug, Clone)]
pub struct LinearisedModes {
    /// The modes, the lowest frequency first.
    pub modes: Vec<LinearisedMode>,
    /// Distances from the top of the stack \[m\]; the ends of each body are among them.
    pub positions: Vec<f64>,
    /// Displacement of each mode at the positions, over its largest.
    pub shapes: Vec<Vec<f64>>,
}

/// Computes the `count` lowest modes of an assembled scenario, linearised about static equilibrium.
///
/// # Errors
/// [`SimulationError::Structure`] for a structure without stiffness, or a count out of range.
///
/// ```
/// # use asperity_scenario::Document;
/// # use asperity_simulation::assemble::Assembly;
/// # use asperity_simulation::modes::linearised_modes;
/// let document = Document::read("examples/block.json")?;
/// let assembly = Assembly::new(&document.scenario()?, document.folder())?;
/// let found = linearised_modes(&assembly, 2)?;
/// let natural = assembly.structure.natural_frequency().unwrap();
/// assert!((found.modes[0].frequency_hz / natural - 1.0).abs() < 1e-9);
/// assert_eq!(found.shapes[0].len(), found.positions.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn linearised_modes(
    assembly: &Assembly,
    count: usize,
) -> Result<LinearisedModes, SimulationError> {
    let modes = assembly.structure.modes(count)?;
    let mut positions = Vec::new();
    let mut shapes = vec![Vec::new(); modes.len()];
    let mut top = 0.0;
    for (index, body) in assembly.structure.stack().bodies().iter().enumerate() {
        for place in 0..PLACES {
            let fraction = place as f64 / (PLACES - 1) as f64;
            positions.push(top + fraction * body.length());
            for (mode, shape) in modes.iter().zip(&mut shapes) {
                shape.push(mode.displacement(body, index, fraction));
            }
        }
        top += body.length();
    }
    Ok(LinearisedModes { modes, positions, shapes })
}

/// `modes.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModesSummary {
    /// [`MODES_SCHEMA`].
    pub schema: &'static str,
    /// Title of the scenario.
    pub title: Option<String>,
    /// State at rest.
    #[serde(rename = "static")]
    pub at_rest: StaticSummary,
    /// The modes, the lowest frequency first.
    pub modes: Vec<ModeSummary>,
    /// Origin of the numbers.
    pub provenance: Provenance,
}

/// A mode in `modes.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeSummary {
    /// Natural frequency \[Hz\].
    pub frequency_hz: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Shape at the place of the load over the root of the modal mass \[kg^-1/2\]; with a motion of the base
    /// minus the sum of mass times shape \[kg^1/2\].
    pub load_participation: f64,
    /// Shape at each sensor.
    pub sensors: Vec<SensorParticipation>,
}

/// The part of a sensor in a mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensorParticipation {
    /// Name of the sensor; none for the top of a scenario without sensors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Shape at its place over the root of the modal mass \[kg^-1/2\].
    pub participation: f64,
}

impl ModesSummary {
    /// The summary of the modes of an assembled scenario.
    pub fn new(
        scenario: &Scenario,
        assembly: &Assembly,
        found: &LinearisedModes,
        provenance: Provenance,
    ) -> Self {
        let stack = assembly.structure.stack();
        let summary = |mode: &LinearisedMode| ModeSummary {
            frequency_hz: mode.frequency_hz,
            damping_ratio: mode.damping_ratio,
            load_participation: mode.participation(stack, assembly.load.port()),
            sensors: assembly
                .sensors
                .iter()
                .map(|sensor| SensorParticipation {
                    name: sensor.name.clone(),
                    participation: mode.participation(stack, sensor.port),
                })
                .collect(),
        };
        Self {
            schema: MODES_SCHEMA,
            title: scenario.title.clone(),
            at_rest: StaticSummary::of(assembly),
            modes: found.modes.iter().map(summary).collect(),
            provenance,
        }
    }
}
