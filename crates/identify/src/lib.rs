//! Measured responses to contact laws with their uncertainty.
//!
//! | module | holds |
//! |---|---|
//! | `problem`, `read` | what a problem says, and its scenario |
//! | `unknowns`, `monotone` | from values of the unknowns to a scenario |
//! | `load`, `files`, `records` | from data to strikes and observations |
//! | `strike`, `forward`, `row`, `exact` | the forward model and its exact derivatives |
//! | `model` | the problem's model, and those compared with it |
//! | `run`, `inflated` | fit, uncertainty, comparison |
//! | `band`, `design` | the law with its band; what to measure next |
//! | `verdict`, `report` | the answer in words, as JSON and as tables |
//! | `error` | why not |

mod band;
mod design;
mod error;
mod exact;
mod files;
mod forward;
mod inflated;
mod load;
mod model;
mod monotone;
pub mod problem;
mod read;
mod records;
mod report;
mod row;
mod run;
mod strike;
#[cfg(test)]
mod tests;
mod unknowns;
mod verdict;

pub use band::{INFORMED_SHARE, LawBand};
pub use design::{Designed, DesignedHit};
pub use error::ProblemError;
pub use read::Problem;
pub use report::{Estimate, IDENTIFICATION_SCHEMA, Observed};
pub use run::{Identification, Step, identify};
pub use verdict::Dependence;

pub use asperity_inference as statistics;
