//! Linearised modes of structures with contact patches.

use asperity_structure::PortMode;

use super::structure::PatchStructure;
use crate::assemble::Assembly;
use crate::error::SimulationError;
use crate::modes::{MODES_SCHEMA, ModeSummary, ModesSummary, SensorParticipation};
use crate::provenance::Provenance;

/// Modes about static equilibrium, and how many motions no stiffness holds.
#[derive(Debug, Clone)]
pub struct PatchModes {
    /// The modes, lowest frequency first; zero for motions that nothing holds.
    pub modes: Vec<PortMode>,
}

/// The `count` lowest modes of an assembled structure, linearised about static equilibrium.
///
/// # Errors
/// [`SimulationError::Structure`] if eigenvalues do not converge.
pub fn patch_modes(
    assembly: &Assembly<PatchStructure>,
    count: usize,
) -> Result<PatchModes, SimulationError> {
    Ok(PatchModes { modes: assembly.structure.structure.port_modes(count)? })
}

impl PatchModes {
    /// The modes as `modes.json` has them.
    pub fn summary(
        &self,
        title: Option<String>,
        assembly: &Assembly<PatchStructure>,
        provenance: Provenance,
    ) -> ModesSummary {
        let structure = &assembly.structure;
        let summary = |mode: &PortMode| ModeSummary {
            frequency_hz: mode.frequency_hz,
            damping_ratio: mode.damping_ratio,
            load_participation: mode.ports[structure.load],
            sensors: assembly
                .sensors
                .iter()
                .zip(&structure.sensors)
                .map(|(sensor, &port)| SensorParticipation {
                    name: sensor.name.clone(),
                    participation: mode.ports[port],
                })
                .collect(),
        };
        ModesSummary {
            schema: MODES_SCHEMA,
            title,
            at_rest: structure.at_rest(),
            modes: self.modes.iter().map(summary).collect(),
            provenance,
        }
    }
}
