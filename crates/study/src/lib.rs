//! Scenario in, record out: the place where laws, mesh, dynamics and signals meet.

pub mod diagnostic;
pub mod document;
pub mod input;
pub mod locate;
pub mod pointer;
pub mod samples;
pub mod scenario;
pub mod schema;
pub mod schema_check;
pub mod suggest;
pub mod validate;
