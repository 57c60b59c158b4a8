//! Structures given by matrices of finite elements, and bars beside them, with contact patches of many cells.
//!
//! | module | holds |
//! |---|---|
//! | `body` | files of a body |
//! | `bar` | bars beside bodies of matrices |
//! | [`ports`] | cells of patches, springs, loads, excitation and sensors as ports of the bodies |
//! | `patch_cells` | cells of a file, between surfaces, or of a reduced model |
//! | `bar_contacts` | contacts of ends of bars |
//! | [`structure`] | a scenario to a structure at rest |
//! | [`kept_reduction`] | reductions kept on disk under what they depend on |
//! | [`run`] | transient runs and their results |
//! | [`system`] | time integration, refined |
//! | `recording` | instants and cells of a run that are recorded |
//! | `rows` | rows of a sweep or a study |
//! | `steady` | steady responses |
//! | [`modes`] | linearised modes |
//! | `body_mesh` | meshes of bodies and their displacements |
//! | [`mode_shapes`] | modes on meshes, as VTU and universal files |
//! | [`mesh_motion`] | motion on meshes and pressures of cells at instants, as VTU and universal files |
//! | `universal_file` | universal files of displacements on meshes |
//! | [`patch_map`] | places of cells with their pressures and gaps |

mod bar;
mod bar_contacts;
mod body;
mod body_mesh;
pub mod kept_reduction;
pub mod mesh_motion;
pub mod mode_shapes;
pub mod modes;
mod patch_cells;
pub mod patch_map;
pub mod ports;
mod recording;
mod rows;
pub mod run;
mod steady;
pub mod structure;
pub mod system;
mod universal_file;

pub use mesh_motion::{MeshMotion, time_series};
pub use mode_shapes::{MeshModes, mesh_modes};
pub use modes::{PatchModes, patch_modes};
pub use patch_map::{CellPlace, PatchMap, patch_grid, patch_maps};
pub use ports::Patch;
pub(crate) use rows::PatchRows;
pub use run::{
    CellCounts, CellHistory, CellSummary, PatchRun, PatchSummary, SensorDisplacement, Truncation,
    simulate_patches, simulate_patches_unless,
};
pub use steady::steady_cells;
pub use structure::{PatchStructure, ReducedStructure, ReducedStructures, assemble_patches};
pub use system::{PatchResponse, PatchSystem, RefinedPatchResponse};
