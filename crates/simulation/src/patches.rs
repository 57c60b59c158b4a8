//! Structures given by matrices of finite elements, with contact patches of many cells.
//!
//! | module | holds |
//! |---|---|
//! | [`structure`] | files of a scenario to a structure at rest, with its ports |
//! | [`kept_reduction`] | reductions kept on disk under what they depend on |
//! | [`run`] | transient runs |
//! | `rows` | rows of a sweep or a study |
//! | `steady` | steady responses |
//! | [`modes`] | linearised modes |

pub mod kept_reduction;
pub mod modes;
mod rows;
pub mod run;
mod steady;
pub mod structure;

pub use modes::{PatchModes, patch_modes};
pub(crate) use rows::PatchRows;
pub use run::{CellSummary, PatchRun, simulate_patches};
pub use steady::steady_cells;
pub use structure::{Patch, PatchStructure, assemble_patches};
