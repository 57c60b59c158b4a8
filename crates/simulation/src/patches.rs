//! Structures given by matrices of finite elements, with contact patches of many cells.
//!
//! | module | holds |
//! |---|---|
//! | `body` | files of a body |
//! | [`ports`] | cells of patches, springs, loads, excitation and sensors as ports of the bodies |
//! | `patch_cells` | cells of a file, between surfaces, or of a reduced model |
//! | [`structure`] | a scenario to a structure at rest |
//! | [`kept_reduction`] | reductions kept on disk under what they depend on |
//! | [`run`] | transient runs |
//! | `rows` | rows of a sweep or a study |
//! | `steady` | steady responses |
//! | [`modes`] | linearised modes |

mod body;
pub mod kept_reduction;
pub mod modes;
mod patch_cells;
pub mod ports;
mod rows;
pub mod run;
mod steady;
pub mod structure;

pub use modes::{PatchModes, patch_modes};
pub use ports::Patch;
pub(crate) use rows::PatchRows;
pub use run::{CellCounts, CellSummary, PatchRun, PatchSummary, Truncation, simulate_patches};
pub use steady::steady_cells;
pub use structure::{PatchStructure, assemble_patches};
