//! Many hits at a time, as sweeps and identification run them.
//!
//! | module | holds |
//! |---|---|
//! | `case` | what runs share that differ in their drive alone |
//! | `observe` | from a hit's record to its summary |

mod case;
mod observe;

pub use case::Case;
pub use observe::{FREE, Observer};
