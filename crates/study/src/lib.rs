//! Scenario in, record out: the place where laws, mesh, dynamics and signals meet.
//!
//! A study starts from a [`Document`](document::Document), the text of a
//! scenario with its `--set` changes. Checked, it becomes a typed
//! [`Scenario`](scenario::Scenario); assembled, a stack of bodies with laws at
//! its interfaces ([`assemble`]); run, a response and its [`summary`]; swept,
//! many of them ([`mod@sweep`]). [`record`] writes them as CSV and [`output`]
//! puts them on disk whole or not at all. Files of measured hits go another way
//! to the same answers ([`analysis`]), and from there to the law
//! ([`identification`]). Nothing here draws or prints.
//!
//! | step | modules |
//! |---|---|
//! | read and check | [`document`], [`schema`], [`schema_check`], [`validate`], [`diagnostic`], [`locate`], [`mod@pointer`], [`suggest`], [`input`], [`samples`] |
//! | compute | [`assemble`], [`run`], [`mod@sweep`], [`mod@steady`], [`sensitivity`], [`laws`] |
//! | measured hits | [`analysis`], [`identification`] |
//! | give back | [`summary`], [`record`], [`output`], [`error`] |

pub mod analysis;
pub mod assemble;
pub mod diagnostic;
pub mod document;
pub mod error;
pub mod identification;
pub mod input;
pub mod laws;
pub mod locate;
pub mod output;
pub mod pointer;
pub mod record;
pub mod run;
pub mod samples;
pub mod scenario;
pub mod schema;
pub mod schema_check;
pub mod sensitivity;
pub mod steady;
mod struck;
pub mod suggest;
pub mod summary;
pub mod sweep;
pub mod validate;

pub use asperity_dynamics as dynamics;
pub use asperity_harmonic as harmonic;
pub use asperity_law as law;
pub use asperity_measure as measure;
pub use asperity_mesh as mesh;
pub use asperity_signal as signal;
