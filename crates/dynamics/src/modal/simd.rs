//! Cases side by side in the lanes of vectors.
//!
//! | module | holds |
//! |---|---|
//! | `block` | modes and contacts of up to two vectors of cases |
//! | `integrate` | blocks from rest to the end, on any instruction set |
//! | `kernel` | one step of every lane |
//! | `table_lookup` | a row of a law's table for each lane, by instruction set |
//! | `contact_fallback` | lanes in which Newton's method does not converge |
//! | `contact_extremes` | extremes of pressure, and steps with lost contact |
//! | `decimator` | fewer samples than steps |
//! | `outcome` | the outcome of one case |

pub(super) mod block;
pub(super) mod contact_extremes;
mod contact_fallback;
mod decimator;
pub(super) mod integrate;
mod kernel;
pub(super) mod outcome;
pub(super) mod table_lookup;
