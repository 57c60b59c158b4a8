//! Scenario in, record out: the place where laws, mesh, dynamics and signals meet.
//!
//! A checked [`Scenario`](asperity_scenario::Scenario) is assembled to a stack of bodies with laws
//! at its interfaces ([`assemble`]); run, a response and its [`summary`]; swept, many of them
//! ([`mod@sweep`]). [`record`] writes them as CSV and [`output`] puts them on disk whole or not at
//! all. Nothing here draws or prints.
//!
//! | step | modules |
//! |---|---|
//! | compute | [`assemble`], [`run`], [`mod@sweep`], [`mod@steady`], [`sensitivity`], [`laws`] |
//! | give back | [`summary`], [`record`], [`output`], [`measured_record`], [`error`] |

pub mod assemble;
pub mod error;
pub mod laws;
pub mod measured_record;
pub mod output;
pub mod record;
pub mod run;
pub mod sensitivity;
pub mod steady;
pub mod struck;
pub mod summary;
pub mod sweep;
